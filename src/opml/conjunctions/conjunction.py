"""Two objects at their closest approach: what is known of each, and how likely a collision is."""

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from opml.base.constants import EARTH_GM
from opml.base.errors import InputError
from opml.conjunctions import long_encounter
from opml.conjunctions.likeliest_collision import UncertainPairs
from opml.conjunctions.probability import SHORT, Chance, Encounter, chance
from opml.interop.object_ids import ObjectId
from opml.orbits.density_error import DensityError
from opml.orbits.elements import in_rsw, rsw_rotation
from opml.orbits.rsw_covariance import least_variances

LARGEST_RADIUS = 1e4  # largest sum of the radii of two objects [m]: one that is larger is in another unit
_NEGATIVE = -0.01  # least variance of scaled axes that rounded digits may make
_WIDE, _EXACT = 1e5, 0.1
"""Sigmas of a position [m] beyond which a remark says so: it may be in another unit, or made up."""

_SAME = 1e-2  # [s, m, m/s]; what the interpolation of the same states may differ by


@dataclass(frozen=True, eq=False)
class Participant:
    """An object at the time of a closest approach.

    covariance: (6, 6) in RSW axes of the state, velocities inertial [m, m/s]; None where unknown
    """

    identity: ObjectId
    state: np.ndarray  # (6,) GCRF [m, m/s]
    covariance: np.ndarray | None = None
    remarks: tuple[str, ...] = ()  # what to know of either
    density: DensityError | None = None  # the part of the covariance that others share; None where unknown
    is_of_position: bool = False  # whether the covariance is of the position alone, velocities' parts 0

    @property
    def _axes(self) -> np.ndarray:
        """Axes (6, 6) of the covariance, for states in GCRF."""
        return np.asarray(np.kron(np.eye(2), rsw_rotation(self.state[None])[0]))

    @property
    def inertial_covariance(self) -> np.ndarray:
        """Covariance (6, 6) in GCRF [m, m/s], zero where it is unknown: known exactly, then."""
        if self.covariance is None:
            return np.zeros((6, 6))
        return self._axes.T @ self.covariance @ self._axes

    @property
    def is_definite(self) -> bool:
        """Return whether the covariance has variances below zero in no direction, but for rounding."""
        if self.covariance is None:
            return True
        return bool(least_variances(self.covariance) > _NEGATIVE)

    @property
    def inertial_density(self) -> np.ndarray:
        """Change of the state (6,) by one standard deviation of the density, in GCRF [m, m/s], 0: unknown."""
        if self.density is None:
            return np.zeros(6)
        return self._axes.T @ self.density.effect

    def is_again(self, other: "Participant") -> bool:
        """Return whether another one has the same orbit and covariance, but for rounding."""
        is_near = np.allclose(self.state, other.state, rtol=0.0, atol=_SAME)
        return is_near and np.allclose(self.inertial_covariance, other.inertial_covariance)

    @property
    def pace(self) -> float:
        """Time of a revolution [s] on the circle through the object, where paths bend as fast as its own."""
        return 2.0 * math.pi * math.sqrt(float(np.linalg.norm(self.state[:3])) ** 3 / EARTH_GM)

    @property
    def period(self) -> float:
        """Time of a revolution [s], infinite for no ellipse."""
        radius, speed = np.linalg.norm(self.state[:3]), np.linalg.norm(self.state[3:])
        inverse = 2.0 / radius - speed**2 / EARTH_GM
        return 2.0 * math.pi / math.sqrt(EARTH_GM * inverse**3) if inverse > 0.0 else math.inf


