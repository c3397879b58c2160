"""The rows that a job tests on, and the errors that they are judged by; beside them those it trains on."""

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
import pandas as pd

from opml.base.files import FilePath
from opml.learning.data import dataset, splits


def read(
    files: Any, settings: Mapping[str, Any], *, beside: Iterable[FilePath]
) -> tuple[pd.DataFrame, np.ndarray, pd.DataFrame]:
    """The dataset that judges a test, its rows to test on, and the dataset that a model of it learns from.

    files: a job's, with `target`, the latter, and `judge`, the former where it is another one; beside: files
    of the columns beside both. settings: `experiment`, `train`, `span_days` and `seed`. Both have the same
    pairs. Raises InputError where a file is missing or damaged, or nothing is left to test on.
    """
    of, beside = settings["experiment"], list(beside)
    learned = dataset.read(files.target, beside)
    judged = dataset.read(files.judge, beside) if files.judge else learned
    rows = splits.rows_tested(
        judged,
        of["test"],
        train=settings["train"] if of["target"] == of["rso"] else None,
        span_days=settings["span_days"],
        seed=settings["seed"],
        learned=learned,
    )
    return judged, rows, learned


def read_with_training(files: Any, settings: Mapping[str, Any]) -> tuple[pd.DataFrame, pd.DataFrame]:
    """The rows that a job trains on, and those of the dataset that judges its test.

    files: as for `read`, and `dataset` of the former, with what is `beside` it and `beside_target`. Errors as
    `read`, and InputError where nothing is left to train on.
    """
    table = dataset.read(files.dataset, files.beside)
    training = splits.training_rows(
        table, settings["train"], span_days=settings["span_days"], seed=settings["seed"]
    )
    judged, rows, _ = read(files, settings, beside=files.beside_target)
    return table[training], judged[rows]
