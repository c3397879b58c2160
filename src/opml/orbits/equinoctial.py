"""Equinoctial elements of ellipses, which are regular for circles and in the plane of the axes.

A set is [log n, h, k, p, q, L] on the last axis: the logarithm of the mean motion [rad/s]; h and k, the
eccentricity times sine and cosine of the longitude of perigee; p and q, the tangent of half the inclination
times sine and cosine of the longitude of the node; the mean longitude L [rad]. An inclination of half a turn
has none.

Source: Broucke & Cefola 1972, On the equinoctial orbit elements, Celest. Mech. 5.
"""

import numpy as np

from opml.orbits.elements import mean_from_true_anomaly, true_from_mean_anomaly


def equinoctial_from_cartesian(states: np.ndarray, gm: float) -> np.ndarray:
    """Return the elements (..., 6) of states (..., 6) on ellipses [m, m/s], with gm [m3/s2].

    Raises InputError for a state on no ellipse.
    """
    position, velocity = states[..., :3], states[..., 3:]
    radius = np.linalg.norm(position, axis=-1, keepdims=True)
    momentum = np.cross(position, velocity)
    normal = momentum / np.linalg.norm(momentum, axis=-1, keepdims=True)
    p, q = normal[..., 0] / (1.0 + normal[..., 2]), -normal[..., 1] / (1.0 + normal[..., 2])
    x_axis, y_axis = _axes(p, q)
    eccentricity = np.cross(velocity, momentum) / gm - position / radius
    h, k = _dot(eccentricity, y_axis), _dot(eccentricity, x_axis)
    e, perigee = np.hypot(h, k), np.arctan2(h, k)
    true = np.arctan2(_dot(position, y_axis), _dot(position, x_axis)) - perigee
    inverse = 2.0 / radius[..., 0] - _dot(velocity, velocity) / gm
    motion = 0.5 * np.log(gm * np.abs(inverse) ** 3)
    return np.stack([motion, h, k, p, q, perigee + mean_from_true_anomaly(true, e)], axis=-1)


def cartesian_from_equinoctial(elements: np.ndarray, t: np.ndarray, gm: float) -> np.ndarray:
    """Return the states (..., 6) [m, m/s] of elements (..., 6) at times (...) [s] after them.

    gm: gravitational parameter [m3/s2]

    Raises InputError for an eccentricity outside [0, 1).
    """
    log_motion, h, k, p, q, mean = np.moveaxis(elements, -1, 0)
    motion = np.exp(log_motion)
    e, perigee = np.hypot(h, k), np.arctan2(h, k)
    true = perigee + true_from_mean_anomaly(mean + motion * t - perigee, e)
    cosine, sine = np.cos(true), np.sin(true)
    parameter = np.cbrt(gm / motion**2) * (1.0 - e**2)
    radius, speed = parameter / (1.0 + h * sine + k * cosine), np.sqrt(gm / parameter)
    x_axis, y_axis = _axes(p, q)
    position = (radius * cosine)[..., None] * x_axis + (radius * sine)[..., None] * y_axis
    velocity = (speed * (cosine + k))[..., None] * y_axis - (speed * (sine + h))[..., None] * x_axis
    return np.concatenate([position, velocity], axis=-1)


def _axes(p: np.ndarray, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the unit vectors (..., 3) in the orbital plane from which longitudes count."""
    scale = (1.0 + p**2 + q**2)[..., None]
    x_axis = np.stack([1.0 - p**2 + q**2, 2.0 * p * q, -2.0 * p], axis=-1) / scale
    y_axis = np.stack([2.0 * p * q, 1.0 + p**2 - q**2, 2.0 * q], axis=-1) / scale
    return x_axis, y_axis


def _dot(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    return np.asarray(np.sum(one * other, axis=-1))
