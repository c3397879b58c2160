"""The replayed mornings that a job of a study reads."""

from typing import Any

from opml.learning.judge.model_choice import Mornings
from opml.tables import read_table
from opml.workflow.job_settings import FigureSettings
from opml.workflow.jobs import read_by_key


def read_mornings(files: Any, settings: FigureSettings) -> Mornings:
    """Read the mornings of a job's `replays`, held against the truth where its `judge` has one.

    Raises InputError where a table is missing or damaged, and as `Mornings.from_replays` does.
    """
    replays = read_by_key(settings.learners, files.replays, "replay")
    mornings = Mornings.from_replays(replays, settings.laws, seed=settings.seed)
    if not files.judge:
        return mornings
    return mornings.against_truth(*(read_table(path, "dataset") for path in files.judge))
