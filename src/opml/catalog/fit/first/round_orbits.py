"""Orbits near a circle: where lines of sight, which give no distance, start from.

Two lines of sight and the time between them give a circular orbit: its radius is where the angle between the
points that it has on both lines is the one that it covers in that time. Most orbits are near a circle, and a
short track says little else about their shape. So fits to such tracks take the eccentricity for 0, give or
take a standard deviation, until the measurements know better.
Source: Milani & Gronchi 2010, Theory of Orbit Determination, ch. 8 (what a short track leaves open) and 10
(the line along which orbits fit it as well); Vallado 2013, sec. 2.4 (the eccentricity's vector) and 7.3.
"""

import numpy as np

_RADII = np.geomspace(6.45e6, 1e8, 600)  # radii between which those of circular orbits are looked for [m]


def round_orbits(t: np.ndarray, standing: np.ndarray, sights: np.ndarray, gm: float) -> np.ndarray:
    """Return states (orbits, 6) at the first time of all circular orbits through two lines of sight.

    t: (2,) times, within half a revolution of each other [s]
    standing: (2, 3) where the lines begin, on the ground, in an inertial frame [m]
    sights: (2, 3) unit vectors along them
    gm: of the Earth [m3/s2]
    """
    first, last = (_at_radii(*line) for line in zip(standing, sights, strict=True))
    normal = np.cross(first, last)
    angle = np.arctan2(np.linalg.norm(normal, axis=1), np.sum(first * last, axis=1))
    ahead = angle - np.sqrt(gm / _RADII**3) * (t[1] - t[0])
    below = np.flatnonzero(ahead[:-1] * ahead[1:] < 0.0)
    part = (ahead[below] / (ahead[below] - ahead[below + 1]))[:, None]
    position, pole = (one[below] + part * (one[below + 1] - one[below]) for one in (first, normal))
    direction = np.cross(pole, position)
    speed = np.sqrt(gm / np.linalg.norm(position, axis=1, keepdims=True))
    velocity = speed * direction / np.linalg.norm(direction, axis=1, keepdims=True)
    return np.hstack([position, velocity])


def _at_radii(standing: np.ndarray, sight: np.ndarray) -> np.ndarray:
    """Return where (radii, 3) a line of sight from the ground leaves the spheres of all radii.

    standing, sight: (3,), as in `round_orbits`
    """
    along = standing @ sight
    far = np.sqrt(along**2 - standing @ standing + _RADII**2) - along
    return standing + far[:, None] * sight


def eccentricity(state: np.ndarray, gm: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the eccentricity's vector (3,) of a state (6,) [m, m/s], and its derivatives (3, 6)."""
    position, velocity = state[:3], state[3:]
    radius, rate = np.linalg.norm(position), position @ velocity
    excess = velocity @ velocity - gm / radius
    by_position = (
        excess * np.eye(3) + gm / radius**3 * np.outer(position, position) - np.outer(velocity, velocity)
    )
    by_velocity = 2.0 * np.outer(position, velocity) - np.outer(velocity, position) - rate * np.eye(3)
    vector: np.ndarray = (excess * position - rate * velocity) / gm
    return vector, np.hstack([by_position, by_velocity]) / gm
