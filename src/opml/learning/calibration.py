"""Is an uncertainty true? Shares of errors inside what was stated, by the prediction's duration."""

from collections.abc import Callable, Sequence
from statistics import NormalDist
from typing import Any

import numpy as np
import pandas as pd
from scipy.stats import chi2

from opml.constants import DAY
from opml.errors import InputError
from opml.learning.growth import REACH_DAYS
from opml.learning.paths import AXES, POSITION
from opml.learning.uncertainty import Uncertainty, mahalanobis
from opml.tables import ELLIPSOID, FIT, LEVELS, RESIDUALS

MARKS = (1.0, 3.0, 5.0, 7.0)
"""Prediction durations that the shares are stated at [days]."""

HalfWidth = Callable[[int, float], np.ndarray]
"""Half the widths (n,) [m] of an axis, by its place in AXES, at a level."""


def marks(longest_days: float) -> list[float]:
    """The durations [days] that shares are stated at, where predictions last up to longest_days."""
    return [day for day in MARKS if day <= longest_days] or [longest_days]


def of_residuals(
    uncertainty: Uncertainty,
    errors: np.ndarray,
    duration: np.ndarray,
    age: np.ndarray,
    *,
    days: Sequence[float],
) -> pd.DataFrame:
    """The `calibration` table, less the experiment, of corrected positions.

    errors: (n, 3) what the correction left [m], RSW; duration, age: (n,) since the estimate and since the
    training's end [s]; days: the durations to state shares at [days]. Raises InputError where no row has any.
    """

    def half_width(axis: int, level: float) -> np.ndarray:
        return uncertainty.half_width(AXES[axis], duration, age, level)

    covariance = uncertainty.residual_covariance(duration, age)
    return _summary(half_width, covariance, errors, duration, days).assign(basis=RESIDUALS)


def of_fits(
    covariance: np.ndarray, errors: np.ndarray, duration: np.ndarray, *, days: Sequence[float]
) -> pd.DataFrame:
    """The same for positions whose covariances (n, 3, 3) [m2] are stated, as if the errors were normal."""
    sigma = np.sqrt(np.diagonal(covariance, axis1=1, axis2=2))

    def half_width(axis: int, level: float) -> np.ndarray:
        half: np.ndarray = NormalDist().inv_cdf(0.5 + level / 2.0) * sigma[:, axis]
        return half

    return _summary(half_width, covariance, errors, duration, days).assign(basis=FIT)


def _summary(
    half_width: HalfWidth,
    covariance: np.ndarray,
    errors: np.ndarray,
    duration: np.ndarray,
    days: Sequence[float],
) -> pd.DataFrame:
    """One row per quantity, duration and level."""
    size, distance = np.abs(errors), mahalanobis(errors, covariance)
    found: list[dict[str, Any]] = []
    for day in days:
        near = np.abs(duration / DAY - day) <= REACH_DAYS
        for level in LEVELS if near.any() else ():
            at = {"day": float(day), "rows": int(near.sum()), "level": level}
            for k, quantity in enumerate(POSITION):
                found.append(
                    {**at, "quantity": quantity, **_shares(size[near, k], half_width(k, level)[near], level)}
                )
            stated = np.full(near.sum(), chi2.ppf(level, len(AXES)))
            found.append({**at, "quantity": ELLIPSOID, **_shares(distance[near], stated, level)})
    if not found:
        raise InputError(
            f"calibration: expected predictions over {', '.join(f'{day:g}' for day in days)} days, got none"
        )
    return pd.DataFrame(found)


def _shares(size: np.ndarray, stated: np.ndarray, level: float) -> dict[str, float]:
    """Share of sizes (n,) inside what was stated (n,), and both in their own unit."""
    return {
        "inside": float(np.mean(size <= stated)),
        "stated": float(np.median(stated)),
        "found": float(np.quantile(size, level)),
    }
