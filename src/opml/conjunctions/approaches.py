"""Close approaches of two objects whose states are known every minute or so: when, and how near.

Between its states a path is the polynomial of Hermite through the four about a time (CCSDS 502.0-B-2,
5.2.3.5), to which an OEM is written. The distance of two paths is looked at every minute of the time that
they share. It has a minimum between two looks where the objects approach at the first and part at the second:
near each other they move almost straight in a minute, or so slowly that the distance hardly changes. The
minimum is refined on the same polynomials. Where the time that they share begins while they part, or ends
while they approach, they are closest at that end.
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.interpolate import make_interp_spline

from opml.base.constants import EARTH_GM
from opml.base.errors import InputError
from opml.interop import ccsds
from opml.orbits.state_polynomials import FEWEST, StatePolynomials

EPOCH = "2000-01-01T12:00:00"  # UTC text from which times of files count [s], to a microsecond
STEP = 60.0  # time between two looks at the distance [s]

LONGEST_STEP = 300.0
"""Longest time between two states of a path [s]: beyond, the polynomials through them err by metres."""

_FASTEST = 25e3  # relative speed of two objects bound to the Earth, head on at its surface [m/s]
_VELOCITY_MISS = 1e3  # of a way by the states at its ends [m]
_STRAYING = 300.0  # the same of a single one [m]: a burn of 10 m/s within a minute
_TIMES_USUAL = 10.0  # least ratio to the usual miss of a single one that is wrong
_NEAREST, _FARTHEST = 6e6, 1e9  # from the Earth's centre [m]
_CLOCK = 1e-5  # to which times are known [s]
_ROUGH = 0.1  # of a way that the states at its ends may be off
_SMOOTH = 1e-3  # the same of a single one: twenty times what SGP4 is off
_DEGREE = 7  # of the polynomials that give velocities to positions
_HALVINGS = 36  # of a look's step, to a nanosecond


def velocities_of(t: np.ndarray, positions: np.ndarray) -> np.ndarray:
    """Return velocities (n, 3) [m/s] that lead from position to position (n, 3) [m] at times (n,) [s]."""
    curve = make_interp_spline(t - t[0], positions, k=min(_DEGREE, len(t) - 1 - len(t) % 2))
    return np.asarray(curve.derivative()(t - t[0]))


def with_velocities(t: np.ndarray, states: np.ndarray) -> np.ndarray:
    """Return states (n, 6) at times (n,) [s], with the velocities to their positions where any is unknown."""
    if np.isfinite(states).all() or len(t) < FEWEST:
        return states
    return np.hstack([states[:, :3], velocities_of(t, states[:, :3])])


@dataclass(frozen=True, eq=False)
class Path:
    """States of an object, a minute or so apart."""

    name: str
    t: np.ndarray  # (n,) ascending [s]
    states: np.ndarray  # (n, 6) GCRF [m, m/s]

    def __post_init__(self) -> None:
        """Raise InputError for fewer than four states, ones too far apart, and ones that make no orbit."""
        if len(self.t) < FEWEST:
            raise InputError(f"{self.name}: expected at least {FEWEST} states, got {len(self.t)}")
        if not (longest := float(np.diff(self.t).max())) <= LONGEST_STEP + _CLOCK:
            raise InputError(
                f"{self.name}: expected states at most {LONGEST_STEP:g} s apart, got {longest:g}"
            )

        distance = np.linalg.norm(self.states[:, :3], axis=1)
        low, high = float(distance.min()), float(distance.max())
        if not _NEAREST <= low <= high <= _FARTHEST:
            raise InputError(
                f"{self.name}: expected positions {_NEAREST / 1e3:g} to {_FARTHEST / 1e3:g} km from the "
                f"Earth's centre, got {low / 1e3:g} to {high / 1e3:g}"
            )
        off, ways = self._misses()
        strays = (off > _STRAYING + _SMOOTH * ways) & (off > _TIMES_USUAL * np.median(off))
        # A state that is wrong is off what is before and after it, a burn is in one way alone.
        spikes = np.flatnonzero(strays[1:] & strays[:-1]) + 1
        wrong = np.append(spikes, np.flatnonzero(off > _VELOCITY_MISS + _ROUGH * ways))
        if len(wrong):
            worst = wrong[0]
            raise InputError(
                f"{self.name}: expected velocities that lead from position to position, got "
                f"{off[worst] / 1e3:.3g} km off at {ccsds.utc_texts(EPOCH, self.t[worst : worst + 1])[0]}"
            )

    def _misses(self) -> tuple[np.ndarray, np.ndarray]:
        """Return how far velocities lead past each next position, and the ways to them (n - 1,) [m].

        The Earth's attraction at both ends bends the way: what is left is that of other forces.
        """
        positions, velocities = self.states[:, :3], self.states[:, 3:]
        pull = -EARTH_GM * positions / np.linalg.norm(positions, axis=1)[:, None] ** 3
        steps, moved = np.diff(self.t)[:, None], np.diff(positions, axis=0)
        led = 0.5 * steps * (velocities[1:] + velocities[:-1]) - steps**2 / 12.0 * np.diff(pull, axis=0)
        return np.linalg.norm(moved - led, axis=1), np.linalg.norm(moved, axis=1)

    @cached_property
    def heights(self) -> tuple[float, float]:
        """Bounds of the distance from the Earth's centre [m], between the states as well.

        On an orbit about the Earth that distance is accelerated by at most the Earth's attraction.
        """
        distance = np.linalg.norm(self.states[:, :3], axis=1)
        sag = EARTH_GM / _NEAREST**2 * float(np.diff(self.t).max()) ** 2 / 8.0
        return float(distance.min()) - sag, float(distance.max()) + sag

    def at(self, t: np.ndarray) -> np.ndarray:
        """Return states (n, 6) at times (n,) [s] by the polynomials through the four states about each."""
        return self._polynomials.at(t)

    @cached_property
    def _polynomials(self) -> StatePolynomials:
        return StatePolynomials(self.t, self.states)


@dataclass(frozen=True)
class Approach:
    """A minimum of the distance of two paths."""

    t: float  # when [s]
    distance: float  # [m]
    is_end: bool = False  # whether the time that both share begins or ends there; they may come nearer beyond


def shared(one: Path, other: Path) -> tuple[float, float]:
    """Return when the time that two paths share begins and ends [s]; it is none where it ends first."""
    return float(max(one.t[0], other.t[0])), float(min(one.t[-1], other.t[-1]))


def find(one: Path, other: Path, *, within: float) -> list[Approach]:
    """Return the approaches of two paths, in the order of time.

    within: largest distance [m]
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
    found = [Approach(*pair) for pair in zip(t.tolist(), refined.tolist(), strict=True)]
    if partings[0] >= 0.0:
        found.insert(0, Approach(begin, float(distances[0]), is_end=True))
    if partings[-1] < 0.0:
        found.append(Approach(end, float(distances[-1]), is_end=True))
    return [approach for approach in found if approach.distance <= within]


def _apart(one: Path, other: Path, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return distances (n,) [m] at times (n,) [s], and how fast their halved squares grow [m2/s]."""
    relative = other.at(t) - one.at(t)
    return np.linalg.norm(relative[:, :3], axis=1), np.einsum("nk,nk->n", relative[:, :3], relative[:, 3:])


def _turned(one: Path, other: Path, before: np.ndarray, after: np.ndarray) -> np.ndarray:
    """Return when (n,) the objects turn from approaching to parting between times (n,) [s]."""
    for _ in range(_HALVINGS):
        middle = 0.5 * (before + after)
        is_before = _apart(one, other, middle)[1] < 0.0
        before, after = np.where(is_before, middle, before), np.where(is_before, after, middle)
    return after
