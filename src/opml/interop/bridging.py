"""The orbit between its nodes: in each interval the polynomial that falls as the Earth's gravity says.

A polynomial in time cannot follow an orbit from nodes minutes apart, as harmonics of the field change faster
than that. So each interval has a polynomial of its own, through the positions at both of its ends, whose
second derivative is the acceleration of gravity at as many times as it has freedom left (collocation). What
else pulls is small and smooth: the velocities at the nodes tell of it, and a cubic takes them in.

Source: Bai & Junkins 2011, Modified Chebyshev-Picard iteration methods for solution of boundary value
problems, Journal of the Astronautical Sciences 58.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from typing import Self

import numpy as np
from numpy.polynomial import chebyshev

from opml.dynamics.attraction import Attraction

CONVERGED = 1e-6
"""Largest change of a position [m] in the last iteration; gravity shrinks it 9-fold or more in each one."""

_MOST_ITERATIONS = 25
_BLOCK = 4096  # intervals solved at once, for the sake of memory

# Chebyshev coefficients of the cubics that vanish at both ends with slope 1 at the first, or the last.
_FIRST_SLOPE = np.array([2.0, -1.0, -2.0, 1.0]) / 16.0
_LAST_SLOPE = np.array([-2.0, -1.0, 2.0, 1.0]) / 16.0


@dataclass(frozen=True)
class Bridges:
    """Polynomials from node to node.

    t (n,): times of the nodes [s]; coefficients (n - 1, degree + 1, 3): Chebyshev's, of positions in GCRF [m]
    from -1 at a node to 1 at the next, not finite where an interval is not bridged.
    """

    t: np.ndarray
    coefficients: np.ndarray

    @property
    def bridged(self) -> np.ndarray:
        """Which intervals (n - 1,) have a polynomial."""
        found: np.ndarray = np.isfinite(self.coefficients[:, 0, 0])
        return found

    @property
    def departures(self) -> np.ndarray:
        """Velocities (n - 1, 3) [m/s] at the first node of each interval."""
        return self._end_velocities(-1.0)

    @property
    def arrivals(self) -> np.ndarray:
        """Velocities (n - 1, 3) [m/s] at the last node of each interval."""
        return self._end_velocities(1.0)

    @property
    def jumps(self) -> np.ndarray:
        """Steps (n, 3) of the velocity at the nodes [m/s], 0 where it is known on one side at most."""
        jumps = np.zeros((len(self.t), 3))
        jumps[1:-1] = np.nan_to_num(self.departures[1:] - self.arrivals[:-1])
        return jumps

    def without(self, broken: np.ndarray) -> Self:
        """Return the polynomials but those of some intervals (n - 1,)."""
        return type(self)(self.t, np.where(broken[:, None, None], np.nan, self.coefficients))

    def mean_velocities(self) -> np.ndarray:
        """Velocities (n, 3) [m/s] at the nodes, from those on both sides or on the one that is bridged.

        What pulls beside gravity, if it is constant, moves the two to either side by as much as the interval
        there is long. On one side alone it is taken to be what it is at the next node.
        """
        width, none = np.diff(self.t), np.full((1, 3), np.nan)
        before, after = np.append(width[:1], width), np.append(width, width[-1:])
        share = (before / (before + after))[:, None]
        earlier, later = share * self.jumps, (1.0 - share) * self.jumps
        departures, arrivals = np.vstack([self.departures, none]), np.vstack([none, self.arrivals])
        between = departures - earlier
        from_first = departures - np.vstack([earlier[1:], none])
        to_last = arrivals + np.vstack([none, later[:-1]])
        one_side = np.where(np.isfinite(from_first), from_first, to_last)
        mean: np.ndarray = np.where(np.isfinite(arrivals) & np.isfinite(departures), between, one_side)
        return mean

    def through(self, velocities: np.ndarray, free: np.ndarray) -> Self:
        """Return polynomials that have velocities (n, 3) [m/s] at the nodes, but for those `free` (n,)."""
        first = np.where(free[:-1, None], 0.0, velocities[:-1] - self.departures)
        last = np.where(free[1:, None], 0.0, velocities[1:] - self.arrivals)
        half = np.diff(self.t)[:, None, None] / 2.0
        coefficients = self.coefficients.copy()
        coefficients[:, :4] += half * (
            _FIRST_SLOPE[:, None] * first[:, None] + _LAST_SLOPE[:, None] * last[:, None]
        )
        return type(self)(self.t, coefficients)

    def states(self, at: np.ndarray) -> np.ndarray:
        """States (m, 6) [m, m/s] in GCRF at times `at` (m,) [s], not finite where there is no bridge."""
        interval = np.clip(np.searchsorted(self.t, at, side="right") - 1, 0, len(self.t) - 2)
        start, width = self.t[interval], np.diff(self.t)[interval]
        x = (2.0 * (at - start) / width - 1.0)[:, None]
        coefficients = self.coefficients[interval].transpose(1, 0, 2)
        position = chebyshev.chebval(x, coefficients, tensor=False)
        velocity = chebyshev.chebval(x, chebyshev.chebder(coefficients), tensor=False)
        states = np.concatenate([position, velocity * (2.0 / width)[:, None]], axis=1)
        states[(at < self.t[0]) | (at > self.t[-1])] = np.nan
        return states

    def _end_velocities(self, end: float) -> np.ndarray:
        degree = np.arange(self.coefficients.shape[1])
        slopes = degree**2 * end ** (degree + 1)
        velocities: np.ndarray = np.einsum("k,nkc->nc", slopes, self.coefficients)
        return velocities * (2.0 / np.diff(self.t))[:, None]


def bridge(t: np.ndarray, positions: np.ndarray, attraction: Attraction, *, wanted: np.ndarray) -> Bridges:
    """Bridge the intervals `wanted` (n - 1,) between nodes: t (n,) [s], ascending, positions (n, 3) GCRF [m].

    An interval that no orbit bridges, as its ends are too far from each other, is left open.
    """
    index = np.flatnonzero(wanted)
    width = np.diff(t)
    points = _points(width[index].max(initial=0.0))
    coefficients = np.full((len(width), points + 2, 3), np.nan)
    for part in _parts(index):
        ends = positions[part], positions[part + 1]
        coefficients[part] = _solved(t[part], width[part], ends, attraction, points)
    return Bridges(t, coefficients)


def _parts(index: np.ndarray) -> Iterator[np.ndarray]:
    for start in range(0, len(index), _BLOCK):
        yield index[start : start + _BLOCK]


def _points(width: float) -> int:
    """How many points an interval of some width [s] needs: with these, 1 mm of 600 s at an ISS is lost."""
    return min(16, 5 + math.ceil(width / 40.0))


def _solved(
    t: np.ndarray, width: np.ndarray, ends: tuple[np.ndarray, np.ndarray], attraction: Attraction, points: int
) -> np.ndarray:
    """Coefficients (n, points + 2, 3) of intervals that begin at t (n,) [s], between two ends (n, 3) [m]."""
    abscissae, values, falls = _collocation(points)
    times = t[:, None] + width[:, None] * (abscissae + 1.0) / 2.0
    rotation = attraction.rotation(times.ravel())
    chord = np.zeros((len(t), points + 2, 3))
    chord[:, 0], chord[:, 1] = (ends[1] + ends[0]) / 2.0, (ends[1] - ends[0]) / 2.0
    scale = (width / 2.0)[:, None, None] ** 2
    coefficients, places = chord, values @ chord
    for _ in range(_MOST_ITERATIONS):
        pull = attraction.acceleration(places.reshape(-1, 3), rotation).reshape(places.shape)
        coefficients = chord + scale * (falls @ pull)
        before, places = places, values @ coefficients
        change = np.abs(places - before).max(axis=(1, 2))
        if not np.any(change > CONVERGED):
            break
    coefficients[~(change <= CONVERGED)] = np.nan
    return coefficients


@cache
def _collocation(points: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Times (p,) between -1 and 1, and matrices that hold for accelerations at them.

    The first (p, p + 2) gives positions at these times from Chebyshev coefficients; the second (p + 2, p)
    gives the coefficients of the fall that begins and ends at 0 from the accelerations.
    """
    abscissae = chebyshev.chebpts1(points)
    falls = chebyshev.chebint(np.linalg.inv(chebyshev.chebvander(abscissae, points - 1)), 2)
    start, end = chebyshev.chebval(-1.0, falls), chebyshev.chebval(1.0, falls)
    falls[0] -= (end + start) / 2.0
    falls[1] -= (end - start) / 2.0
    return abscissae, chebyshev.chebvander(abscissae, points + 1), falls
