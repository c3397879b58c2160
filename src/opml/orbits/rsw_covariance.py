"""Covariances in RSW from sizes of independent errors: the only covariances that ephemerides carry.

A fit's own covariance ties radius and along-track together, in the shape of an error of Cd. A correction
removes that very error. The remaining errors have another shape: the three axes are independent, and each
velocity follows from the position.
"""

from collections.abc import Callable
from dataclasses import dataclass
from statistics import NormalDist

import numpy as np

from opml.orbits.density_error import DensityErrors

AXES = ("x", "y", "z")  # radial, along-track, cross-track

LEVEL = 0.9  # share of the errors that intervals and ellipsoids are to hold


def half_width(level: float) -> float:
    """Return half the width of a normal interval that holds the share `level`, in standard deviations."""
    return NormalDist().inv_cdf(0.5 + 0.5 * level)


_TURNING = 0.5  # of the free part of the velocity along the track: of the rate times the radial sigma
INSIDE = half_width(LEVEL)  # half the width of that interval, in standard deviations


@dataclass(frozen=True, eq=False)
class ErrorModel:
    """Errors that a predicted orbit is expected to have, at times (n,) [s] and GCRF states (n, 6) [m, m/s].

    covariances: returns them (n, 6, 6) in RSW [m, m/s], NaN where they are unknown
    density: returns the part of them that other objects share, None where it is unknown
    """

    covariances: Callable[[np.ndarray, np.ndarray], np.ndarray]
    density: Callable[[np.ndarray, np.ndarray], DensityErrors | None] = lambda t, states: None


def rsw_covariances(sigma: np.ndarray, rate: np.ndarray) -> np.ndarray:
    """Return covariances (n, 6, 6) of positions and velocities in RSW [m, m/s].

    sigma: (n, 6) standard deviations [m, m/s] of the position, and of the velocity without the part that
        follows from the position, taken as independent
    rate: (n,) angular rate w of the orbit [rad/s]

    On a nearly circular orbit a satellite ahead by y has turned by y / r, so its radial velocity errs by
    -w y. A satellite too high by x is slower by w x (angular momentum). RSW gives the axes only: velocities
    are inertial, not those in a turning frame.
    """
    mixing = np.tile(np.eye(6), (len(sigma), 1, 1))
    mixing[:, 3, 1] = mixing[:, 4, 0] = -rate
    covariance: np.ndarray = (mixing * sigma[:, None, :] ** 2) @ mixing.transpose(0, 2, 1)
    return np.asarray(0.5 * (covariance + covariance.transpose(0, 2, 1)))


def position_covariances(sigmas: np.ndarray, states: np.ndarray) -> np.ndarray:
    """Return covariances (n, 6, 6) in RSW [m, m/s] where sizes of errors of positions (n, 3) [m] are known.

    states: (n, 6) [m, m/s]

    What is free of the velocity errs as the position does times the rate of the orbit.
    """
    rate = rates(states)
    velocity = rate[:, None] * sigmas[:, [0, 0, 2]] * [1.0, _TURNING, 1.0]
    return rsw_covariances(np.hstack([sigmas, velocity]), rate)


def rates(states: np.ndarray) -> np.ndarray:
    """Return the angular rates (n,) [rad/s] of states (n, 6) [m, m/s]."""
    momentum = np.linalg.norm(np.cross(states[:, :3], states[:, 3:]), axis=1)
    return np.asarray(momentum / np.sum(states[:, :3] ** 2, axis=1))


def least_variances(covariances: np.ndarray) -> np.ndarray:
    """Return the least variance (...) in any direction of covariances (..., k, k), of axes scaled to 1.

    It is below 0 where a covariance is none, 0 where it has no extent in a direction.
    """
    sigma = np.sqrt(np.maximum(np.diagonal(covariances, axis1=-2, axis2=-1), np.finfo(float).tiny))
    return np.asarray(np.linalg.eigvalsh(covariances / (sigma[..., None] * sigma[..., None, :]))[..., 0])


def mahalanobis(errors: np.ndarray, covariance: np.ndarray) -> np.ndarray:
    """Return squared Mahalanobis distances (n,) of errors (n, k) under covariances (n, k, k)."""
    solved = np.linalg.solve(covariance, errors[:, :, None])[:, :, 0]
    return np.asarray(np.sum(errors * solved, axis=1))
