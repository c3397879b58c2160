"""Interpolation of an orbit between its nodes by polynomials that obey the Earth's gravity.

A polynomial in time alone cannot follow an orbit between nodes of some minutes, as the harmonics of the field
change faster. So each interval has its own polynomial through the positions at both ends. Its second
derivative equals the acceleration of gravity at as many times as it has free coefficients (collocation).
Other forces are small and smooth: they show in the velocities at the nodes, which a cubic adds.

Source: Bai & Junkins 2011, Modified Chebyshev-Picard iteration methods for solution of boundary value
problems, Journal of the Astronautical Sciences 58.
"""

import math
from dataclasses import dataclass
from functools import cache
from typing import Self

import numpy as np
from numpy.polynomial import chebyshev

from opml.dynamics.attraction import Attraction

_CONVERGED = 1e-6
"""Largest change of a position [m] in the last iteration; each iteration divides the change by 9 or more."""

_MOST_ITERATIONS = 25
_BLOCK = 4096  # intervals solved at once, a limit on memory

# Chebyshev coefficients of the cubics that are 0 at both ends, with slope 1 at the first or at the last end.
_FIRST_SLOPE = np.array([2.0, -1.0, -2.0, 1.0]) / 16.0
_LAST_SLOPE = np.array([-2.0, -1.0, 2.0, 1.0]) / 16.0


@dataclass(frozen=True)
class Bridges:
    """Polynomials between the nodes of an orbit.

    coefficients: (n - 1, degree + 1, 3) Chebyshev's, of positions in GCRF [m], from -1 at a node to 1 at the
        next one; not finite where an interval is not bridged
    """

    t: np.ndarray  # (n,) times of the nodes [s]
    coefficients: np.ndarray

    @property
    def bridged(self) -> np.ndarray:
        """Whether each interval (n - 1,) has a polynomial."""
        return np.asarray(np.isfinite(self.coefficients[:, 0, 0]))

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
        """Jumps (n, 3) of the velocity at the nodes [m/s], 0 where not both sides are bridged."""
        jumps = np.zeros((len(self.t), 3))
        jumps[1:-1] = np.nan_to_num(self.departures[1:] - self.arrivals[:-1])
        return jumps

    def drop(self, broken: np.ndarray) -> Self:
        """Return the polynomials without those of the intervals `broken` (n - 1,)."""
        return type(self)(self.t, np.where(broken[:, None, None], np.nan, self.coefficients))

    def mean_velocities(self) -> np.ndarray:
        """Return the velocities (n, 3) [m/s] at the nodes, from both sides or from the bridged one.

        A constant force besides gravity separates the velocities of the two sides, in proportion to the
        lengths of the two intervals. Where one side alone is bridged, the shift of the next node is used.
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
        return np.asarray(np.where(np.isfinite(arrivals) & np.isfinite(departures), between, one_side))

    def match_velocities(self, velocities: np.ndarray, free: np.ndarray) -> Self:
        """Return polynomials with given velocities at the nodes.

        velocities: (n, 3) [m/s]
        free: (n,) nodes whose velocities stay as they are
        """
        first = np.where(free[:-1, None], 0.0, velocities[:-1] - self.departures)
        last = np.where(free[1:, None], 0.0, velocities[1:] - self.arrivals)
        half = np.diff(self.t)[:, None, None] / 2.0
        coefficients = self.coefficients.copy()
        coefficients[:, :4] += half * (
            _FIRST_SLOPE[:, None] * first[:, None] + _LAST_SLOPE[:, None] * last[:, None]
        )
        return type(self)(self.t, coefficients)

    def states(self, times: np.ndarray) -> np.ndarray:
        """Return the states (m, 6) [m, m/s] in GCRF at times (m,) [s], not finite without a bridge."""
        interval = np.clip(np.searchsorted(self.t, times, side="right") - 1, 0, len(self.t) - 2)
        start, width = self.t[interval], np.diff(self.t)[interval]
        x = (2.0 * (times - start) / width - 1.0)[:, None]
        coefficients = self.coefficients[interval].transpose(1, 0, 2)
        position = chebyshev.chebval(x, coefficients, tensor=False)
        velocity = chebyshev.chebval(x, chebyshev.chebder(coefficients), tensor=False)
        states = np.concatenate([position, velocity * (2.0 / width)[:, None]], axis=1)
        states[(times < self.t[0]) | (times > self.t[-1])] = np.nan
        return states

    def _end_velocities(self, end: float) -> np.ndarray:
        degree = np.arange(self.coefficients.shape[1])
        slopes = degree**2 * end ** (degree + 1)
        velocities: np.ndarray = np.einsum("k,nkc->nc", slopes, self.coefficients)
        return velocities * (2.0 / np.diff(self.t))[:, None]


def bridge(t: np.ndarray, positions: np.ndarray, attraction: Attraction, *, wanted: np.ndarray) -> Bridges:
    """Return the polynomials of the intervals between nodes.

    t: (n,) times of the nodes [s], ascending
    positions: (n, 3) in GCRF [m]
    wanted: (n - 1,) intervals to bridge

    An interval whose ends are too distant for any orbit is left open.
    """
    index = np.flatnonzero(wanted)
    width = np.diff(t)
    points = min(16, 5 + math.ceil(width[index].max(initial=0.0) / 40.0))  # an ISS errs by 1 mm over 600 s
    coefficients = np.full((len(width), points + 2, 3), np.nan)
    for start in range(0, len(index), _BLOCK):
        part = index[start : start + _BLOCK]
        ends = positions[part], positions[part + 1]
        coefficients[part] = _solve(t[part], width[part], ends, attraction, points)
    return Bridges(t, coefficients)


def _solve(
    t: np.ndarray, width: np.ndarray, ends: tuple[np.ndarray, np.ndarray], attraction: Attraction, points: int
) -> np.ndarray:
    """Return the coefficients (n, points + 2, 3) of intervals, by Picard iteration.

    t: (n,) beginnings of the intervals [s]
    width: (n,) [s]
    ends: positions (n, 3) at the beginnings and at the ends, GCRF [m]
    """
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
        if not np.any(change > _CONVERGED):
            break
    coefficients[~(change <= _CONVERGED)] = np.nan
    return coefficients


@cache
def _collocation(points: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the times of collocation (p,) between -1 and 1, and two matrices.

    The first, (p, p + 2), maps Chebyshev coefficients to positions at these times. The second, (p + 2, p),
    maps accelerations at these times to the coefficients of the fall that is 0 at both ends.
    """
    abscissae = chebyshev.chebpts1(points)
    falls = chebyshev.chebint(np.linalg.inv(chebyshev.chebvander(abscissae, points - 1)), 2)
    start, end = chebyshev.chebval(-1.0, falls), chebyshev.chebval(1.0, falls)
    falls[0] -= (end + start) / 2.0
    falls[1] -= (end - start) / 2.0
    return abscissae, chebyshev.chebvander(abscissae, points + 1), falls
