"""An orbit in time: states of an object every minute or so, and covariances at some of the times.

Between its states it is the polynomial of Hermite through the four about a time (CCSDS 502.0-B-2, 5.2.3.5),
to which an OEM is written. Covariances are linear between those known.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Self

import numpy as np

from opml.base.constants import EARTH_GM
from opml.base.errors import InputError
from opml.interop import ccsds
from opml.interop.object_ids import UNKNOWN, ObjectId
from opml.orbits.density_error import DensityErrors
from opml.orbits.elements import rsw_rotation, tnw_rotation
from opml.orbits.state_polynomials import FEWEST, StatePolynomials

EPOCH = "2000-01-01T12:00:00"  # UTC text from which times of files count [s], to a microsecond

LONGEST_STEP = 300.0
"""Longest time between two states without a gap [s]: beyond, the polynomials through them err by metres."""

COVARIANCE_HELD = 600.0
"""Time for which a covariance holds before the first and beyond the last that is known [s]."""

_VELOCITY_MISS = 1e3  # of the chord by the states at its ends [m]
_STRAYING = 300.0  # the same of a single one [m]: a burn of 10 m/s within a minute
_TIMES_USUAL = 10.0  # least ratio to the usual miss of a single one that is wrong
_NEAREST, _FARTHEST = 6e6, 1e9  # from the Earth's centre [m]
_CLOCK = 1e-5  # to which times are known [s]
_ROUGH = 0.1  # of a chord that the states at its ends may be off
_SMOOTH = 1e-3  # the same of a single one: twenty times what SGP4 is off
_DEGREE = 7  # of the polynomials that give velocities to positions


def velocities_of(t: np.ndarray, positions: np.ndarray) -> np.ndarray:
    """Return velocities (n, 3) [m/s] that lead from position to position (n, 3) [m] at times (n,) [s]."""
    from scipy.interpolate import make_interp_spline  # a third of a second

    curve = make_interp_spline(t - t[0], positions, k=min(_DEGREE, len(t) - 1 - len(t) % 2))
    return np.asarray(curve.derivative()(t - t[0]))


def with_velocities(t: np.ndarray, states: np.ndarray) -> np.ndarray:
    """Return states (n, 6) at times (n,) [s], with the velocities to their positions where any is unknown."""
    if np.isfinite(states).all() or len(t) < FEWEST:
        return states
    return np.hstack([states[:, :3], velocities_of(t, states[:, :3])])


@dataclass(frozen=True, eq=False)
class Ephemeris:
    """States of an object, with covariances at some of the times [s since some epoch].

    known: when the newest was known that it is made from; None: its first state
    density: the part of the covariances that other objects share; None where unknown
    """

    name: str
    t: np.ndarray  # (n,) ascending
    states: np.ndarray  # (n, 6) in GCRF [m, m/s], velocities NaN where unknown
    covariance_t: np.ndarray = field(default_factory=lambda: np.empty(0))  # (m,) ascending
    covariances: np.ndarray = field(default_factory=lambda: np.empty((0, 6, 6)))  # (m, 6, 6) [m, m/s]
    covariance_frame: str | np.ndarray = "GCRF"  # GCRF, or RSW of the states; of all, or (m,) of each
    remark: str = ""  # what to know of it; a comment in a message
    degree: int = 0  # of the Hermite interpolation of the states; 0 leaves it open
    identity: ObjectId = UNKNOWN  # what else than the name identifies the object
    known: float | None = None
    density: DensityErrors | None = None

    @property
    def newest(self) -> float:
        """When the newest was known that it is made from."""
        return float(self.t[0]) if self.known is None else self.known

    @property
    def span(self) -> tuple[float, float]:
        """First and last time."""
        return float(self.t[0]), float(self.t[-1])

    def shifted(self, since: float) -> Self:
        """Return it with times from another epoch, `since` [s] before its own."""
        density = self.density and replace(self.density, t=self.density.t + since)
        known = None if self.known is None else self.known + since
        t, covariance_t = self.t + since, self.covariance_t + since
        return replace(self, t=t, covariance_t=covariance_t, known=known, density=density)

    def check(self) -> None:
        """Raise InputError for fewer than four states, too sparse ones, and ones of no orbit."""
        if len(self.t) < FEWEST:
            raise InputError(f"{self.name}: expected at least {FEWEST} states, got {len(self.t)}")
        if not (longest := float(np.diff(self.t).max())) <= LONGEST_STEP + _CLOCK:
            raise InputError(
                f"{self.name}: expected states at steps of at most {LONGEST_STEP:g} s, got {longest:g}"
            )

        distance = np.linalg.norm(self.states[:, :3], axis=1)
        low, high = float(distance.min()), float(distance.max())
        if not _NEAREST <= low <= high <= _FARTHEST:
            raise InputError(
                f"{self.name}: expected positions {_NEAREST / 1e3:g} to {_FARTHEST / 1e3:g} km from the "
                f"Earth's centre, got {low / 1e3:g} to {high / 1e3:g}"
            )
        off, chords = self._misses()
        strays = (off > _STRAYING + _SMOOTH * chords) & (off > _TIMES_USUAL * np.median(off))
        # A wrong state is off both neighbours, a burn shows on one side.
        spikes = np.flatnonzero(strays[1:] & strays[:-1]) + 1
        wrong = np.append(spikes, np.flatnonzero(off > _VELOCITY_MISS + _ROUGH * chords))
        if len(wrong):
            worst = wrong[0]
            raise InputError(
                f"{self.name}: expected velocities that lead from position to position, got "
                f"{off[worst] / 1e3:.3g} km off at {ccsds.utc_texts(EPOCH, self.t[worst : worst + 1])[0]}"
            )

    def _misses(self) -> tuple[np.ndarray, np.ndarray]:
        """Return how far velocities lead past each next position, and the chords to them (n - 1,) [m].

        The Earth's attraction at both ends is accounted for: the rest is that of other forces.
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

    def holds(self, t: np.ndarray) -> np.ndarray:
        """Return whether states follow at times (n,): at its own, and between them where they are many."""
        if len(self.t) >= FEWEST:
            return np.asarray((t >= self.t[0] - _CLOCK) & (t <= self.t[-1] + _CLOCK))
        return np.asarray(np.abs(t[:, None] - self.t).min(axis=1) <= _CLOCK)

    def at(self, t: np.ndarray) -> np.ndarray:
        """Return states (n, 6) at times (n,): by polynomials through four, of fewer states the nearest.

        Raises InputError as `check`.
        """
        if len(self.t) >= FEWEST:
            return self._polynomials.at(t)
        return np.asarray(self.states[np.abs(t[:, None] - self.t).argmin(axis=1)])

    @cached_property
    def _polynomials(self) -> StatePolynomials:
        self.check()
        return StatePolynomials(self.t, self.states)

    def covariances_at(self, t: np.ndarray) -> np.ndarray:
        """Return covariances (n, 6, 6) at times (n,), linear between those known, NaN far from all."""
        known, covariances = self.covariance_t, self.covariances
        if not len(known):
            return np.full((len(t), *covariances.shape[1:]), np.nan)
        after = np.clip(np.searchsorted(known, t), min(1, len(known) - 1), len(known) - 1)
        before = np.maximum(after - 1, 0)
        share = np.clip((t - known[before]) / np.maximum(known[after] - known[before], 1e-9), 0.0, 1.0)
        share = share[:, None, None]
        between = (1.0 - share) * covariances[before] + share * covariances[after]
        is_near = (t >= known[0] - COVARIANCE_HELD) & (t <= known[-1] + COVARIANCE_HELD)
        return np.where(is_near[:, None, None], between, np.nan)

    def in_rsw(self, states_at: Callable[[np.ndarray], np.ndarray] | None = None) -> Self:
        """Return it with covariances in RSW.

        states_at: its states (n, 6) at times (n,), NaN where unknown: there, covariances are left out
        """
        t = self.covariance_t
        axes = np.broadcast_to(np.asarray(self.covariance_frame, dtype=str), len(t))
        if np.all(axes == "RSW"):
            return replace(self, covariance_frame="RSW")
        states = (states_at or self.at)(t)
        known = np.isfinite(states).all(axis=1)
        turns, axes = rsw_rotation(states[known]), axes[known]
        turns[axes == "TNW"] @= tnw_rotation(states[known][axes == "TNW"]).transpose(0, 2, 1)
        turns[axes == "RSW"] = np.eye(3)
        both = np.kron(np.eye(2), turns)
        covariances = both @ self.covariances[known] @ both.transpose(0, 2, 1)
        return replace(self, covariance_t=t[known], covariances=covariances, covariance_frame="RSW")
