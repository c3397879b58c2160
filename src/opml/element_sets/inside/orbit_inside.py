"""The orbit inside a public element set: the numerical orbit that its publisher fitted SGP4 to.

Since about 2015 a public set is SGP4 fitted by least squares to an orbit under full forces, over a span of H
on both sides of its epoch. With r(t) that orbit, s(t) SGP4's positions and J(t) their partials with respect
to the elements of the set, the publisher's normal equations are

    sum over |t - t_set| <= H of  J(t)' W (r(t; x, b) - s(t)) = 0

SGP4's residuals s - r are half a kilometre, and none of it is left in these seven sums. So they are solved
for the orbit, its state x and its Cd A/m b, by Newton's method. An orbit and SGP4 have the same partials to a
thousandth, hence J serves for x, too. What drag and light do is differenced between two orbits under a
smooth field. One step from SGP4's own state leaves half a metre.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from sgp4.api import Satrec

from opml.base.constants import HOUR
from opml.base.errors import InputError
from opml.dynamics.ensemble import Arcs, Departures
from opml.element_sets.inside.inside_forces import Forces
from opml.interop.element_sets import mean_elements
from opml.interop.element_sets.burns_in_sets import KnownSet
from opml.interop.element_sets.element_set import decay, perturbed, semi_major_axis
from opml.orbits.elements import bent_rsw, positions_beside

EVERY = 1800.0
"""Time between points of a span [s]; orbits begin at the last one before an epoch."""

WEIGHTS = 1.0 / np.array([200.0, 500.0, 200.0])
"""Weights of residuals in RSW [1/m]: the size of what SGP4 cannot hold."""

ANY_DRAG = 0.05, 5.0
"""Standard deviation of Cd A/m about NO_DRAG: [m2/kg], or of its first value, whichever is larger.

It is no guess of the drag: it keeps a number finite that an orbit above 1000 km does not tell.
"""

NO_DRAG = 0.01  # [m2/kg]
LIGHT = 0.02  # Cr A/m of a payload [m2/kg]
NUMBERS = 8  # six elements, Cd A/m and Cr A/m
DRAG, SUNLIGHT = 6, 7  # places of the last two

_UNITS = np.array([1e-7, 1e-5, 1e-5, 1e-5, 1e-5, 1e-5])
"""Steps of the elements: mean motion [its own part], e cos w, e sin w, angles [rad]; some 70 m each."""

_BSTAR = 12.741621  # Cd A/m of a B* of 1/(6378.135 km), in SGP4's own density [m2/kg]
_LEAST_SOUGHT = 3e-3  # Cd A/m from which one is sought first [m2/kg]
_DRAG_STEP = 0.1, 1e-3  # step of Cd A/m: a part of it, and at least [m2/kg]
LIGHT_STEP = 0.005  # of Cr A/m [m2/kg]
LEAST_DRAG = 1e-4  # [m2/kg]


class NoOrbitError(InputError):
    """Sets that no orbit under full forces fits: it comes down within their span, or SGP4 fails in it."""


@dataclass(frozen=True, eq=False)
class Beginning:
    """Initial state of the search for the orbit inside a set.

    satellite: the set; t: the last multiple of EVERY before its epoch [s since that of the force model]
    state: (6,) GCRF then [m, m/s]
    ballistic, reflection: Cd A/m, Cr A/m [m2/kg]
    known: the date of the request: weather measured later does not count [s]
    """

    satellite: Satrec
    t: float
    state: np.ndarray
    ballistic: float
    reflection: float
    known: float

    @property
    def drag_step(self) -> float:
        """By how much Cd A/m is changed to see what it does [m2/kg]."""
        part, least = _DRAG_STEP
        return max(part * self.ballistic, least)


@dataclass(frozen=True, eq=False)
class NearbyOrbit:
    """An orbit under full forces near that of a set, and how it changes with its numbers.

    t: (n,) every EVERY [s]; states: (n, 6) GCRF [m, m/s]
    partials: (n, 3, 8) along the bent axes R, S, W [m], by steps of the numbers; those of Cr A/m are 0 where
    they were not needed
    """

    beginning: Beginning
    epoch: str
    t: np.ndarray
    states: np.ndarray
    partials: np.ndarray

    def displacements(self, satellite: Satrec) -> np.ndarray:
        """Return (n, 3) by what SGP4's positions of a set are off the orbit, along the bent axes [m]."""
        by_sgp4 = mean_elements.states(satellite, epoch=self.epoch, t=self.t)
        return bent_rsw(by_sgp4[:, :3], self.states)

    def positions(self, numbers: np.ndarray, rows: slice | np.ndarray = slice(None)) -> np.ndarray:
        """Return GCRF positions (m, 3) [m] of the orbit with its numbers changed (8,) by steps."""
        return positions_beside(self.states[rows], self.partials[rows] @ numbers)

    def ballistic(self, numbers: np.ndarray) -> float:
        """Return Cd A/m [m2/kg] of the orbit with its numbers changed (8,) by steps."""
        return float(self.beginning.ballistic + numbers[DRAG] * self.beginning.drag_step)

    def reflection(self, numbers: np.ndarray) -> float:
        """Return Cr A/m [m2/kg] of the orbit with its numbers changed (8,) by steps."""
        return float(self.beginning.reflection + numbers[SUNLIGHT] * LIGHT_STEP)

    def begin_again(self, numbers: np.ndarray) -> Beginning:
        """Return where the orbit begins with its numbers changed (8,) by steps."""
        old = self.beginning
        pair = [old.satellite, perturbed(old.satellite, _steps(old.satellite) * numbers[:DRAG])]
        before, after = (mean_elements.states(one, epoch=self.epoch, t=np.array([old.t]))[0] for one in pair)
        ballistic = max(self.ballistic(numbers), LEAST_DRAG)
        reflection = self.reflection(numbers)
        return Beginning(old.satellite, old.t, old.state + after - before, ballistic, reflection, old.known)

    def equations(self, satellite: Satrec) -> "Equations":
        """Return the normal equations of a set; points where SGP4 fails do not count."""
        displacements = self.displacements(satellite)
        there = np.isfinite(displacements).all(axis=1)
        weighted = np.where(there[:, None, None], self.partials * WEIGHTS[:, None], 0.0)
        residuals = np.where(there[:, None], displacements * WEIGHTS, 0.0)
        squares = np.einsum("nai,naj->nij", weighted, weighted)
        moments = np.einsum("nai,na->ni", weighted, residuals)
        return Equations(self.t, _sums(squares), _sums(moments), _sums(there))


