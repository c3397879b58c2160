"""Close approaches of two objects whose states are known every minute or so: when, and how near.

The distance of two paths is looked at every minute of the time that
they share. It has a minimum between two looks where the objects approach at the first and part at the second:
near each other they move almost straight in a minute, or so slowly that the distance hardly changes. The
minimum is refined on the same polynomials. Where the time that they share begins while they part, or ends
while they approach, they are closest at that end.
"""

import math

import numpy as np

from opml.interop.ephemeris import Ephemeris

STEP = 60.0  # time between two looks at the distance [s]
_FASTEST = 25e3  # relative speed of two objects bound to the Earth, head on at its surface [m/s]
_HALVINGS = 36  # of a look's step, to a nanosecond


def shared(one: Ephemeris, other: Ephemeris) -> tuple[float, float]:
    """Return when the time that two paths share begins and ends [s]; it is none where it ends first."""
    return float(max(one.t[0], other.t[0])), float(min(one.t[-1], other.t[-1]))


def find(one: Ephemeris, other: Ephemeris, *, within: float) -> list[tuple[float, bool]]:
    """Return when the distance of two paths is least [s], in the order of time, and whether it is at an end.

    within: largest distance [m]

    At an end of the time that both share they may come nearer beyond.
    """
    begin, end = shared(one, other)
    (low, high), (other_low, other_high) = one.heights, other.heights
    if begin >= end or max(low, other_low) - min(high, other_high) > within:
        return []
    minutes = STEP * np.arange(math.floor(begin / STEP) + 1, math.ceil(end / STEP))
    times = np.concatenate([[begin], minutes, [end]])
    distances, partings = _apart(one, other, times)
    near = distances < within + _FASTEST * STEP
    turns = np.flatnonzero((partings[:-1] < 0.0) & (partings[1:] >= 0.0) & near[1:])
    t = _turned(one, other, times[turns], times[turns + 1])
    refined, _ = _apart(one, other, t)
    approaches = [(at, False) for at in t[refined <= within].tolist()]
    if partings[0] >= 0.0 and distances[0] <= within:
        approaches.insert(0, (begin, True))
    if partings[-1] < 0.0 and distances[-1] <= within:
        approaches.append((end, True))
    return approaches


def _apart(one: Ephemeris, other: Ephemeris, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return distances (n,) [m] at times (n,) [s], and how fast their halved squares grow [m2/s]."""
    relative = other.at(t) - one.at(t)
    return np.linalg.norm(relative[:, :3], axis=1), np.einsum("nk,nk->n", relative[:, :3], relative[:, 3:])


def _turned(one: Ephemeris, other: Ephemeris, before: np.ndarray, after: np.ndarray) -> np.ndarray:
    """Return when (n,) the objects turn from approaching to parting between times (n,) [s]."""
    for _ in range(_HALVINGS):
        middle = 0.5 * (before + after)
        is_before = _apart(one, other, middle)[1] < 0.0
        before, after = np.where(is_before, middle, before), np.where(is_before, after, middle)
    return after
