"""Rows that a model is trained and tested on, by the name of a split.

`opml.naming` parses the names. For training:

* `random-80`: 80 % of the rows, drawn with the seed, as in the paper
* `grouped-80`: all rows of 80 % of the estimates
* `days-0-30`: rows with t_j in that window

For testing:

* `seen`: the training rows
* `rest`: rows of the learning span that were not trained on
* `days-30-40`: rows with t_j in that window
* `days-30-40-unseen`: rows with t_i in that window, too, so that no estimate of theirs was trained on

Only kept rows are chosen, except by a test without the fences of the dataset (`days-30-40-unfenced`) or with
fences of its own rows (`days-30-40-fence3`). Labels from later estimates are trained on only where they were
known by the end of the window.
"""

import math
from collections.abc import Sequence

import numpy as np
import pandas as pd

from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.base.seeds import derive
from opml.learning.data.cleaning import OUTSIDE_FENCES, tukey_fences
from opml.naming import parse_test, parse_train


def in_days(t: np.ndarray, span_days: Sequence[float]) -> np.ndarray:
    """Return which epochs t [s] lie in (first, last] days.

    The window is half open, so that adjoining windows share no row. Nothing is lost at 0, because no
    prediction ends there.
    """
    first, last = span_days
    return (t > first * DAY) & (t <= last * DAY)


def known_at(dataset: pd.DataFrame) -> np.ndarray:
    """Return when the error of each row (n,) is known [s]: a true error at t_j, a label later."""
    return dataset.get("t_known", dataset["t_j"]).to_numpy()


def are_over(rows: pd.DataFrame, now: float) -> np.ndarray:
    """Return which rows (n,) of a dataset, or of `judged`, have an error that is known by `now` [s]."""
    return known_at(rows) <= now


def training_rows(dataset: pd.DataFrame, name: str, *, span_days: Sequence[float], seed: int) -> np.ndarray:
    """Return which rows (bool, n) of a dataset the split `name` trains on.

    span_days: first and last day of t_j of the kept rows that a random split draws from

    The errors of all rows must be known by the last day. Raises InputError for an unknown name or a split
    without rows.
    """
    split = parse_train(name)
    days = split.days if split.kind == "days" else span_days
    candidates = dataset["keep"].to_numpy() & in_days(dataset["t_j"].to_numpy(), days)
    candidates &= known_at(dataset) <= days[1] * DAY
    match split.kind:
        case "random":
            rows = _random_share(candidates, percent=split.percent, seed=seed)
        case "grouped":
            groups = dataset["i"].to_numpy()
            order = derive(seed, "split", "grouped").permutation(np.unique(groups[candidates]))
            rows = candidates & np.isin(groups, order[: round(len(order) * split.percent / 100.0)])
        case _:
            rows = candidates
    return _check_not_empty(rows, f"training split '{name}'")


def test_rows(
    dataset: pd.DataFrame, name: str, *, span_days: Sequence[float], trained: np.ndarray | None
) -> np.ndarray:
    """Return which rows (bool, n) of a dataset the split `name` tests on.

    trained: training rows (bool, n) of this dataset, which a window leaves out, too; None where the model was
        trained on another RSO

    Raises InputError for an unknown name or a split without rows.
    """
    split = parse_test(name)
    seen = np.zeros(len(dataset), dtype=bool) if trained is None else trained
    if split.kind == "seen":
        return _check_not_empty(seen & dataset["keep"].to_numpy(), f"test split '{name}'")
    window = split.days if split.kind == "days" else span_days
    usable = dataset["keep"] if split.fence is None else dataset["reason"].isin(["", OUTSIDE_FENCES])
    rows = usable.to_numpy() & in_days(dataset["t_j"].to_numpy(), window) & ~seen
    if split.starts_inside:
        rows &= in_days(dataset["t_i"].to_numpy(), window)
    if split.fence is not None and math.isfinite(split.fence) and rows.any():
        e_y = dataset["e_y"].to_numpy()
        lower, upper = tukey_fences(e_y[rows], fence=split.fence)
        rows &= (e_y >= lower) & (e_y <= upper)
    return _check_not_empty(rows, f"test split '{name}'")


def _random_share(candidates: np.ndarray, *, percent: float, seed: int) -> np.ndarray:
    # One permutation per seed, whatever the percentage: the rows of 10 % are among those of 20 %, and test
    # rows nest likewise. So neighbouring points of the partition curve differ by the effect of more data, not
    # by the luck of another draw.
    order = derive(seed, "split", "random").permutation(np.flatnonzero(candidates))
    rows = np.zeros(len(candidates), dtype=bool)
    rows[order[: round(len(order) * percent / 100.0)]] = True
    return rows


def _check_not_empty(rows: np.ndarray, what: str) -> np.ndarray:
    if not rows.any():
        raise InputError(f"{what}: expected at least one kept row of the dataset, got none")
    return rows
