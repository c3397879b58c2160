"""Acceleration by general relativity, in the three terms of the IERS Conventions 2010, eq. 10.12."""

from opml.base.constants import EARTH_ANGULAR_MOMENTUM, SPEED_OF_LIGHT
from opml.dynamics.kernels.lanes import compiled

_PER_C2 = 1.0 / SPEED_OF_LIGHT**2


@compiled
def relativity(x, y, z, vx, vy, vz, inverse_r, gm, axis, precession):
    """Return the sum of the three terms in GCRF [m/s2].

    x to vz: position [m] and velocity [m/s] in GCRF
    gm: the Earth's [m3/s2]
    axis: unit vector of the Earth's axis in GCRF
    precession: as in `de_sitter`
    """
    ax, ay, az = schwarzschild(x, y, z, vx, vy, vz, inverse_r, gm)
    bx, by, bz = lense_thirring(x, y, z, vx, vy, vz, inverse_r, gm, axis)
    cx, cy, cz = de_sitter(vx, vy, vz, precession)
    return ax + (bx + cx), ay + (by + cy), az + (bz + cz)


@compiled
def schwarzschild(x, y, z, vx, vy, vz, inverse_r, gm):
    """Return the acceleration by the Earth's mass; parameters as in `relativity`."""
    scale = (_PER_C2 * gm) * inverse_r * inverse_r * inverse_r
    outwards = scale * (4.0 * gm * inverse_r - (vx * vx + vy * vy + vz * vz))
    along = scale * (4.0 * (x * vx + y * vy + z * vz))
    return outwards * x + along * vx, outwards * y + along * vy, outwards * z + along * vz


@compiled
def lense_thirring(x, y, z, vx, vy, vz, inverse_r, gm, axis):
    """Return the acceleration by the Earth's rotation; parameters as in `relativity`."""
    i, j, k = axis[0], axis[1], axis[2]
    inverse_r2 = inverse_r * inverse_r
    scale = (2.0 * _PER_C2 * gm * EARTH_ANGULAR_MOMENTUM) * inverse_r2 * inverse_r
    up = 3.0 * inverse_r2 * (x * i + y * j + z * k)
    ax = up * (y * vz - z * vy) + (vy * k - vz * j)
    ay = up * (z * vx - x * vz) + (vz * i - vx * k)
    az = up * (x * vy - y * vx) + (vx * j - vy * i)
    return scale * ax, scale * ay, scale * az


@compiled
def de_sitter(vx, vy, vz, precession):
    """Return the acceleration by the Earth's orbit around the Sun.

    vx, vy, vz: velocity in GCRF [m/s]
    precession: vector by which a velocity turns [rad/s], twice the geodesic precession
    """
    i, j, k = precession[0], precession[1], precession[2]
    return j * vz - k * vy, k * vx - i * vz, i * vy - j * vx
