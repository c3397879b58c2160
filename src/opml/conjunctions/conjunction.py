"""Two objects at their closest approach: what is known of each, and how likely a collision is."""

import math
from dataclasses import dataclass

import numpy as np

from opml.base.constants import EARTH_GM
from opml.conjunctions.probability import Chance, Encounter, chance
from opml.orbits.elements import in_rsw, rsw_rotation


@dataclass(frozen=True, eq=False)
class Participant:
    """An object at the time of a closest approach.

    state: (6,) GCRF [m, m/s]
    covariance: (6, 6) in RSW axes of the state, velocities inertial [m, m/s]; None where unknown
    """

    name: str
    state: np.ndarray
    covariance: np.ndarray | None = None

    @property
    def position_covariance(self) -> np.ndarray | None:
        """Covariance (3, 3) of the position in GCRF [m2]."""
        if self.covariance is None:
            return None
        axes = rsw_rotation(self.state[None])[0]
        turned: np.ndarray = axes.T @ self.covariance[:3, :3] @ axes
        return turned

    @property
    def period(self) -> float:
        """Time of a revolution [s], infinite for no ellipse."""
        radius, speed = np.linalg.norm(self.state[:3]), np.linalg.norm(self.state[3:])
        inverse = 2.0 / radius - speed**2 / EARTH_GM
        return 2.0 * math.pi / math.sqrt(EARTH_GM * inverse**3) if inverse > 0.0 else math.inf


@dataclass(frozen=True, eq=False)
class Conjunction:
    """Two objects where they are closest.

    t: when [s since some epoch]
    radius: sum of the radii of both [m]
    """

    t: float
    first: Participant
    second: Participant
    radius: float

    @property
    def relative(self) -> np.ndarray:
        """State (6,) of the second relative to the first, in RSW of the first [m, m/s]."""
        difference = (self.second.state - self.first.state)[None]
        return np.asarray(in_rsw(difference, self.first.state[None])[0])

    @property
    def encounter(self) -> Encounter | None:
        """The encounter, None where the covariance of neither object is known.

        An object without a covariance counts as known exactly.
        """
        known = [one.position_covariance for one in (self.first, self.second)]
        covariances = [one for one in known if one is not None]
        if not covariances:
            return None
        relative = self.second.state - self.first.state
        return Encounter(relative[:3], relative[3:], np.sum(covariances, axis=0), self.radius)

    @property
    def is_short(self) -> bool:
        """Whether the encounter, if there is one, is short beside a revolution of either object."""
        encounter = self.encounter
        return encounter is not None and encounter.is_short(min(self.first.period, self.second.period))

    @property
    def chance(self) -> Chance | None:
        """How likely a collision is; None where it is unknown, and for an encounter that is not short."""
        encounter = self.encounter
        return chance(encounter) if encounter is not None and self.is_short else None
