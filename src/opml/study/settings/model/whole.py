"""All settings together: a run and its study, and what a file of them may hold."""

from opml.base.section import setting
from opml.study.settings.model.names import Names
from opml.study.settings.model.run import RunAlone
from opml.study.settings.model.study_parts import StudySettings


class RunSettings(RunAlone):
    """Merged settings: the run, and the study in full."""

    study: StudySettings | None = setting("what is asked of the run")


class SettingsFile(RunAlone):
    """Settings as they stand in a file."""

    study: StudySettings | str | Names | None = setting(
        "what is asked of the run: a study, or names of studies"
    )