@dataclass(frozen=True, eq=False)
class Equations:
    """Normal equations of a set over any span: sums over the points up to each."""

    t: np.ndarray
    squares: np.ndarray  # (n + 1, 8, 8)
    moments: np.ndarray  # (n + 1, 8)
    counts: np.ndarray  # (n + 1,)

    def over(self, begin: float, end: float) -> tuple[np.ndarray, np.ndarray]:
        """Return matrix (8, 8) and right side (8,) over a span [s], a set counting as one point."""
        first, last = np.searchsorted(self.t, [begin, end + 0.5])
        count, *sums = (part[last] - part[first] for part in (self.counts, self.squares, self.moments))
        square, moment = (part / max(count, 1) for part in sums)
        return square, moment


def solve(
    orbit: NearbyOrbit, equations: Sequence[tuple[np.ndarray, np.ndarray]], *, sunlight: float = 0.0
) -> np.ndarray:
    """Return the steps (8,) by which the numbers of an orbit change so that it solves equations of sets.

    sunlight: the step of Cr A/m, which one set hardly determines

    Raises NoOrbitError where there are no such steps.
    """
    matrix, moment = (np.sum(part, axis=0) for part in zip(*equations, strict=True))
    free = slice(SUNLIGHT)
    square, side = matrix[free, free].copy(), moment[free] - sunlight * matrix[free, SUNLIGHT]
    least, parts = ANY_DRAG
    begin = orbit.beginning
    sigma = max(least, parts * begin.ballistic) / begin.drag_step
    square[DRAG, DRAG] += sigma**-2
    side[DRAG] += (NO_DRAG - begin.ballistic) / begin.drag_step * sigma**-2
    try:
        steps = np.linalg.solve(square, side)
    except np.linalg.LinAlgError:
        steps = np.full(len(side), np.nan)
    if not np.isfinite(steps).all():
        raise NoOrbitError("no orbit under full forces fits its sets")
    return np.append(steps, sunlight)


def orbits_beside(
    forces: Forces,
    beginnings: Sequence[Beginning],
    *,
    back: np.ndarray,
    ahead: np.ndarray,
    is_lit: bool = False,
) -> list[NearbyOrbit]:
    """Propagate the orbits near sets, with their partials.

    back, ahead: (sets,) how far before and after the epoch of the set each orbit reaches [s]
    is_lit: whether those of Cr A/m are needed

    States are not finite where an orbit comes down.
    """
    starts = np.array([one.t for one in beginnings])
    first, last = (EVERY * np.round(end / EVERY) for end in (starts - back, starts + ahead))
    ends = np.stack([first, last])
    flown = paths(forces, beginnings, ends)
    changes = _changes(forces, beginnings, ends, is_lit=is_lit)
    orbits = []
    for begin, t0, states, by_drag_and_light in zip(beginnings, first, flown, changes, strict=True):
        t = t0 + EVERY * np.arange(len(states))
        partials = np.concatenate(
            [_sgp4_partials(begin.satellite, forces.epoch, t), by_drag_and_light], axis=2
        )
        orbits.append(NearbyOrbit(begin, forces.epoch, t, states, partials))
    return orbits


