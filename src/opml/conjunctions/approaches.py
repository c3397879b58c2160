"""Close approaches of objects whose states are known every minute or so: when, how near, how fast.

Of two objects on orbits that come near each other by height, the distance is looked at on common times. It
has a minimum between two of them where the objects approach at the first and part at the second. Pairs that
could not come near enough in between are passed over. The minimum is then refined on the polynomials of
Hermite through four states of either object (CCSDS 502.0-B-2, 5.2.3.5), to which an OEM is written.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.interpolate import CubicHermiteSpline, KroghInterpolator
from scipy.optimize import brentq

from opml.base.errors import InputError

STEP = 60.0
"""Time between two looks at the distance [s]."""

LONGEST_STEP = 300.0
"""Longest time between two states of a path [s]: beyond, the polynomials through them err by metres."""

_FASTEST = 16e3  # relative speed of two objects near the Earth [m/s]
_POLYNOMIAL_MISS = 1e3  # of the cubics between states that are LONGEST_STEP apart [m]
_NEAREST, _FARTHEST = 6e6, 1e9  # from the Earth's centre [m]
_ROUGH = 0.1  # of a way that the mean velocity of its ends may be off
_NODES = 4
_TIME_TOLERANCE = 1e-6


@dataclass(frozen=True, eq=False)
class Path:
    """States of an object, a minute or so apart.

    t: (n,) ascending [s]
    states: (n, 6) GCRF [m, m/s]
    """

    name: str
    t: np.ndarray
    states: np.ndarray

    def __post_init__(self) -> None:
        """Raise InputError for fewer than four states, ones too far apart, and ones that make no orbit."""
        if len(self.t) < _NODES:
            raise InputError(f"{self.name}: expected at least {_NODES} states, got {len(self.t)}")
        if not (longest := float(np.diff(self.t).max())) <= LONGEST_STEP:
            raise InputError(
                f"{self.name}: expected states at most {LONGEST_STEP:g} s apart, got {longest:g}"
            )

        low, high = self.heights
        if not _NEAREST <= low <= high <= _FARTHEST:
            raise InputError(
                f"{self.name}: expected positions {_NEAREST / 1e3:g} to {_FARTHEST / 1e3:g} km from the "
                f"Earth's centre, got {low / 1e3:g} to {high / 1e3:g}"
            )
        steps, velocities = np.diff(self.t)[:, None], self.states[:, 3:]
        moved, flown = np.diff(self.states[:, :3], axis=0), 0.5 * steps * (velocities[1:] + velocities[:-1])
        off = np.linalg.norm(moved - flown, axis=1) - _ROUGH * np.linalg.norm(moved, axis=1)
        worst = int(np.argmax(off))
        if off[worst] > _POLYNOMIAL_MISS:
            raise InputError(
                f"{self.name}: expected velocities that lead from position to position, got others at state "
                f"{worst + 1} or {worst + 2}"
            )

    @cached_property
    def heights(self) -> tuple[float, float]:
        """Least and largest distance from the Earth's centre [m]."""
        distance = np.linalg.norm(self.states[:, :3], axis=1)
        return float(distance.min()), float(distance.max())

    @cached_property
    def _cubics(self) -> CubicHermiteSpline:
        return CubicHermiteSpline(self.t, self.states[:, :3], self.states[:, 3:], extrapolate=False)

    def coarse(self, t: np.ndarray) -> np.ndarray:
        """Return states (n, 6) at times (n,) [s] by cubics, not finite beyond the ends."""
        return np.hstack([self._cubics(t), self._cubics(t, 1)])

    def at(self, t: float) -> np.ndarray:
        """Return the state (6,) at a time [s] by the polynomial through the four states about it."""
        begin = int(np.searchsorted(self.t, t)) - _NODES // 2
        begin = min(max(begin, 0), len(self.t) - _NODES)
        nodes = slice(begin, begin + _NODES)
        middle = self.t[begin + 1]
        positions, velocities = self.states[nodes, :3], self.states[nodes, 3:]
        curve = KroghInterpolator(
            np.repeat(self.t[nodes] - middle, 2), np.stack([positions, velocities], axis=1).reshape(-1, 3)
        )
        state: np.ndarray = curve.derivatives(t - middle, der=2).ravel()
        return state


