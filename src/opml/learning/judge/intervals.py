"""Prediction intervals that hold for estimates not seen: split-conformal, estimates as groups.

Rows of one estimate are no independent evidence, so they share one vote: the quantile is that of a mixture
in which each calibration estimate weighs the same and one more, unseen, may lie anywhere. For a new estimate
drawn like those, at least `level` of its rows are then inside, in the mean over estimates.

Source: Dunn, Wasserman & Ramdas 2023, Distribution-free prediction sets for two-layer hierarchical models,
J. Am. Stat. Assoc. 118 (pooling CDFs); Vovk, Gammerman & Shafer 2005, Algorithmic Learning in a Random World,
for split-conformal; Lei et al. 2018, J. Am. Stat. Assoc. 113, for residuals divided by a local scale.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pandas as pd

from opml.base.constants import DAY, HOUR
from opml.base.errors import InputError
from opml.base.seeds import derive
from opml.learning.judge.evaluation import evaluate
from opml.learning.models.contract import Model


@dataclass(frozen=True, eq=False)
class Widths:
    """Half the width of prediction intervals, a factor times a scale that depends on the duration."""

    duration: np.ndarray  # (bins,) [s], ascending
    scale: np.ndarray  # (bins,) typical residual, in the target's unit
    factor: float
    level: float

    def at(self, duration: np.ndarray) -> np.ndarray:
        """Half the width (n,) at durations (n,) [s], linear between the bins and constant past the ends."""
        half: np.ndarray = self.factor * np.interp(duration, self.duration, self.scale)
        return half


def apply(
    train: Callable[[pd.DataFrame], Model],
    training: pd.DataFrame,
    test: pd.DataFrame,
    *,
    component: str,
    level: float,
    share: float,
    bin_hours: float,
    seed: int,
) -> pd.DataFrame:
    """The `intervals` table: the test rows' errors, predicted, with half the width of their intervals.

    `train` makes a model of rows of the `training` dataset: it is given all but those of a share of the
    estimates, which the widths come from. Raises InputError as `calibrate` does.
    """
    held = held_out(training["i"].to_numpy(), share=share, seed=seed)
    model = train(training[~held])
    every = np.ones(len(training), dtype=bool)
    widths = calibrate(
        training["duration"].to_numpy(),
        evaluate(model, training, every, component=component)["residual"].to_numpy(),
        training["i"].to_numpy(),
        held,
        level=level,
        bin_hours=bin_hours,
    )
    table = evaluate(model, test, np.ones(len(test), dtype=bool), component=component)
    return table.assign(half_width=widths.at(table["duration"].to_numpy()))


def summary(table: pd.DataFrame, *, level: float, **experiment: str) -> pd.DataFrame:
    """The one-row `coverage` table of an `intervals` table; the other options name the experiment."""
    half = table["half_width"]
    rows, estimates = coverage(table["residual"].to_numpy(), half.to_numpy(), table["i"].to_numpy())
    last_day = table["duration"] > table["duration"].max() - DAY
    row = experiment | {
        "level": level,
        "rows_inside": rows,
        "estimates_inside": estimates,
        "half_width": float(half.median()),
        "half_width_last_day": float(half[last_day].median()),
        "error_last_day": float(table.loc[last_day, "true"].abs().median()),
    }
    return pd.DataFrame([row])


def held_out(groups: np.ndarray, *, share: float, seed: int) -> np.ndarray:
    """Which rows (bool, n) belong to the share of the groups (n,) that a model is calibrated on."""
    order = derive(seed, "intervals").permutation(np.unique(groups))
    return np.isin(groups, order[: round(len(order) * share)])


def calibrate(
    duration: np.ndarray,
    residual: np.ndarray,
    groups: np.ndarray,
    held: np.ndarray,
    *,
    level: float,
    bin_hours: float,
) -> Widths:
    """Widths that hold `level` of the rows, for a model that was trained on rows not `held` (bool, n).

    duration (n,) [s], residual (n,), groups (n,) the estimate of each row. The scale is the median residual
    of the trained rows in bins of bin_hours, so that it owes nothing to the calibration. Raises InputError
    where there are too few estimates for the level.
    """
    centre, scale = duration_scale(duration[~held], residual[~held], bin_hours=bin_hours)
    scores = np.abs(residual[held]) / np.interp(duration[held], centre, scale)
    return Widths(centre, scale, grouped_quantile(scores, groups[held], level=level), level)


def duration_scale(
    duration: np.ndarray, residual: np.ndarray, *, bin_hours: float
) -> tuple[np.ndarray, np.ndarray]:
    """Mean duration [s] and median absolute residual of bins of durations, the latter never zero."""
    bins = np.unique(np.floor(duration / (HOUR * bin_hours)), return_inverse=True)[1]
    members = [bins == k for k in range(bins.max() + 1)]
    centre = np.array([duration[member].mean() for member in members])
    scale = np.array([np.median(np.abs(residual[member])) for member in members])
    return centre, np.maximum(scale, 1e-6 * scale.max() or 1.0)


def grouped_quantile(scores: np.ndarray, groups: np.ndarray, *, level: float) -> float:
    """Least q such that scores up to q hold `level` of the mixture of the groups and one more at infinity.

    Raises InputError where that one more outweighs what the level leaves out.
    """
    group, count = np.unique(groups, return_inverse=True, return_counts=True)[1:]
    if len(count) / (len(count) + 1.0) < level:
        raise InputError(
            f"intervals: expected estimates enough to calibrate on for a level of {level:g}, got {len(count)}"
        )
    order = np.argsort(scores, kind="stable")
    weight = np.cumsum(1.0 / count[group[order]]) / (len(count) + 1.0)
    # Rounding of the sum must not push the quantile past the last score.
    place = min(int(np.searchsorted(weight, level - 1e-12)), len(scores) - 1)
    return float(scores[order][place])


def coverage(residual: np.ndarray, half_width: np.ndarray, groups: np.ndarray) -> tuple[float, float]:
    """Share of the rows inside their intervals, and its mean over estimates (what the level promises)."""
    inside = np.abs(residual) <= half_width
    group = np.unique(groups, return_inverse=True)[1]
    by_group = np.bincount(group, inside) / np.bincount(group)
    return float(inside.mean()), float(by_group.mean())
