"""Which rows of a dataset a model is trained and tested on, by the name of a split.

`opml.naming` tells the names: `random-80` (80 % of the rows, drawn with the seed, as in the paper),
`grouped-80` (all rows of 80 % of the estimates) or `days-0-30` (rows whose t_j lies in that window) for
training; for testing `seen` (the training rows), `rest` (rows of the learning span that were not trained on),
another window, `days-30-40`, or `days-30-40-unseen` (where t_i, too, lies in it, so that no estimate behind a
row was trained on). Only kept rows are ever chosen, but by a test without the dataset's fences
(`days-30-40-unfenced`) or with fences of its own rows (`days-30-40-fence3`). Labels from later estimates are
trained on only where they were known by the end of the window.
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
    """Which epochs t [s] lie in (first, last] days.

    Half open, so that adjoining windows share no row; nothing is lost at 0, as no prediction ends there.
    """
    first, last = span_days
    return (t > first * DAY) & (t <= last * DAY)


def known_at(dataset: pd.DataFrame) -> np.ndarray:
    """When the error of each row (n,) was known [s]: a true one at t_j."""
    known: np.ndarray = dataset.get("t_known", dataset["t_j"]).to_numpy()
    return known


def training_rows(dataset: pd.DataFrame, name: str, *, span_days: Sequence[float], seed: int) -> np.ndarray:
    """Rows to train on under the split `name` (bool, one per row of the dataset).

    A random split draws from kept rows with t_j in span_days. The errors of all must have been known by the
    last day. Raises InputError for an unknown name or a split without rows.
    """
    split = parse_train(name)
    days = split.days if split.kind == "days" else span_days
    candidates = dataset["keep"].to_numpy() & in_days(dataset["t_j"].to_numpy(), days)
    candidates &= known_at(dataset) <= days[1] * DAY
    match split.kind:
        case "random":
            rows = _random_share(candidates, percent=split.percent, seed=seed)
        case "grouped":
            rows = _grouped_share(candidates, dataset["i"].to_numpy(), percent=split.percent, seed=seed)
        case _:
            rows = candidates
    return _not_empty(rows, f"training split '{name}'")


def test_rows(
    dataset: pd.DataFrame, name: str, *, span_days: Sequence[float], trained: np.ndarray | None
) -> np.ndarray:
    """Rows to test on under the split `name` (bool, one per row of the dataset).

    `trained` are the training rows in this dataset; None where the model was trained on another RSO. A window
    leaves them out too. Raises InputError for an unknown name or a split without rows.
    """
    split = parse_test(name)
    seen = np.zeros(len(dataset), dtype=bool) if trained is None else trained
    if split.kind == "seen":
        return _not_empty(seen & dataset["keep"].to_numpy(), f"test split '{name}'")
    window = split.days if split.kind == "days" else span_days
    usable = dataset["keep"] if split.fence is None else dataset["reason"].isin(["", OUTSIDE_FENCES])
    rows = usable.to_numpy() & in_days(dataset["t_j"].to_numpy(), window) & ~seen
    if split.unseen:
        rows &= in_days(dataset["t_i"].to_numpy(), window)
    if split.fence is not None and math.isfinite(split.fence) and rows.any():
        rows &= _within_own_fences(dataset["e_y"].to_numpy(), rows, fence=split.fence)
    return _not_empty(rows, f"test split '{name}'")


def rows_tested(
    dataset: pd.DataFrame,
    name: str,
    *,
    train: str | None,
    span_days: Sequence[float],
    seed: int,
    learned: pd.DataFrame | None = None,
) -> np.ndarray:
    """Rows to test on after training under the split `train` (bool, one per row of the dataset).

    `train` is None where the model was trained on another RSO; `learned` is the dataset of the same pairs
    that it was trained on, where its errors are held against something else. Errors as `training_rows` and
    `test_rows`.
    """
    learned = dataset if learned is None else learned
    trained = None if train is None else training_rows(learned, train, span_days=span_days, seed=seed)
    return test_rows(dataset, name, span_days=span_days, trained=trained)


def _random_share(candidates: np.ndarray, *, percent: float, seed: int) -> np.ndarray:
    # One permutation per seed, whatever the percentage: the 10 % rows are among the 20 % rows, and the test
    # rows nest likewise. Neighbouring points of the partition curve then differ by what more data does, not
    # by the luck of another draw.
    order = derive(seed, "split", "random").permutation(np.flatnonzero(candidates))
    rows = np.zeros(len(candidates), dtype=bool)
    rows[order[: round(len(order) * percent / 100.0)]] = True
    return rows


def _grouped_share(candidates: np.ndarray, group: np.ndarray, *, percent: float, seed: int) -> np.ndarray:
    order = derive(seed, "split", "grouped").permutation(np.unique(group[candidates]))
    return candidates & np.isin(group, order[: round(len(order) * percent / 100.0)])


def _within_own_fences(e_y: np.ndarray, rows: np.ndarray, *, fence: float) -> np.ndarray:
    lower, upper = tukey_fences(e_y[rows], fence=fence)
    inside: np.ndarray = (e_y >= lower) & (e_y <= upper)
    return inside


def _not_empty(rows: np.ndarray, what: str) -> np.ndarray:
    if not rows.any():
        raise InputError(f"{what}: expected at least one kept row of the dataset, got none")
    return rows
