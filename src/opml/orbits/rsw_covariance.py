"""The shape of the covariances that leave with an ephemeris: sizes of independent parts, in RSW.

A fit's own covariance has radius and along-track as one, the shape of an error of Cd. A correction takes just
that error away, so what is left has another shape: errors of the three axes that know nothing of each other,
and velocities that go with them.
"""

from statistics import NormalDist

import numpy as np

AXES = ("x", "y", "z")
"""Radial, along-track, cross-track."""


def half_width(level: float) -> float:
    """Half the width of a normal interval that holds the share `level`, in standard deviations."""
    return NormalDist().inv_cdf(0.5 + 0.5 * level)


def stated(sigma: np.ndarray, rate: np.ndarray) -> np.ndarray:
    """Covariances (n, 6, 6) in RSW [m, m/s] of positions and velocities: the only ones that leave.

    sigma: (n, 6) standard deviations [m, m/s] of the `free_parts`, which are taken for independent; rate:
    (n,) of the orbit's turn [rad/s]. RSW means axes only: a velocity is not one in a turning frame.
    """
    mixing = np.tile(np.eye(6), (len(sigma), 1, 1))
    mixing[:, 3, 1] = mixing[:, 4, 0] = -rate
    covariance: np.ndarray = (mixing * sigma[:, None, :] ** 2) @ mixing.transpose(0, 2, 1)
    even: np.ndarray = 0.5 * (covariance + covariance.transpose(0, 2, 1))
    return even


def free_parts(errors: np.ndarray, rate: np.ndarray) -> np.ndarray:
    """Errors (n, 6) in RSW [m, m/s] with what follows from the position taken off the velocity.

    On a nearly circular orbit one that is ahead by y has turned by y / r, so its radial velocity errs by
    -w y, and one that is too high by x is slower by w x (angular momentum); rate (n,): w [rad/s].
    """
    free: np.ndarray = errors.copy()
    free[:, 3] += rate * errors[:, 1]
    free[:, 4] += rate * errors[:, 0]
    return free


def rates(states: np.ndarray) -> np.ndarray:
    """Rates (n,) [rad/s] at which the positions of states (n, 6) [m, m/s] turn."""
    momentum = np.linalg.norm(np.cross(states[:, :3], states[:, 3:]), axis=1)
    turned: np.ndarray = momentum / np.sum(states[:, :3] ** 2, axis=1)
    return turned


def mahalanobis(errors: np.ndarray, covariance: np.ndarray) -> np.ndarray:
    """Squared Mahalanobis distances (n,) of errors (n, k) by their covariances (n, k, k)."""
    solved = np.linalg.solve(covariance, errors[:, :, None])[:, :, 0]
    squared: np.ndarray = np.sum(errors * solved, axis=1)
    return squared
