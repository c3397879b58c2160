"""All settings together: a run and its study, and what a file of them may hold."""

from opml.base.section import absent, setting
from opml.base.setting_types import Absent
from opml.study.settings.model.names import Names
from opml.study.settings.model.run import RunAlone
from opml.study.settings.model.study_parts import StudySettings


class RunSettings(RunAlone):
    """Merged settings: the run, and the study in full."""

    study: StudySettings | None = setting("what is asked of the run")


class ExtendingStudy(StudySettings):
    """A study as it stands in a file."""

    extends: Absent[str | Names] = absent(
        "names or paths of studies that this one is laid over", unit="names"
    )


class SettingsFile(RunAlone):
    """Settings as they stand in a file."""

    study: ExtendingStudy | str | Names | None = setting(
        "what is asked of the run: a study, or names of studies"
    )
