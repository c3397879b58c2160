"""What a figure of errors says beside its points: what was trained and tested, and which rows there are."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import pandas as pd

from opml.base.constants import DAY
from opml.figures.axis_labels import experiment
from opml.learning.data.cleaning import OUTSIDE_FENCES, Cleaning, tukey_fences
from opml.learning.data.splits import in_days, known_at
from opml.naming import parse_test

SHORT_DAYS = 0.5
"""Durations of which a figure says in numbers what a linear axis cannot show [d]."""


@dataclass(frozen=True)
class Context:
    """All that a figure of one experiment's errors says beside them."""

    note: str = ""  # what was trained and tested
    interval: tuple[float, float] | None = None  # P_ML [%], its 5th and 95th percentile
    fences: tuple[float, float] | None = None  # that cut the tested rows' e_y [m]
    kept: float | None = None  # share of the pairs that the cleaning keeps, of the days tested [%]


def of_experiment(
    names: Mapping[str, Any], metrics: pd.DataFrame, dataset: pd.DataFrame, cleaning: Cleaning
) -> Context:
    """The context of the experiment that has these `names`, among others.

    metrics: its row of that table; dataset: that of the RSO tested on; cleaning: what it was cleaned by.
    """
    own = names["component"] == "e_y" and parse_test(names["test"]).fence is None
    return Context(
        note=experiment(**names),
        interval=(float(metrics["p_ml_low"].iloc[0]), float(metrics["p_ml_high"].iloc[0])),
        fences=fences(dataset, cleaning) if own else None,
        kept=100.0 * kept(dataset, names["test"]),
    )


def kept(dataset: pd.DataFrame, test: str) -> float:
    """Share of the pairs with t_j in the days of a test, or of all where it has none, that are kept."""
    split = parse_test(test)
    rows = dataset[in_days(dataset["t_j"], split.days)] if split.kind == "days" else dataset
    return float(rows["keep"].mean()) if len(rows) else math.nan


def fences(dataset: pd.DataFrame, cleaning: Cleaning) -> tuple[float, float] | None:
    """Tukey's fences on e_y [m] that a dataset was cleaned by; None where it has none."""
    candidates = dataset[dataset["reason"].isin(["", OUTSIDE_FENCES])]
    if cleaning.fence is None or candidates.empty:
        return None
    days = cleaning.fence_days
    within = candidates if days is None else candidates[in_days(known_at(candidates), days)]
    return tukey_fences(within["e_y"].to_numpy(), fence=cleaning.fence)


def short(evaluation: pd.DataFrame) -> tuple[float, float]:
    """Mean size of the errors of durations up to SHORT_DAYS, before and after; NaN where there is none."""
    rows = evaluation[evaluation["duration"] <= SHORT_DAYS * DAY]
    if rows.empty:
        return math.nan, math.nan
    return float(rows["true"].abs().mean()), float(rows["residual"].abs().mean())
