"""Over how long sets of mean elements were fitted, told by how successive ones part along the track.

Two fits part by a parabola of time. In the middle of the time that both were fitted to, the rate at which
they part knows nothing of the curvature: of errors of least squares, one is odd about it, the other even. The
middle lies half a span before the mean of both epochs, where the rate is thus the curvature times the span.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pandas as pd
from sgp4.api import Satrec

from opml.base.constants import DAY
from opml.interop.element_sets import histories, mean_elements
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
    near = np.flatnonzero((np.diff(t) >= _GAPS[0]) & (np.diff(t) <= _GAPS[1])) + 1
    enough, satellites = _MOST, histories.satellites(sets, epoch=epoch)
    while enough and near.size:
        later, near = near[:enough], near[enough:]
        partings[later] = _partings(satellites, later, t, epoch)
        enough -= int((np.isfinite(partings[later]).all(axis=1) & ~across[:, later].any(axis=0)).sum())
    lengths, are_known = np.full(len(sets), np.nan), np.isfinite(partings).all(axis=1)
    since, told = np.array([one.counts_from for one in manoeuvres]), np.empty(0, int)
    for newest in range(1, len(sets)):
        lengths[newest] = lengths[newest - 1]
        tell = are_known & ~across[since <= t[newest]].any(axis=0)
        if not np.array_equal(told, now := np.flatnonzero(tell[: newest + 1])[:_MOST]):
            told, lengths[newest] = now, _length(*partings[now].T)
    return lengths


def _length(curvatures: np.ndarray, rates: np.ndarray) -> float:
    """Return the span [s] that explains the rates (n,) of pairs by their curvatures (n,); NaN without one."""
    if len(rates) < _FEWEST:
        return np.nan
    length = _slope(curvatures, rates)
    left = np.abs(rates - length * curvatures).sum()
    is_told = 0.0 < length < _LONGEST and left <= _UNEXPLAINED * np.abs(rates).sum()
    return max(round(length / _UNIT), 1) * _UNIT if is_told else np.nan


def _partings(satellites: Sequence[Satrec], later: np.ndarray, epochs: np.ndarray, epoch: str) -> np.ndarray:
    """Return half the curvature [m/s2] and, at the mean epoch, the rate [m/s] by which sets part (n, 2).

    later: (n,) sets, each of which is held against the one before it; epochs: of all sets [s]

    NaN where SGP4 has the object decayed, and for the same orbit twice.
    """
    t = epochs[later][:, None] - _BACK
    pairs = ([satellites[k] for k in rows] for rows in (later - 1, later))
    apart = mean_elements.differences(*pairs, epoch=epoch, t=t)[..., 1]
    partings = np.full((len(later), 2), np.nan)
    middles = 0.5 * (epochs[later - 1] + epochs[later])
    for parting, off, times in zip(partings, apart, t - middles[:, None], strict=True):
        if np.isfinite(off).all() and off.any():
            parting[:] = np.polyfit(times, off, 2)[:2]
    return partings


def _slope(x: np.ndarray, y: np.ndarray) -> float:
    """Return the slope through zero that leaves the least sum of |y|: the median of y / x, weighed by |x|."""
    slopes, weights = y / x, np.abs(x)
    order = np.argsort(slopes)
    total = np.cumsum(weights[order])
    return float(slopes[order][np.searchsorted(total, 0.5 * total[-1])])
