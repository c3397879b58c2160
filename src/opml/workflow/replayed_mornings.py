"""The replayed mornings that a job of a study reads."""

from typing import Any

from opml.base.section import JobSettings
from opml.learning.judge.model_choice import Mornings
from opml.tables import read_table
from opml.workflow.jobs import read_by_key


class ReplayedSettings(JobSettings):
    """The models and the laws whose mornings are run again, by their names, and a figure's note and days."""

    learners: list[str]
    laws: list[str]
    seed: int
    note: str
    days: list[float]


def read_mornings(files: Any, settings: ReplayedSettings) -> Mornings:
    """Read the mornings of a job's `replays`, compared with the truth where its `judge` has one.

    Raises InputError where a table is missing or damaged, and as `Mornings.from_replays` does.
    """
    replays = read_by_key(settings.learners, files.replays, "replay")
    mornings = Mornings.from_replays(replays, settings.laws, seed=settings.seed)
    if not files.judge:
        return mornings
    return mornings.against_truth(*(read_table(path, "dataset") for path in files.judge))
