"""Conversions between states, classical orbital elements (COE), the RSW frame and the anomalies.

A set of COE is [a, e, i, argp, raan, nu] on the last axis: semi-major axis [m], eccentricity, inclination,
argument of perigee, right ascension of the ascending node and true anomaly [rad]. A state is
[x, y, z, vx, vy, vz] on the last axis, in an inertial frame [m, m/s].

Source: Vallado, Fundamentals of Astrodynamics and Applications, chapter 2 (elements) and 3.3 (RSW).
"""

import numpy as np

from opml.base.errors import InputError

TURN = 2.0 * np.pi

# Below these an orbit counts as circular or equatorial: the perigee or the node is rounding noise there.
CIRCULAR_ECCENTRICITY = 1e-13
EQUATORIAL_SINE = 1e-13


def wrap_turn(angle: np.ndarray) -> np.ndarray:
    """Return angles [rad] reduced to [0, 2 pi)."""
    wrapped = np.mod(angle, TURN)
    return np.where(wrapped >= TURN, 0.0, wrapped)  # mod of a tiny negative angle rounds up to a full turn


def wrap_half_turn(angle: np.ndarray) -> np.ndarray:
    """Return angles [rad] reduced to (-pi, pi], for differences of angles."""
    return -(np.mod(np.pi - angle, TURN) - np.pi)


def coe_from_cartesian(states: np.ndarray, gm: float) -> np.ndarray:
    """Return the COE (..., 6) of elliptic or hyperbolic (a < 0) orbits; angles in [0, 2 pi).

    states: (..., 6) inertial [m, m/s]; NaN follows for a straight line through the centre
    gm: gravitational parameter [m3/s2]

    An equatorial orbit has raan 0 (the node is the x axis). A circular orbit has argp 0, and its nu is the
    argument of latitude.
    """
    position, velocity = np.asarray(states)[..., :3], np.asarray(states)[..., 3:]
    radius = np.linalg.norm(position, axis=-1)
    momentum = np.cross(position, velocity)
    h = np.linalg.norm(momentum, axis=-1)
    a = 1.0 / (2.0 / radius - np.sum(velocity**2, axis=-1) / gm)

    # e cos nu and e sin nu from the orbit's equation: well behaved down to the circular orbit.
    e_cos_nu = h**2 / (gm * radius) - 1.0
    e_sin_nu = h * np.sum(position * velocity, axis=-1) / (gm * radius)
    e = np.hypot(e_cos_nu, e_sin_nu)
    circular = e <= CIRCULAR_ECCENTRICITY
    nu = np.where(circular, 0.0, np.arctan2(e_sin_nu, e_cos_nu))

    horizontal = np.hypot(momentum[..., 0], momentum[..., 1])
    inclination = np.arctan2(horizontal, momentum[..., 2])
    equatorial = horizontal <= EQUATORIAL_SINE * h
    raan = np.where(equatorial, 0.0, np.arctan2(momentum[..., 0], -momentum[..., 1]))

    node = np.stack([np.cos(raan), np.sin(raan), np.zeros_like(raan)], axis=-1)
    ahead = np.cross(momentum / h[..., None], node)
    latitude_argument = np.arctan2(np.sum(position * ahead, axis=-1), np.sum(position * node, axis=-1))
    argp = np.where(circular, 0.0, latitude_argument - nu)
    nu = np.where(circular, latitude_argument, nu)
    return np.stack([a, e, inclination, wrap_turn(argp), wrap_turn(raan), wrap_turn(nu)], axis=-1)


def cartesian_from_coe(coe: np.ndarray, gm: float) -> np.ndarray:
    """Return the inertial states (..., 6) [m, m/s] of COE (..., 6), with gm [m3/s2]."""
    a, e, inclination, argp, raan, nu = np.moveaxis(np.asarray(coe, dtype=float), -1, 0)
    parameter = a * (1.0 - e**2)
    radius = parameter / (1.0 + e * np.cos(nu))
    speed = np.sqrt(gm / parameter)

    node = np.stack([np.cos(raan), np.sin(raan), np.zeros_like(raan)], axis=-1)
    ahead = np.stack(
        [-np.sin(raan) * np.cos(inclination), np.cos(raan) * np.cos(inclination), np.sin(inclination)],
        axis=-1,
    )
    u = argp + nu

    def combine(along_node: np.ndarray, along_ahead: np.ndarray) -> np.ndarray:
        return np.asarray(along_node[..., None] * node + along_ahead[..., None] * ahead)

    position = combine(radius * np.cos(u), radius * np.sin(u))
    velocity = combine(-speed * (np.sin(u) + e * np.sin(argp)), speed * (np.cos(u) + e * np.cos(argp)))
    return np.concatenate([position, velocity], axis=-1)


