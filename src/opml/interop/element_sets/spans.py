"""Over how long sets of mean elements were fitted, told by how successive ones part along the track.

Two fits part by a parabola of time. In the middle of the time that both were fitted to, the rate at which
they part knows nothing of the curvature: of errors of least squares, one is odd about it, the other even. The
middle lies half a span before the mean of both epochs, where the rate is thus the curvature times the span.
"""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pandas as pd

from opml.base.constants import DAY
from opml.interop.element_sets.histories import states_of
from opml.orbits.elements import in_rsw
from opml.orbits.manoeuvres import Manoeuvre, contain_any

_BACK = np.arange(0.0, 5.0 * DAY, 1800.0)
"""Times before the later epoch at which two sets are compared with each other [s]."""

_GAPS = (0.1 * DAY, 3.0 * DAY)  # least and longest time between the epochs of two sets

_BEFORE = DAY
"""Time before two sets in which a manoeuvre spoils what they tell [s]: the earlier was fitted across it."""

_LONGEST = 2.0 * float(_BACK[-1])
"""Longest span that is told [s]: the middle of a longer one lies before all that two sets are held at."""

_FEWEST, _MOST = 8, 30  # pairs of sets that tell a span
_UNIT = 0.5 * DAY  # spans are multiples of it [s]: people choose them, and pairs tell them to some hours

_UNEXPLAINED = 0.3
"""Part of the rates' size that a span may leave; an object with little drag has none that explains them.

Below 430 km 0.1 to 0.26 are left, at 800 km 0.4 and more, where points over the span that is told are worse.
Sets a day apart leave more of a short span: 0.35 of 48 hours.
"""


def fit_spans(sets: pd.DataFrame, *, epoch: str, manoeuvres: Sequence[Manoeuvre] = ()) -> np.ndarray:
    """Return over how long sets (n,) were fitted [s], each as it and those before it tell; NaN where not.

    sets: table `element_sets` of one object
    manoeuvres: pairs of sets with one between them or shortly before say nothing, from when it is known

    The first pairs of a history tell, so that the span hardly changes once it is found.
    """
    t, partings = sets["t"].to_numpy(), np.full((len(sets), 2), np.nan)
    begins = np.concatenate([[np.nan], t[:-1] - _BEFORE])
    across = np.zeros((len(manoeuvres), len(sets)), bool)
    for row, one in zip(across, manoeuvres, strict=True):
        row[:] = contain_any(begins, t, [replace(one, known=one.t)])
    enough = _MOST
    for later, pair in enumerate(pairwise(row for _, row in sets.iterrows()), start=1):
        if enough and _is_near(*pair):
            partings[later] = _parting(*pair, epoch)
            enough -= bool(np.isfinite(partings[later]).all() and not across[:, later].any())
    lengths, are_known = np.full(len(sets), np.nan), np.isfinite(partings).all(axis=1)
    since = np.array([one.counts_from for one in manoeuvres])
    for newest in range(1, len(sets)):
        tell = are_known & ~across[since <= t[newest]].any(axis=0)
        lengths[newest] = _length(*partings[: newest + 1][tell[: newest + 1]][:_MOST].T)
    return lengths


def _length(curvatures: np.ndarray, rates: np.ndarray) -> float:
    """Return the span [s] that explains the rates (n,) of pairs by their curvatures (n,); NaN without one."""
    if len(rates) < _FEWEST:
        return np.nan
    length = _slope(curvatures, rates)
    left = np.abs(rates - length * curvatures).sum()
    is_told = 0.0 < length < _LONGEST and left <= _UNEXPLAINED * np.abs(rates).sum()
    return max(round(length / _UNIT), 1) * _UNIT if is_told else np.nan


def _is_near(earlier: pd.Series, later: pd.Series) -> bool:
    return bool(_GAPS[0] <= later["t"] - earlier["t"] <= _GAPS[1])


def _parting(earlier: pd.Series, later: pd.Series, epoch: str) -> tuple[float, float]:
    """Return half the curvature [m/s2] and, at the mean epoch, the rate [m/s] by which two sets part.

    NaN where SGP4 has the object decayed, and for the same orbit twice.
    """
    t = later["t"] - _BACK
    states, others = (states_of(one, epoch=epoch, t=t) for one in (later, earlier))
    apart = in_rsw(others - states, states)[:, 1]
    if not np.isfinite(apart).all() or not apart.any():
        return np.nan, np.nan
    curvature, rate, _ = np.polyfit(t - 0.5 * (earlier["t"] + later["t"]), apart, 2)
    return float(curvature), float(rate)


def _slope(x: np.ndarray, y: np.ndarray) -> float:
    """Return the slope through zero that leaves the least sum of |y|: the median of y / x, weighed by |x|."""
    slopes, weights = y / x, np.abs(x)
    order = np.argsort(slopes)
    total = np.cumsum(weights[order])
    return float(slopes[order][np.searchsorted(total, 0.5 * total[-1])])