@dataclass(frozen=True, eq=False)
class Conjunction:
    """Two objects where they are closest.

    known: when the newest was known of either [s since that epoch]; None: at the approach
    common: (2, 6) what one standard deviation of an error that both share does to their states in GCRF
        [m, m/s]; None: their errors are independent
    stated: probability of a collision that a message has, None without one
    """

    t: float  # when [s since some epoch]
    first: Participant
    second: Participant
    radius: float  # sum of the radii of both [m]
    is_end: bool = False  # whether nothing is known beyond, where they may come nearer
    known: float | None = None
    common: np.ndarray | None = None
    stated: float | None = None

    @cached_property
    def correlated(self) -> "Conjunction | None":
        """The same with the error of density that both share, None where it is unknown of either."""
        pair = (self.first, self.second)
        if any(one.density is None for one in pair):
            return None
        return replace(self, common=np.array([one.inertial_density for one in pair]))

    @property
    def relative(self) -> np.ndarray:
        """State (6,) of the second relative to the first, in RSW of the first [m, m/s]."""
        difference = (self.second.state - self.first.state)[None]
        return np.asarray(in_rsw(difference, self.first.state[None])[0])

    def is_again(self, other: "Conjunction") -> bool:
        """Return whether another one has the same of both objects, but for rounding."""
        pairs = (self.first, other.first), (self.second, other.second)
        return abs(self.t - other.t) < _SAME and all(one.is_again(another) for one, another in pairs)

    @property
    def encounter(self) -> Encounter | None:
        """The encounter, None where the covariance of neither object is known."""
        if self.first.covariance is None and self.second.covariance is None:
            return None
        relative = self.second.state - self.first.state
        covariance = self.first.inertial_covariance + self.second.inertial_covariance
        if self.common is not None:
            shared = np.outer(*self.common)
            covariance = covariance - shared - shared.T
        return Encounter(relative[:3], relative[3:], covariance[:3, :3], self.radius)

    @cached_property
    def likeliest(self) -> Encounter | None:
        """The encounter where both most likely collide; None without covariances, and where none is straight.

        Of hyperbolas it is that of the states.
        """
        if self.encounter is None or not self._may_bend:
            return self.encounter
        cloud, velocity, is_straight = self._pair.collisions()
        if not is_straight:
            return None
        return Encounter(cloud.mean[:3], velocity, cloud.covariance[:3, :3], self.radius)

    @property
    def is_short(self) -> bool:
        """Whether the encounter is short compared with a revolution at the pace of either object.

        The likeliest collision may be as far from the approach in time as the relative motion takes to its
        place.
        """
        if self.likeliest is None:
            return False
        miss, speed = (float(np.linalg.norm(part)) for part in np.split(self.relative, 2))
        pace = min(self.first.pace, self.second.pace)
        return self.likeliest.duration * speed + 2.0 * miss < SHORT * pace * speed

    @property
    def method(self) -> str:
        """Name of the method that suffices for the probability, empty where there is none."""
        if self.chance is None:
            return ""
        if not self.is_short:
            return "3D-Nc"
        return "2D-Nc" if self._may_bend else "2D-Pc"

    @property
    def _may_bend(self) -> bool:
        """Whether paths that bend can be reckoned with: of ellipses, and with errors of velocities."""
        pair = (self.first, self.second)
        return not any(math.isinf(one.period) or one.is_of_position for one in pair)

    @cached_property
    def chance(self) -> Chance | None:
        """The probability of a collision; None: unknown, or a long encounter of no ellipses."""
        if self.is_short and self.likeliest is not None:
            return chance(self.likeliest)
        if self.encounter is None or not self._may_bend:
            return None
        return long_encounter.chance(self._pair, min(self.first.period, self.second.period))

    @property
    def _pair(self) -> UncertainPairs:
        pair = (self.first, self.second)
        states = np.array([one.state for one in pair])
        covariances = np.array([one.inertial_covariance for one in pair])
        return UncertainPairs(states, covariances, np.array(self.radius), self.common)


def remarks_on(name: str, covariance: np.ndarray | None) -> tuple[str, ...]:
    """Return what to know of an object's covariance (6, 6) [m, m/s]: that it is too wide, or zero."""
    if covariance is None:
        return ()
    widest = float(np.sqrt(np.diag(covariance)[:3].max()))
    if not np.any(covariance[:3, :3]):
        return (f"covariance of {name} zero, as where it is unknown",)
    if widest > _WIDE:
        return (f"{name} known to {widest / 1e3:.0f} km",)
    return (f"{name} known to {1e3 * widest:.0f} mm",) if widest < _EXACT else ()


def check_length(name: str, length: float) -> None:
    """Raise InputError for a length [m] that is none."""
    if not 0.0 < length < math.inf:
        raise InputError(f"{name}: expected a length above 0, got {length:g} m")


def check_radius(radius: float) -> None:
    """Raise InputError for a sum of radii [m] that no two objects have."""
    check_length("radius", radius)
    if radius > LARGEST_RADIUS:
        raise InputError(f"radius: expected at most {LARGEST_RADIUS:g} m, got {radius:g} m")
