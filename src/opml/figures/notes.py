"""Notes of a figure of errors: what was trained and tested, and which rows it shows."""

import math
from dataclasses import dataclass

import numpy as np
import pandas as pd

from opml.base.constants import DAY
from opml.base.files import FilePath
from opml.figures.axis_labels import P_ML, describe_experiment, si_unit, unit
from opml.figures.ticks import MINUS
from opml.learning.data.cleaning import OUTSIDE_FENCES, Cleaning, tukey_fences
from opml.learning.data.splits import in_days, known_at
from opml.learning.judge import metrics as judge
from opml.naming import Experiment, parse_test
from opml.tables import read_table

CONSTANT_SHARE = 0.02
"""Range of predicted errors, in parts of the true ones', below which they count as one value."""

FEW_ESTIMATES = 20  # estimates below which a figure says that its P_ML rests on few

SHORT_DAYS = 0.5
"""Durations up to which a figure gives errors in numbers, as a linear axis cannot show them [d]."""


@dataclass(frozen=True)
class Context:
    """Settings that a figure of one experiment's errors states."""

    note: str = ""  # what was trained and tested
    interval: tuple[float, float] | None = None  # 5th and 95th percentile of P_ML [%]
    fences: tuple[float, float] | None = None  # of the tested rows' e_y [m]
    kept: float | None = None  # share of the pairs in the days tested that the cleaning keeps [%]


def experiment_context(
    experiment: Experiment, cleaning: Cleaning, metrics: pd.DataFrame, dataset: pd.DataFrame
) -> Context:
    """Return the context of a figure of one experiment.

    metrics: the experiment's row of that table
    dataset: that table of the RSO tested on, and its cleaning
    """
    has_fences = experiment.component == "e_y" and parse_test(experiment.test).fence is None
    return Context(
        note=describe_experiment(experiment),
        interval=(float(metrics["p_ml_low"].iloc[0]), float(metrics["p_ml_high"].iloc[0])),
        fences=fences(dataset, cleaning) if has_fences else None,
        kept=100.0 * kept_share(dataset, experiment.test),
    )


def read_context(experiment: Experiment, cleaning: Cleaning, metrics: FilePath, dataset: FilePath) -> Context:
    """Return the context of a figure of one experiment, reading its tables."""
    return experiment_context(
        experiment, cleaning, read_table(metrics, "metrics"), read_table(dataset, "dataset")
    )


def kept_share(dataset: pd.DataFrame, test: str) -> float:
    """Return the share of the pairs that are kept, of those with t_j in the days of a test, or of all.

    A test without the dataset's fences keeps what they alone drop. NaN where the days have no pair.
    """
    split = parse_test(test)
    rows = dataset[in_days(dataset["t_j"], split.days)] if split.kind == "days" else dataset
    kept = rows["keep"] if split.fence is None else rows["reason"].isin(["", OUTSIDE_FENCES])
    return float(kept.mean()) if len(rows) else math.nan


def fences(dataset: pd.DataFrame, cleaning: Cleaning) -> tuple[float, float] | None:
    """Return Tukey's fences on e_y [m] that a dataset was cleaned by; None where it has none."""
    candidates = dataset[dataset["reason"].isin(["", OUTSIDE_FENCES])]
    if cleaning.fence is None or candidates.empty:
        return None
    days = cleaning.fence_days
    within = candidates if days is None else candidates[in_days(known_at(candidates), days)]
    return tukey_fences(within["e_y"].to_numpy(), fence=cleaning.fence)


def short_errors(evaluation: pd.DataFrame) -> tuple[float, float]:
    """Return the mean size of the errors up to SHORT_DAYS before and after correction; NaN without a row."""
    rows = evaluation[evaluation["duration"] <= SHORT_DAYS * DAY]
    if rows.empty:
        return math.nan, math.nan
    return float(rows["true"].abs().mean()), float(rows["residual"].abs().mean())


def p_ml_note(evaluation: pd.DataFrame, context: Context) -> str:
    """Return P_ML with its 90 % interval."""
    p_ml = judge.p_ml(evaluation["true"].to_numpy(), evaluation["predicted"].to_numpy())
    low, high = context.interval or (math.nan, math.nan)
    interval = f" (90 %: {low:.1f} to {high:.1f})" if context.interval else ""
    return f"{P_ML} = {p_ml:.1f} %{interval}"


def counts_note(evaluation: pd.DataFrame, component: str, context: Context) -> str:
    """Return how many predictions there are, and the size of short ones' errors, too small for the axis."""
    estimates = evaluation["i"].nunique()
    only = "only " if estimates < FEW_ESTIMATES else ""
    rows = f"{len(evaluation)} predictions of {only}{estimates} estimates"
    kept = "" if context.kept is None else f"; {context.kept:.3g} % of the pairs are kept"
    before, after = short_errors(evaluation)
    if math.isnan(before):
        return rows + kept
    name, change = si_unit(component), "falls" if after < before else "grows"
    sizes = f"{change} from {_digits(before)} to {_digits(after)} {name}"
    return f"{rows}{kept}\nup to {SHORT_DAYS:g} d the mean size {sizes}"


def fences_note(component: str, context: Context) -> str:
    """Return what the lines of the fences are; empty without fences."""
    if context.fences is None:
        return ""
    name, factor = unit(component)
    low, high = (f"{value * factor:.1f}".replace("-", MINUS) for value in context.fences)
    return f"dashed: {low} and {high} {name}, beyond which the cleaning drops true errors (Tukey's fences)"


def constant_note(evaluation: pd.DataFrame, component: str) -> str:
    """Return that a model gives all rows nearly one value, where it does; else nothing."""
    true, predicted = evaluation["true"], evaluation["predicted"]
    if np.ptp(predicted) > CONSTANT_SHARE * np.ptp(true) or len(evaluation) == 1:
        return ""
    value = f"{_digits(abs(predicted.median()))} {si_unit(component)}"
    return f"the model gives all rows nearly one value, {value} in size, as it does far from its training"


def _digits(value: float) -> str:
    """Return a number with three digits, or without decimals."""
    return f"{value:.0f}" if value >= 100.0 else f"{value:.3g}"