def paths(
    forces: Forces, beginnings: Sequence[Beginning], ends: np.ndarray, *, every: float = EVERY
) -> list[np.ndarray]:
    """Return the states (n, 6) [m, m/s] of orbits at even times.

    ends: (2, orbits) first and last times [s], multiples of `every`, which divides EVERY
    """
    back, ahead = forces.run(
        [
            partial(_half, forces, beginnings, end, direction * every)
            for end, direction in zip(ends, (-1.0, 1.0), strict=True)
        ]
    )
    return [
        np.concatenate([back.path(k)[::-1], begin.state[None], ahead.path(k)])
        for k, begin in enumerate(beginnings)
    ]


def _half(forces: Forces, beginnings: Sequence[Beginning], ends: np.ndarray, step: float) -> Arcs:
    """Return arcs in one direction of time, in steps above or below 0 [s]."""
    starts = np.array([one.t for one in beginnings])
    direction, every = np.sign(step), abs(step)
    epochs = np.arange((direction * starts).min(), (direction * ends).max() + 0.5 * every, every)
    departures = departing(
        beginnings,
        forces,
        first=np.searchsorted(epochs, direction * starts),
        last=np.searchsorted(epochs, direction * ends),
    )
    return forces.propagate(direction * epochs, departures)


def _changes(
    forces: Forces, beginnings: Sequence[Beginning], ends: np.ndarray, *, is_lit: bool
) -> list[np.ndarray]:
    """Return what steps of Cd A/m and Cr A/m do to orbits (n, 3, 2), along the bent axes [m].

    Both are small: a smooth field, which is quick, changes them little. Those of Cr A/m are 0 unless they are
    needed.
    """
    dragged = [replace(one, ballistic=one.ballistic + one.drag_step) for one in beginnings]
    lit = [replace(one, reflection=one.reflection + LIGHT_STEP) for one in beginnings] if is_lit else []
    families = [*beginnings, *dragged, *lit]
    repeated = np.tile(ends, len(families) // len(beginnings))
    flown = paths(forces.smoothed, families, repeated)
    count = len(beginnings)
    changes = []
    for k, own in enumerate(flown[:count]):
        beside = np.zeros((len(own), 3, 2))
        for place, other in enumerate(flown[count + k :: count]):
            beside[..., place] = bent_rsw(other[:, :3], own)
        changes.append(beside)
    return changes


def _sgp4_partials(satellite: Satrec, epoch: str, t: np.ndarray) -> np.ndarray:
    """Return what steps of the elements do to SGP4's positions (n, 3, 6), along the bent axes [m]."""
    moved = [perturbed(satellite, change) for change in np.diag(_steps(satellite))]
    own, *others = mean_elements.states_in_teme([satellite, *moved], epoch=epoch, t=t)
    return np.stack([bent_rsw(states[:, :3], own) for states in others], axis=2)


def _steps(satellite: Satrec) -> np.ndarray:
    return _UNITS * [satellite.no_kozai, 1.0, 1.0, 1.0, 1.0, 1.0]


def size_change(satellite: Satrec, steps: np.ndarray) -> np.ndarray:
    """Return by how much the semi-major axis changes with steps of the mean motion (n,) [m]."""
    return -2.0 / 3.0 * semi_major_axis(satellite.no_kozai) * _UNITS[0] * steps


def _sums(values: np.ndarray) -> np.ndarray:
    return np.concatenate([np.zeros((1, *values.shape[1:])), np.cumsum(values, axis=0)])


def first_drag(bstar: np.ndarray | float) -> np.ndarray:
    """Return Cd A/m [m2/kg] from which that of sets is sought first, of their B* [1/(6378.135 km)]."""
    return np.maximum(_BSTAR * np.abs(bstar), _LEAST_SOUGHT)


def begin_at(one: KnownSet, epoch: str, ballistic: float, reflection: float = LIGHT) -> Beginning:
    """Return where the orbit of a set is sought first: SGP4's own state; times of the set since `epoch`."""
    t = EVERY * float(np.floor(one.t / EVERY))
    state = mean_elements.states(one.satellite, epoch=epoch, t=np.array([t]))[0]
    return Beginning(one.satellite, t, state, ballistic, reflection, one.made)


def departing(
    begins: Sequence[Beginning], forces: Forces, *, first: np.ndarray, last: np.ndarray
) -> Departures:
    """Return departures of orbits under the weather as it was known; first, last: as of `Departures`."""
    return Departures(
        np.array([one.state for one in begins]),
        first=first,
        last=last,
        ballistic=np.array([one.ballistic for one in begins]),
        reflection=np.array([one.reflection for one in begins]),
        outlook=forces.model.newest_outlook(np.array([one.known for one in begins])),
    )


HALF_SPANS = ((3.0, 168.0), (22.0, 120.0), (50.0, 72.0), (130.0, 60.0), (300.0, 48.0), (np.inf, 36.0))
"""Half of the span of sets [h] by the largest decay for it [m/d]: of 64 objects of 2018, 2024 and 2026."""


def usual_half_span(satellite: Satrec) -> float:
    """Return half of the span that a set was fitted over [s], by how fast its drag lets the orbit sink."""
    sinking = decay(satellite)
    return HOUR * next(hours for most, hours in HALF_SPANS if sinking <= most)
