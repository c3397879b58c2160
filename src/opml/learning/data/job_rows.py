"""The rows that a job tests on and trains on, from its files and settings."""

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
import pandas as pd

from opml.base.files import FilePath
from opml.learning.data import dataset, splits


def read(
    files: Any, settings: Mapping[str, Any], *, beside: Iterable[FilePath]
) -> tuple[pd.DataFrame, np.ndarray, pd.DataFrame]:
    """Load the dataset to test against, its test rows (bool), and the dataset that the model learns from.

    files.target: the dataset that the model learns from
    files.judge: the dataset with the errors to test against, if it is another; it has the same pairs
    settings: `experiment`, `train`, `span_days` and `seed`
    beside: tables with extra columns for both

    Raises InputError where a file is missing or damaged, and for a test without rows.
    """
    experiment, beside = settings["experiment"], list(beside)
    learned = dataset.read(files.target, beside)
    judged = dataset.read(files.judge, beside) if files.judge else learned
    trained = _trained(learned, settings) if experiment["target"] == experiment["rso"] else None
    rows = splits.test_rows(judged, experiment["test"], span_days=settings["span_days"], trained=trained)
    return judged, rows, learned


def read_with_training(files: Any, settings: Mapping[str, Any]) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Load the training rows and the test rows of a job.

    files: as for `read`, with the test's extra columns in files.beside_target
    files.dataset: the dataset to train on, with extra columns in files.beside
    settings: as for `read`

    Raises InputError as `read`, and for a training without rows.
    """
    table = dataset.read(files.dataset, files.beside)
    judged, tested, _ = read(files, settings, beside=files.beside_target)
    return table[_trained(table, settings)], judged[tested]


def _trained(table: pd.DataFrame, settings: Mapping[str, Any]) -> np.ndarray:
    """Return which rows (bool, n) of a dataset a job trains on."""
    span_days, seed = settings["span_days"], settings["seed"]
    return splits.training_rows(table, settings["train"], span_days=span_days, seed=seed)