def rsw_rotation(states: np.ndarray) -> np.ndarray:
    """Return the rotations (..., 3, 3) from the inertial frame to RSW of the states (..., 6).

    Rows are the unit vectors radial R, along-track S (in the orbital plane, towards the velocity) and
    cross-track W (angular momentum): the x, y and z axes of the paper's errors.
    """
    # Number by number, as functions of vectors take twice as long.
    x, y, z, vx, vy, vz = np.ascontiguousarray(np.moveaxis(np.asarray(states), -1, 0))
    wx, wy, wz = y * vz - z * vy, z * vx - x * vz, x * vy - y * vx
    r, w = np.sqrt(x * x + y * y + z * z), np.sqrt(wx * wx + wy * wy + wz * wz)
    rx, ry, rz, wx, wy, wz = x / r, y / r, z / r, wx / w, wy / w, wz / w
    along = wy * rz - wz * ry, wz * rx - wx * rz, wx * ry - wy * rx
    return np.stack([rx, ry, rz, *along, wx, wy, wz], axis=-1).reshape(*x.shape, 3, 3)


def tnw_rotation(states: np.ndarray) -> np.ndarray:
    """Return the rotations (n, 3, 3) from the inertial frame to TNW of the states (n, 6).

    Rows are the unit vectors T along the velocity, N across it in the orbital plane, towards the Earth, and W
    of the angular momentum. Source: SANA registry of orbit-relative reference frames, TNW_INERTIAL.
    """
    along = states[:, 3:] / np.linalg.norm(states[:, 3:], axis=1)[:, None]
    across = rsw_rotation(states)[:, 2]
    return np.stack([along, np.cross(across, along), across], axis=1)


def in_rsw(differences: np.ndarray, states: np.ndarray) -> np.ndarray:
    """Return differences (n, 6) [m, m/s] in RSW of the states (n, 6), both position and velocity rotated."""
    rotated: np.ndarray = np.einsum("nij,nkj->nki", rsw_rotation(states), differences.reshape(-1, 2, 3))
    return rotated.reshape(-1, 6)


def bent_rsw(positions: np.ndarray, reference: np.ndarray) -> np.ndarray:
    """Return (n, 3): height above the reference, the arc ahead of it along its track, across.

    positions: (n, 3), reference: states (n, 6), in one frame and one unit of length
    """
    in_axes = np.einsum("nij,nj->ni", rsw_rotation(reference), positions)
    radius = np.linalg.norm(reference[:, :3], axis=1)
    x, y, z = in_axes.T
    return np.stack([np.hypot(x, y) - radius, radius * np.arctan2(y, x), z], axis=1)


def positions_beside(reference: np.ndarray, bent: np.ndarray) -> np.ndarray:
    """Return the positions (..., 3) that `bent_rsw` has at (..., 3) from a reference (..., 6)."""
    radius = np.linalg.norm(reference[..., :3], axis=-1)
    height, angle = radius + bent[..., 0], bent[..., 1] / radius
    in_axes = np.stack([height * np.cos(angle), height * np.sin(angle), bent[..., 2]], axis=-1)
    return np.asarray(np.einsum("...ji,...j->...i", rsw_rotation(reference), in_axes))


def true_from_mean_anomaly(mean: np.ndarray, e: np.ndarray) -> np.ndarray:
    """Return the true anomaly in [0, 2 pi) [rad] of a mean anomaly [rad] on an elliptic orbit.

    Raises InputError where the eccentricity e is outside [0, 1).
    """
    mean, e = np.broadcast_arrays(wrap_half_turn(np.asarray(mean, dtype=float)), np.asarray(e, dtype=float))
    if not np.all((e >= 0.0) & (e < 1.0)):
        raise InputError("eccentricity: expected a value in [0, 1), got one outside")
    # Newton's method on Kepler's equation converges monotonically from +-pi for every elliptic orbit. The
    # mean anomaly is a faster start, safe for orbits that are not too elongated.
    eccentric = np.where(e < 0.8, mean, np.copysign(np.pi, mean))
    for _ in range(50):
        step = (eccentric - e * np.sin(eccentric) - mean) / (1.0 - e * np.cos(eccentric))
        eccentric = eccentric - step
        if np.all(np.abs(step) < 1e-14):
            break
    half = eccentric / 2.0
    return wrap_turn(2.0 * np.arctan2(np.sqrt(1.0 + e) * np.sin(half), np.sqrt(1.0 - e) * np.cos(half)))


def mean_from_true_anomaly(nu: np.ndarray, e: np.ndarray) -> np.ndarray:
    """Return the mean anomaly in [0, 2 pi) [rad] of a true anomaly [rad] on an elliptic orbit.

    Raises InputError where the eccentricity e is outside [0, 1).
    """
    if not np.all((np.asarray(e) >= 0.0) & (np.asarray(e) < 1.0)):
        raise InputError("eccentricity: expected a value in [0, 1), got one outside")
    half = np.asarray(nu) / 2.0
    eccentric = 2.0 * np.arctan2(np.sqrt(1.0 - e) * np.sin(half), np.sqrt(1.0 + e) * np.cos(half))
    return wrap_turn(eccentric - e * np.sin(eccentric))
