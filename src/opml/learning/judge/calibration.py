"""Is an uncertainty true? Shares of errors inside what is stated, by the prediction's duration.

And whether squared Mahalanobis distances are distributed as chi-square(3), as those of a true covariance are:
the test of goodness of fit by the empirical distribution that conjunction assessment uses (Zaidi & Hejduk
2016, AIAA 2016-5628), here by Cramer and von Mises; beside it a proper score, as wide covariances pass less
easily than they hold (Gneiting & Raftery 2007, J. Am. Stat. Assoc. 102, sec. 4.1).
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd

from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.learning.data.components import POSITION
from opml.learning.judge.error_sizes import covariances
from opml.learning.judge.errors_by_duration import REACH_DAYS
from opml.orbits.rsw_covariance import half_width, mahalanobis
from opml.tables import COMPONENTS, DOUBT, ELLIPSOID, LEVELS, PLANE, SIGMA_STATE, WHOLE

MARKS = (1.0, 3.0, 5.0, 7.0)
"""Prediction durations that the shares are stated at [days]."""

PASSES = 0.05
"""Least p-value at which distances count as those of a true covariance."""

LEAST = 5
"""Mornings that the test of the distances needs."""


def marks(longest_days: float) -> list[float]:
    """The durations [days] that shares are stated at, where predictions last up to longest_days."""
    return [day for day in MARKS if day <= longest_days] or [longest_days]


def of_covariances(
    covariance: np.ndarray, errors: np.ndarray, duration: np.ndarray, *, days: Sequence[float]
) -> pd.DataFrame:
    """The `calibration` table, less the experiment, of errors whose covariances are stated.

    errors: (n, k) in RSW [m, m/s], of positions (k = 3) or of states (k = 6); covariance: (n, k, k);
    duration: (n,) [s]; days: the durations to state shares at [days]. Intervals are those of normal errors.
    Raises InputError where no row has one of the durations.
    """
    quantities = _quantities(covariance, errors)
    found: list[dict[str, Any]] = []
    for day in days:
        near = np.abs(duration / DAY - day) <= REACH_DAYS
        for level in LEVELS if near.any() else ():
            at = {"day": float(day), "rows": int(near.sum()), "level": level}
            for quantity, (size, bound) in quantities.items():
                stated = bound(level)[near]
                found.append(
                    at
                    | {
                        "quantity": quantity,
                        "inside": float(np.mean(size[near] <= stated)),
                        "stated": float(np.median(stated)),
                        "found": float(np.quantile(size[near], level)),
                    }
                )
    if not found:
        raise InputError(
            f"calibration: expected predictions over {', '.join(f'{day:g}' for day in days)} days, got none"
        )
    return pd.DataFrame(found)


def _quantities(
    covariance: np.ndarray, errors: np.ndarray
) -> dict[str, tuple[np.ndarray, Callable[[float], np.ndarray]]]:
    """Sizes (n,) of errors and the bounds (n,) that hold a level of them, by quantity."""
    from scipy.stats import chi2  # half a second that no plan should wait for

    sigma = np.sqrt(np.diagonal(covariance, axis1=1, axis2=2))

    def interval(k: int) -> Callable[[float], np.ndarray]:
        return lambda level: half_width(level) * sigma[:, k]

    def ellipsoid(parts: int) -> tuple[np.ndarray, Callable[[float], np.ndarray]]:
        distance = mahalanobis(errors[:, :parts], covariance[:, :parts, :parts])
        return distance, lambda level: np.full(len(distance), float(chi2.ppf(level, parts)))

    sizes = {name: (np.abs(errors[:, k]), interval(k)) for k, name in enumerate(POSITION)}
    together = {PLANE: 2, ELLIPSOID: 3} | ({WHOLE: 6} if errors.shape[1] == 6 else {})
    return sizes | {name: ellipsoid(parts) for name, parts in together.items()}


def of_replay(replay: pd.DataFrame, *, days: Sequence[float]) -> pd.DataFrame:
    """The same of the rows of a `replay` table whose mornings could state a covariance."""
    told, covariance = _stated(replay)
    errors = told[list(COMPONENTS)].to_numpy()
    return of_covariances(covariance, errors, told["duration"].to_numpy(), days=days)


def of_replays(replays: Mapping[str, pd.DataFrame], *, days: Sequence[float]) -> dict[str, pd.DataFrame]:
    """The same of several tables by their names; those whose mornings had too short a past are left out."""
    found = {}
    for name, table in replays.items():
        try:
            found[name] = of_replay(table, days=days)
        except InputError:
            continue
    return found


def _stated(replay: pd.DataFrame) -> tuple[pd.DataFrame, np.ndarray]:
    """Rows of a `replay` table that have a covariance, and (n, 6, 6) those of their errors.

    A state that an ephemeris is held against may be off, too.
    """
    told = replay[np.isfinite(replay[SIGMA_STATE].to_numpy()).all(axis=1)]
    covariance = covariances(told, told[SIGMA_STATE].to_numpy())
    covariance[:, range(3), range(3)] += told[DOUBT].to_numpy() ** 2
    return told, covariance


def goodness(replay: pd.DataFrame, *, days: Sequence[float]) -> pd.DataFrame:
    """Whether the covariances of a `replay` table's positions are true, one row per duration [days].

    day; mornings: how many have a prediction of about that duration, one of which is taken, as those of a
    morning share their weather; p: of Cramer and von Mises' test of their squared Mahalanobis distances
    against chi-square(3), NaN of fewer than LEAST; score: mean of -ln of the stated density at the error, of
    all rows.
    """
    from scipy.stats import chi2, cramervonmises

    told, covariance = _stated(replay)
    covariance = covariance[:, :3, :3]
    distance = mahalanobis(told[POSITION].to_numpy(), covariance)
    score = 0.5 * (distance + np.linalg.slogdet(2.0 * np.pi * covariance)[1])
    off, found = (told["duration"] / DAY).to_numpy(), []
    for day in days:
        near = np.abs(off - day) <= REACH_DAYS
        if not near.any():
            continue
        rows = told[near].assign(off=np.abs(off[near] - day), distance=distance[near])
        one = rows.sort_values("off", kind="stable").groupby("morning")["distance"].first()
        p = cramervonmises(one, chi2(3).cdf).pvalue if len(one) >= LEAST else np.nan
        found.append(
            {"day": float(day), "mornings": len(one), "p": float(p), "score": float(score[near].mean())}
        )
    return pd.DataFrame(found, columns=["day", "mornings", "p", "score"])
