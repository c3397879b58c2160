"""Objects that may come near each other, by samples of their states by SGP4, coarse, then fine.

Between two looks objects move relative to each other almost straight: off that by at most the tide in
the time to the nearest look, and what SGP4's velocities are off. What is farther at its nearest
on the straight path is left out, and so no approach is lost.
"""

from collections.abc import Iterator, Sequence

import numpy as np
from scipy.spatial import KDTree

from opml.base.constants import WGS84_A
from opml.interop.element_sets.burns_in_sets import KnownSet
from opml.interop.element_sets.element_set import propagate
from opml.interop.element_sets.teme import teme_to_gcrf
from opml.interop.ephemeris import Ephemeris

LOOK = 240.0  # longest time between two looks at one object and ours [s]
LOOK_AT_ALL = 30.0  # longest time between two looks at all objects [s]
STEEP = 1e-3 * WGS84_A + 200.0  # distance from the Earth's centre below which sets may descend steeply [km]
_CLOSER = 12  # looks from one of the first to the next
Span = tuple[float, float]  # when something begins and ends [s]
_TIDE = 1.7e-6  # half the largest difference of attraction over a distance, 100 km below the surface [1/s2]
_OFF = 0.05  # two objects' velocities by SGP4 from how they move; 0.001 but for some that soon decay [km/s]
_AT_ONCE = 100  # looks at all objects held in memory
_SLOWEST = 8.0  # more than the speed in a descent [km/s]
_MINUTE = 60.0


def states_in_teme(one: KnownSet, t: np.ndarray) -> np.ndarray:
    """Return states (n, 6) of a set by SGP4 in TEME [km, km/s] at times (n,) [s], NaN where it fails.

    Velocities that may not lead from one position to the next are NaN, too.
    """
    states = np.hstack(propagate(one.satellite, (t - one.t) / _MINUTE))
    states[~(np.linalg.norm(states[:, :3], axis=1) > STEEP), 3:] = np.nan
    return states


Looks = tuple[np.ndarray, np.ndarray]
"""Times (n,) [s] of the closer looks at our object, and its states (n, 6) in TEME then [km, km/s]."""


def looks_at(path: Ephemeris, *, epoch: str) -> Looks:
    """Return the looks along a path; epoch: UTC text, the path's."""
    t = _looks(path.t[0], path.t[-1], LOOK, _CLOSER)
    vectors = np.einsum("nji,nkj->nki", teme_to_gcrf(epoch, t), path.at(t).reshape(-1, 2, 3))
    return t, 1e-3 * vectors.reshape(-1, 6)


def may_meet(looks: Looks, other: KnownSet, within: float) -> bool:
    """Return whether another object may come within a distance [m] of ours; True where SGP4 fails."""
    last = len(looks[0]) - 1
    near = _near(looks, other, np.arange(0, last + 1, _CLOSER), 0.5 * _CLOSER, within)
    closer = near[:, None] + np.arange(-_CLOSER // 2, _CLOSER // 2 + 1)
    closer = np.unique(np.clip(closer, 0, last)) if len(near) else near
    return bool(len(_near(looks, other, closer, 0.5, within)))


def _near(looks: Looks, other: KnownSet, rows: np.ndarray, reach: float, within: float) -> np.ndarray:
    """Return those rows of looks about which another object may be near.

    reach: of a look, in steps between the closer looks
    """
    t, states = looks
    if not len(rows):
        return rows
    relative = states_in_teme(other, t[rows]) - states[rows]
    return rows[may_be_near(relative, reach * (t[1] - t[0]), within)]


def near_pairs(
    orbits: Sequence[tuple[KnownSet, Span]], span: Span, within: float
) -> Iterator[tuple[float, float, np.ndarray]]:
    """Yield begin and end of parts of a span [s] and the pairs (n, 2) of orbits that may meet in each.

    orbits: with the time of which they are known
    within: largest distance [m]

    The parts follow each other without gaps; the first has no begin, the last no end.
    """
    looks = _looks(*span, LOOK_AT_ALL, 1)
    half = 0.5 * (looks[1] - looks[0])
    edges = [-np.inf, *(looks[:-1] + half).tolist(), np.inf]
    for first in range(0, len(looks), _AT_ONCE):
        t = looks[first : first + _AT_ONCE]
        known = [np.clip(t, *life) for _, life in orbits]
        states = np.array([states_in_teme(orbit, at) for (orbit, _), at in zip(orbits, known, strict=True)])
        early = np.abs(known - t)
        states[early > half] = np.nan
        states[early > 0.0, 3:] = np.nan
        for k in range(len(t)):
            yield edges[first + k], edges[first + k + 1], _pairs(states[:, k], half, within)


def may_be_near(relative: np.ndarray, half: float, within: float) -> np.ndarray:
    """Return whether (n,) objects may come within a distance [m] in half the time between looks [s].

    relative: (n, 6) states [km, km/s]; True where they are NaN
    """
    positions, velocities = relative[:, :3], relative[:, 3:]
    distances, speeds = (np.linalg.norm(vectors, axis=1) for vectors in (positions, velocities))
    approaching = -np.einsum("nk,nk->n", positions, velocities) / np.maximum(speeds, 1e-9) ** 2
    nearest = positions + np.clip(approaching, -half, half)[:, None] * velocities
    bent = _TIDE * half**2 * (distances + half * speeds) + _OFF * half
    return ~(np.linalg.norm(nearest, axis=1) > 1e-3 * within + bent)


def _pairs(states: np.ndarray, half: float, within: float) -> np.ndarray:
    """Return the pairs (n, 2) of states (m, 6) that may come near in half the time between looks.

    A state without velocity is that of an end of what is known, as far in time at most, or of a descent.
    """
    (known,) = np.isfinite(states[:, 0]).nonzero()
    if len(known) < 2:
        return np.empty((0, 2), int)
    speeds = np.linalg.norm(states[known, 3:], axis=1)
    fastest = 2.0 * float(np.max(speeds, where=np.isfinite(speeds), initial=_SLOWEST))
    most = (1e-3 * within + (fastest + _OFF) * half) * (1.0 + 2.0 * _TIDE * half**2)
    pairs = known[KDTree(states[known, :3]).query_pairs(most, output_type="ndarray")]
    relative = states[pairs[:, 1]] - states[pairs[:, 0]]
    return np.asarray(pairs[may_be_near(relative, half, within)])


def _looks(begin: float, end: float, longest: float, closer: int) -> np.ndarray:
    """Return times from a beginning to an end [s], `closer` steps of them at most `longest` long."""
    count = closer * max(1, int(np.ceil((end - begin) / longest)))
    return np.linspace(begin, end, count + 1)
