"""Effect of the density forecast's error, which all objects share, on each of them.

The 18th Space Defense Squadron calls it the dynamic consider parameter, and gives it in its messages.
Source: Casali et al. 2018, Effect of cross-correlation of orbital error on probability of collision
determination (AAS 18-272).
"""

from dataclasses import dataclass

import numpy as np

_ROUNDED = 1.01  # what digits that were cut off may make of a part that is all of a standard deviation


@dataclass(frozen=True, eq=False)
class DensityError:
    """An error of density at one time.

    sensitivity: (6,) change of the state by a density twice as high, in RSW axes of the state [m, m/s]
    """

    uncertainty: float  # standard deviation, as a share of the density
    sensitivity: np.ndarray

    @property
    def effect(self) -> np.ndarray:
        """Change of the state (6,) by one standard deviation, in RSW axes of the state [m, m/s]."""
        return self.uncertainty * self.sensitivity

    def is_part_of(self, covariance: np.ndarray) -> bool:
        """Whether a covariance (6, 6) of the state, in the same axes, can contain it."""
        return bool((np.abs(self.effect) <= _ROUNDED * np.sqrt(np.diag(covariance))).all())


@dataclass(frozen=True, eq=False)
class DensityErrors:
    """An error of density over a time."""

    uncertainty: float  # as of DensityError
    t: np.ndarray  # (n,) ascending [s]
    sensitivities: np.ndarray  # (n, 6), each as of DensityError

    def at(self, t: float) -> DensityError:
        """Return the error at a time [s], linear between those that are known."""
        known = (np.interp(t, self.t, column) for column in self.sensitivities.T)
        return DensityError(self.uncertainty, np.array(list(known)))


def drag_sensitivities(displacements: np.ndarray, rate: np.ndarray) -> np.ndarray:
    """Return the changes of states (n, 6) in RSW [m, m/s] by what drag has done to them.

    displacements: (n,) along the track [m]
    rate: (n,) angular rate of the orbit [rad/s], by which the velocity turns with the place
    """
    none = np.zeros_like(displacements)
    return np.column_stack([none, displacements, none, -rate * displacements, none, none])
