"""The rows that a job tests on and trains on, from its files and settings."""

from collections.abc import Iterable
from typing import Any

import numpy as np
import pandas as pd

from opml.base.files import FilePath
from opml.base.section import JobSettings
from opml.learning.data import dataset, splits


class RowsSettings(JobSettings):
    """The experiment of a job, as the columns of `metrics` have it, and what its model is trained on."""

    epoch: str
    experiment: dict[str, str]
    train: str
    span_days: tuple[float, float]
    seed: int


def read(
    files: Any, settings: RowsSettings, *, others: Iterable[FilePath]
) -> tuple[pd.DataFrame, np.ndarray, pd.DataFrame]:
    """Load the dataset to test against, its test rows (bool), and the dataset that the model learns from.

    files.target: the dataset that the model learns from
    files.judge: the dataset with the errors to test against, if it is another; it has the same pairs
    others: tables with extra columns for both

    Raises InputError where a file is missing or damaged, and for a test without rows.
    """
    experiment, others, span = settings.experiment, list(others), settings.span_days
    learned = dataset.read(files.target, others)
    judged = dataset.read(files.judge, others) if files.judge else learned
    trained = None
    if experiment["target"] == experiment["rso"]:
        trained = splits.training_rows(learned, settings.train, span_days=span, seed=settings.seed)
    rows = splits.test_rows(judged, experiment["test"], span_days=span, trained=trained)
    return judged, rows, learned
