"""Prediction intervals that hold for unseen estimates: split-conformal, estimates as groups.

Rows of one estimate are no independent evidence, so they share one vote. The quantile is that of a mixture in
which each calibration estimate has the same weight, and one unseen estimate may lie anywhere. Then at least
`level` of the rows of a new estimate from the same population are inside, in the mean over estimates.

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


@dataclass(frozen=True)
class Conformal:
    """What intervals are to hold, and what they are calibrated on."""

    level: float  # share of the rows of an estimate inside, in the mean over estimates
    share: float  # of the estimates of the training, held out to calibrate on
    bin_hours: float  # width of the bins of durations that share a scale


@dataclass(frozen=True, eq=False)
class Widths:
    """Half the width of prediction intervals: a factor times a scale that depends on the duration."""

    duration: np.ndarray  # (bins,) [s], ascending
    scale: np.ndarray  # (bins,) typical residual, in the target's unit
    factor: float

    def at(self, duration: np.ndarray) -> np.ndarray:
        """Return half the width (n,) at durations (n,) [s].

        It is linear between the bins and constant past the ends.
        """
        return self.factor * np.interp(duration, self.duration, self.scale)


def apply(
    train: Callable[[pd.DataFrame], Model],
    training: pd.DataFrame,
    test: pd.DataFrame,
    conformal: Conformal,
    *,
    component: str,
    seed: int,
) -> pd.DataFrame:
    """Return the `intervals` table: errors of test rows, predicted, with half the width of their intervals.

    train: makes a model from rows of a dataset
    training: rows of a dataset, some of whose estimates the widths come from, the others the model
    test: rows of a dataset
    seed: of the draw of estimates

    Raises InputError as `calibrate` does.
    """
    held = held_out(training["i"].to_numpy(), share=conformal.share, seed=seed)
    model = train(training[~held])
    known, table = (
        evaluate(model, rows, np.ones(len(rows), dtype=bool), component=component)
        for rows in (training, test)
    )
    widths = calibrate(known, held, conformal)
    return table.assign(half_width=widths.at(table["duration"].to_numpy()))


def coverage_summary(table: pd.DataFrame, *, level: float, **experiment: str) -> pd.DataFrame:
    """Return the one-row `coverage` table of an `intervals` table.

    experiment: its name, part by part
    """
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
    """Return which rows (bool, n) belong to a share of the groups (n,), drawn with the seed."""
    order = derive(seed, "intervals").permutation(np.unique(groups))
    return np.isin(groups, order[: round(len(order) * share)])


def calibrate(evaluation: pd.DataFrame, held: np.ndarray, conformal: Conformal) -> Widths:
    """Return widths that hold their level of the rows of an unseen estimate.

    evaluation: `evaluation` table of a model
    held: (bool, n) rows that the model was not trained on

    The scale is the median residual of the trained rows in bins of the duration, so it does not depend on the
    rows held out. Raises InputError for too few estimates.
    """
    duration, residual, groups = (evaluation[name].to_numpy() for name in ("duration", "residual", "i"))
    centre, scale = duration_scale(duration[~held], residual[~held], bin_hours=conformal.bin_hours)
    scores = np.abs(residual[held]) / np.interp(duration[held], centre, scale)
    return Widths(centre, scale, grouped_quantile(scores, groups[held], level=conformal.level))


def duration_scale(
    duration: np.ndarray, residual: np.ndarray, *, bin_hours: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return mean duration [s] and median absolute residual (never zero) of bins of durations."""
    bins = np.unique(np.floor(duration / (HOUR * bin_hours)), return_inverse=True)[1]
    members = [bins == k for k in range(bins.max() + 1)]
    centre = np.array([duration[member].mean() for member in members])
    scale = np.array([np.median(np.abs(residual[member])) for member in members])
    return centre, np.maximum(scale, 1e-6 * scale.max() or 1.0)


def grouped_quantile(scores: np.ndarray, groups: np.ndarray, *, level: float) -> float:
    """Return the least q such that scores up to q hold `level` of the groups and of one more at infinity.

    Raises InputError where that group weighs more than the level leaves out.
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
    """Return the share of the rows inside their intervals, and its mean over estimates (the level)."""
    inside = np.abs(residual) <= half_width
    group = np.unique(groups, return_inverse=True)[1]
    by_group = np.bincount(group, inside) / np.bincount(group)
    return float(inside.mean()), float(by_group.mean())
