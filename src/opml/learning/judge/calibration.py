"""Is an uncertainty true? Shares of errors inside the stated bounds, by prediction duration.

Squared Mahalanobis distances of a true covariance are distributed as chi-square(3). Conjunction assessment
tests that by the empirical distribution (Zaidi & Hejduk 2016, AIAA 2016-5628); the test here is Cramer and
von Mises'. Wide covariances pass it easily, so a proper score is given, too (Gneiting & Raftery 2007, J.
Am. Stat. Assoc. 102, sec. 4.1).
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd

from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.learning.data.error_components import POSITION
from opml.learning.judge.error_sizes import INSIDE, LEVEL
from opml.learning.judge.errors_by_duration import REACH_DAYS
from opml.orbits.rsw_covariance import mahalanobis, rsw_covariances
from opml.tables import COMPONENTS, DOUBT, ELLIPSOID, PLANE, SIGMA_STATE, WHOLE

_MARKS = (1.0, 3.0, 5.0, 7.0)  # prediction durations that the shares are stated at [days]
PASSES = 0.05  # least p-value at which a covariance counts as true
LEAST = 5  # mornings that the test of distances needs


def marks(longest_days: float) -> list[float]:
    """Return the durations [days] to state shares at, where predictions last up to longest_days."""
    return [day for day in _MARKS if day <= longest_days] or [longest_days]


def of_covariances(
    covariance: np.ndarray, errors: np.ndarray, duration: np.ndarray, *, days: Sequence[float]
) -> pd.DataFrame:
    """Return the shares of errors inside what nine tenths of them should be inside, by duration and quantity.

    covariance: (n, k, k) of positions (k = 3) or states (k = 6), in RSW [m, m/s]
    errors: (n, k) in RSW [m, m/s]
    duration: (n,) [s]
    days: durations to state shares at [days]

    Columns: day [d], rows, quantity, inside, stated (median bound [m], or squared distance). Intervals assume
    normal errors. Raises InputError where no row has one of the durations.
    """
    quantities = _quantities(covariance, errors)
    rows: list[dict[str, Any]] = []
    for day in days:
        near = np.abs(duration / DAY - day) <= REACH_DAYS
        for quantity, (size, bound) in quantities.items() if near.any() else ():
            shares = {
                "inside": float(np.mean((size <= bound)[near])),
                "stated": float(np.median(bound[near])),
            }
            rows.append({"day": float(day), "rows": int(near.sum()), "quantity": quantity} | shares)
    if not rows:
        raise InputError(
            f"calibration: expected predictions over {', '.join(f'{day:g}' for day in days)} days, got none"
        )
    return pd.DataFrame(rows)


def _quantities(covariance: np.ndarray, errors: np.ndarray) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Return, by quantity, sizes (n,) of errors and the bounds (n,) that LEVEL of them should be inside."""
    from scipy.stats import chi2  # takes half a second to import, too long for a plan

    def ellipsoid(parts: int) -> tuple[np.ndarray, np.ndarray]:
        distance = mahalanobis(errors[:, :parts], covariance[:, :parts, :parts])
        return distance, np.full(len(distance), float(chi2.ppf(LEVEL, parts)))

    bounds = INSIDE * np.sqrt(np.diagonal(covariance, axis1=1, axis2=2))
    intervals = {name: (np.abs(errors[:, k]), bounds[:, k]) for k, name in enumerate(POSITION)}
    together = {PLANE: 2, ELLIPSOID: 3} | ({WHOLE: 6} if errors.shape[1] == 6 else {})
    return intervals | {name: ellipsoid(parts) for name, parts in together.items()}


def of_replay(replay: pd.DataFrame, *, days: Sequence[float]) -> pd.DataFrame:
    """Return the shares of those rows of a `replay` table that have a covariance.

    days: durations to state shares at [days]
    """
    rows, covariance = _stated(replay)
    errors = rows[list(COMPONENTS)].to_numpy()
    return of_covariances(covariance, errors, rows["duration"].to_numpy(), days=days)


def of_replays(replays: Mapping[str, pd.DataFrame], *, days: Sequence[float]) -> dict[str, pd.DataFrame]:
    """Return the shares of `replay` tables, by name, without those that have no covariance.

    days: durations to state shares at [days]
    """
    tables = {}
    for name, table in replays.items():
        try:
            tables[name] = of_replay(table, days=days)
        except InputError:
            continue
    return tables


def _stated(replay: pd.DataFrame) -> tuple[pd.DataFrame, np.ndarray]:
    """Return the rows of a `replay` table that have a covariance, and the covariances (n, 6, 6) of errors.

    They include those of the states that predictions are compared with.
    """
    rows = replay[np.isfinite(replay[SIGMA_STATE].to_numpy()).all(axis=1)]
    covariance = rsw_covariances(rows[SIGMA_STATE].to_numpy(float), rows["rate"].to_numpy())
    covariance[:, range(3), range(3)] += rows[DOUBT].to_numpy(float) ** 2
    return rows, covariance


def goodness(replay: pd.DataFrame, *, days: Sequence[float]) -> pd.DataFrame:
    """Return how well the covariances of positions in a `replay` table fit the errors, one row per duration.

    days: durations [days]

    day: the duration
    mornings: those with a prediction of about that duration; the nearest one of each is tested, because the
        predictions of a morning share their weather
    p: of Cramer and von Mises' test of squared Mahalanobis distances against chi-square(3), NaN for fewer
        than LEAST mornings
    score: mean of -ln of the stated density at the error, over all rows
    """
    from scipy.stats import chi2, cramervonmises

    stated, covariance = _stated(replay)
    covariance = covariance[:, :3, :3]
    distance = mahalanobis(stated[POSITION].to_numpy(), covariance)
    score = 0.5 * (distance + np.linalg.slogdet(2.0 * np.pi * covariance)[1])
    duration, tests = (stated["duration"] / DAY).to_numpy(), []
    for day in days:
        near = np.abs(duration - day) <= REACH_DAYS
        if not near.any():
            continue
        rows = stated[near].assign(off=np.abs(duration[near] - day), distance=distance[near])
        nearest = rows.sort_values("off", kind="stable").groupby("morning")["distance"].first()
        p = cramervonmises(nearest, chi2(3).cdf).pvalue if len(nearest) >= LEAST else np.nan
        tests.append(
            {"day": float(day), "mornings": len(nearest), "p": float(p), "score": float(score[near].mean())}
        )
    return pd.DataFrame(tests, columns=["day", "mornings", "p", "score"])
