"""Scores of a corrector: the share of SGP4's errors that predictions leave, by band of height and lead.

Predictions of one week share its weather, and those of one object its drag. Intervals therefore come from
drawing whole weeks and whole objects, each with replacement and independently; a prediction counts as
often as its week and its object were drawn together (Owen 2007, 'The pigeonhole bootstrap').
"""

from collections.abc import Iterator

import numpy as np
import pandas as pd

from opml.base.seeds import derive
from opml.element_sets import corrector
from opml.element_sets.corrector_trial import ORBIT
from opml.element_sets.weighting import UNCHANGED
from opml.learning.judge.metrics import p_ml

ALL = -1  # number of the band that stands for all of them
LEVEL = 100.0 * corrector.LEVEL  # share of the errors [%] that the intervals of the learned sigma are to hold
LARGEST = 5.0  # standard deviations that an error counts at most in a log score
DRAWS = 400  # draws of weeks and objects

_WEEK = 7
_INTERVAL = (2.5, 97.5)
_MODELS = ("scaled", "learned", "improved")


def scores(residuals: pd.DataFrame, *, seed: int) -> pd.DataFrame:
    """Return the table `catalogue_scores` without test and learner, all bands together first.

    residuals: `catalogue_residuals`
    seed: of the draws of weeks and objects
    """
    parts = []
    for (band, lead), part in _cells(residuals):
        rng = derive(seed, "weeks and objects", str(band), str(lead))
        parts.append({"band": band, "lead": lead, **_score(part), **intervals(part, rng)})
    return pd.DataFrame(parts)


def _cells(residuals: pd.DataFrame) -> Iterator[tuple[tuple[int, int], pd.DataFrame]]:
    """Yield band, lead and their residuals."""
    for table in (residuals.assign(band=ALL), residuals):
        for (band, lead), part in table.groupby(["band", "lead"]):
            yield (int(band), int(lead)), part


def _score(part: pd.DataFrame) -> dict[str, float]:
    """Return the numbers of one band and lead but for their intervals."""
    sgp4 = part["error"].abs()
    scores = {
        "predictions": len(part),
        "objects": part["number"].nunique(),
        "weeks": len(np.unique(_week(part))),
        "by_orbits": 100.0 * (part["judge"] == ORBIT).mean(),
        "sgp4_median": sgp4.median(),
        "sgp4_p95": sgp4.quantile(0.95),
        "coverage": coverage(part["learned"], part["sigma"]),
        "improved_coverage": coverage(part["improved"], part["improved_sigma"]),
        "worst_week": worst_week(part),
        "unchanged": 100.0 * (part["applied"] == UNCHANGED).mean(),
    }
    for model in _MODELS:
        left = part[model].abs()
        scores |= {
            f"{model}_median": 100.0 * left.median() / sgp4.median(),
            f"{model}_p95": 100.0 * left.quantile(0.95) / sgp4.quantile(0.95),
            f"{model}_p_ml": p_ml(part["error"].to_numpy(), (part["error"] - part[model]).to_numpy()),
        }
    return scores


def coverage(left: pd.Series, sigma: pd.Series) -> float:
    """Return the share [%] of what is left inside its intervals of LEVEL; NaN without a sigma."""
    known = np.isfinite(sigma)
    return float(100.0 * (left[known].abs() <= corrector.NORMAL * sigma[known]).mean())


def worst_week(part: pd.DataFrame) -> float:
    """Return the least coverage [%] of the improved sets' intervals in a week."""
    weeks = part.groupby(_week(part))
    return min(coverage(week["improved"], week["improved_sigma"]) for _, week in weeks)


def log_score(left: pd.Series, sigma: pd.Series, largest: float = LARGEST) -> float:
    """Return the mean of ln(sigma / 1 m) + (left / sigma)^2 / 2, the less the better (Good 1952).

    No error counts more than `largest` sigma: it is a burn.
    """
    return float((np.log(sigma) + 0.5 * np.minimum((left / sigma) ** 2, largest**2)).mean())


def _week(part: pd.DataFrame) -> np.ndarray:
    return np.asarray(np.floor(part["morning"].to_numpy() / _WEEK).astype(int))


def intervals(part: pd.DataFrame, rng: np.random.Generator) -> dict[str, float]:
    """Return the intervals of 95 % of the shares of SGP4's median.

    part: residuals of one band and lead
    """
    draws = np.array(list(_drawn_shares(part, rng)))
    low, high = np.percentile(draws, _INTERVAL, axis=0)
    return {f"{name}_low": low[k] for k, name in enumerate(_MODELS)} | {
        f"{name}_high": high[k] for k, name in enumerate(_MODELS)
    }


def _drawn_shares(part: pd.DataFrame, rng: np.random.Generator) -> Iterator[list[float]]:
    """Yield the shares [%] of draws of weeks and objects."""
    sizes = np.abs(part[["error", *_MODELS]].to_numpy())
    orders = np.argsort(sizes, axis=0, kind="stable")
    for weights in drawn_weights(part, rng):
        sgp4, *left = map(weighted_median, np.take_along_axis(sizes, orders, 0).T, weights[orders].T)
        yield [100.0 * one / sgp4 for one in left]


def drawn_weights(part: pd.DataFrame, rng: np.random.Generator) -> Iterator[np.ndarray]:
    """Yield how often each row (n,) counts in draws of weeks and objects; one without any is passed over.

    part: with columns number and morning (modified Julian day)
    """
    places = [np.unique(of, return_inverse=True)[1] for of in (_week(part), part["number"].to_numpy())]
    drawn = 0
    while drawn < DRAWS:
        weights = np.prod([_times_drawn(place, rng) for place in places], axis=0)
        if weights.any():
            drawn += 1
            yield weights


def _times_drawn(place: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Return how often the member of each row (n,) is drawn, of as many draws as there are members."""
    count = int(place.max()) + 1
    return np.asarray(np.bincount(rng.integers(count, size=count), minlength=count)[place])


def weighted_median(ascending: np.ndarray, weights: np.ndarray) -> float:
    """Return the median of values that count by whole weights; the lower one of two in the middle."""
    totals = np.cumsum(weights)
    return float(ascending[np.searchsorted(totals, 0.5 * totals[-1])])
