"""Geodetic altitude, latitude and longitude on the WGS84 ellipsoid, without trigonometry."""

from opml.base.constants import WGS84_A, WGS84_F
from opml.dynamics.kernels.lanes import compiled, select, splat, sqrt

_B = WGS84_A * (1.0 - WGS84_F)
_E2 = WGS84_F * (2.0 - WGS84_F)
_EP2 = _E2 / (1.0 - _E2)
_ON_AXIS = 1e-3  # distance from the polar axis [m] below which the longitude counts as 0


@compiled
def geodetic(x, y, z, inverse_r):
    """Return altitude [m], sine and cosine of the latitude, sine and cosine of the longitude.

    One iteration of Bowring's parametric latitude with his better start is good to a tenth of a micrometre in
    altitude for every orbit around the Earth (Bowring 1985, Survey Review 28, 202-206).
    """
    p = sqrt(x * x + y * y)
    off_axis = p > _ON_AXIS
    q = select(off_axis, p, splat(_ON_AXIS))
    # Parametric latitude u: tan u = (b z / a p) (1 + e'^2 b / r).
    rise = (1.0 - WGS84_F) * z * (1.0 + (_EP2 * _B) * inverse_r)
    norm = 1.0 / sqrt(rise * rise + q * q)
    sin_u, cos_u = rise * norm, q * norm
    up = z + (_EP2 * _B) * (sin_u * sin_u * sin_u)
    out = q - (_E2 * WGS84_A) * (cos_u * cos_u * cos_u)
    norm = 1.0 / sqrt(up * up + out * out)
    sin_lat, cos_lat = up * norm, out * norm
    altitude = q * cos_lat + z * sin_lat - WGS84_A * sqrt(1.0 - _E2 * sin_lat * sin_lat)
    inverse = 1.0 / q
    return altitude, sin_lat, cos_lat, y * inverse, select(off_axis, x * inverse, splat(1.0))
