"""How far the paths of two objects bend where they would have to be for a collision.

In two dimensions the relative motion is a straight line, wherever the objects are within their covariances.
Where a collision takes kilometres along either orbit, both curve away from that line. So the likeliest
deviations with which the objects collide in two dimensions are laid along the orbits, these are flown by
Kepler's laws to where they are closest, and what is missing to a collision is weighed by the covariance. On
27 conjunctions of NASA's CARA, of which two dimensions are off by 1.5 to 100 in 15, that foretells which.

Sources: Hall 2021, Expected collision rates for tracked satellites, J. Spacecr. Rockets 58; Hall, Baars &
Casali 2023, A multistep probability of collision computational algorithm (AAS 23-398).
"""

import math

import numpy as np

from opml.base.constants import EARTH_GM
from opml.conjunctions.long_encounter import kepler
from opml.conjunctions.probability import LEAST_SIGMA

MOST = 0.1
"""Largest logarithm of a factor for which two dimensions suffice."""

_STEPS = 6  # of Newton's method to the closest approach


def suffice(states: np.ndarray, covariances: np.ndarray, radius: float) -> bool:
    """Return whether two dimensions suffice for the probability of a collision.

    states: (2, 6) of both objects at their closest approach, on ellipses, in GCRF [m, m/s]
    covariances: (2, 6, 6) of them
    radius: sum of the radii [m]
    """
    return abs(logarithm(states, covariances, radius)) <= MOST


def logarithm(states: np.ndarray, covariances: np.ndarray, radius: float) -> float:
    """Return about the logarithm of the factor by which the probability differs from that in two dimensions.

    states, covariances, radius: as in `suffice`
    """
    relative = states[1] - states[0]
    plane = np.linalg.svd(relative[None, 3:])[2][1:]
    spread = plane @ covariances.sum(axis=0)[:3, :3] @ plane.T + (LEAST_SIGMA * radius) ** 2 * np.eye(2)
    weights, miss = np.linalg.inv(spread), plane @ relative[:3]
    likeliest = covariances[:, :, :3] @ plane.T @ weights @ miss
    met = [_along(state, sign * way) for state, way, sign in zip(states, likeliest, (1.0, -1.0), strict=True)]
    needed = miss + plane @ _closest(np.array(met))
    return float(0.5 * (miss @ weights @ miss - needed @ weights @ needed))


def _along(state: np.ndarray, deviation: np.ndarray) -> np.ndarray:
    """Return a state (6,) whose deviation (6,), where it is along the velocity, follows the orbit."""
    position, velocity = state[:3], state[3:]
    time = float(deviation[:3] @ velocity / (velocity @ velocity))
    fall = -EARTH_GM * position / np.linalg.norm(position) ** 3
    aside = deviation - time * np.concatenate([velocity, fall])
    return np.asarray(kepler(state[None], np.array([time]))[0, 0] + aside)


def _closest(states: np.ndarray) -> np.ndarray:
    """Return the relative position (3,) [m] of two ellipses through states (2, 6) where they are closest."""
    relative, t = states[1] - states[0], 0.0
    for _ in range(_STEPS):
        t -= float(relative[:3] @ relative[3:] / (relative[3:] @ relative[3:]))
        if not math.isfinite(t):
            break
        first, second = kepler(states, np.array([t]))[0]
        relative = second - first
    nearest: np.ndarray = relative[:3]
    return nearest