@dataclass(frozen=True)
class Approach:
    """A minimum of the distance of two objects.

    first, second: numbers of their paths
    t: when [s]
    distance: [m]
    """

    first: int
    second: int
    t: float
    distance: float


def find(paths: Sequence[Path], *, within: float, first_alone: bool = False) -> list[Approach]:
    """Return the approaches of all pairs of paths, in the order of time.

    within: largest distance [m]
    first_alone: pairs with the first path only

    A minimum at an end of the time that two paths share is none of theirs.
    """
    times = _looks(paths, paths[:1] if first_alone else paths)
    states = np.stack([path.coarse(times) for path in paths])
    found = [
        approach
        for first in range(1 if first_alone else len(paths) - 1)
        for second, k in _candidates(paths, times, states, first, within)
        if (approach := _refined(paths, first, second, (times[k], times[k + 1]), within))
    ]
    return sorted(found, key=lambda approach: (approach.t, approach.first, approach.second))


def _looks(paths: Sequence[Path], wanted: Sequence[Path]) -> np.ndarray:
    """Return the times [s] at which distances are looked at: whole minutes, and the ends of all paths.

    wanted: paths whose span counts
    """
    ends = np.array([[path.t[0], path.t[-1]] for path in paths])
    begin, end = min(path.t[0] for path in wanted), max(path.t[-1] for path in wanted)
    minutes = STEP * np.arange(math.ceil(begin / STEP), math.floor(end / STEP) + 1)
    return np.union1d(minutes, ends[(ends >= begin) & (ends <= end)])


def _candidates(
    paths: Sequence[Path], times: np.ndarray, states: np.ndarray, first: int, within: float
) -> Iterator[tuple[int, int]]:
    """Yield (second path, number of the time before a minimum) for minima that may be near enough.

    times: (n,) [s]
    states: (paths, n, 6)
    """
    low, high = paths[first].heights
    margin = within + _POLYNOMIAL_MISS
    others = [
        second
        for second in range(first + 1, len(paths))
        if paths[second].heights[0] <= high + margin and paths[second].heights[1] >= low - margin
    ]
    reach = margin + _FASTEST * STEP
    for second in others:
        apart = states[second, :, :3] - states[first, :, :3]
        near = np.flatnonzero(np.einsum("nk,nk->n", apart, apart) < reach**2)
        wanted = np.union1d(near, near + 1)
        wanted = wanted[wanted < len(apart)]
        relative = states[second, wanted] - states[first, wanted]
        parting = np.einsum("nk,nk->n", relative[:, :3], relative[:, 3:])
        turns = (parting[:-1] < 0.0) & (parting[1:] >= 0.0) & (np.diff(wanted) == 1)
        for k in np.flatnonzero(turns):
            look = int(wanted[k])
            if _least(relative[k], relative[k + 1], times[look + 1] - times[look]) <= margin:
                yield second, look


def _least(before: np.ndarray, after: np.ndarray, step: float) -> float:
    """Return a bound from below on the distance [m] between two relative states (6,) a step [s] apart.

    The relative path is a straight line from either state but for what gravity bends it in a step.
    """
    distances = []
    for state, sign in ((before, 1.0), (after, -1.0)):
        position, velocity = state[:3], sign * state[3:]
        along = -float(position @ velocity) / max(float(velocity @ velocity), 1e-12)
        nearest = position + min(max(along, 0.0), step) * velocity
        distances.append(float(np.linalg.norm(nearest)))
    bent = float(np.linalg.norm(before[:3] + step * before[3:] - after[:3]))
    return min(distances) - bent


def _refined(
    paths: Sequence[Path], first: int, second: int, step: tuple[float, float], within: float
) -> Approach | None:
    """Return the minimum between two times [s], None where it is too far or beyond them."""
    one, other = paths[first], paths[second]

    def parting(t: float) -> float:
        relative = other.at(t) - one.at(t)
        return float(relative[:3] @ relative[3:])

    # Cubics and the finer polynomials may disagree on the side of a time that a minimum is on.
    begin = max(step[0] - 1e-2, one.t[0], other.t[0])
    end = min(step[1] + 1e-2, one.t[-1], other.t[-1])
    if parting(begin) > 0.0 or parting(end) < 0.0:
        return None
    t = float(brentq(parting, begin, end, xtol=_TIME_TOLERANCE))
    distance = float(np.linalg.norm((other.at(t) - one.at(t))[:3]))
    return Approach(first, second, t, distance) if distance <= within else None
