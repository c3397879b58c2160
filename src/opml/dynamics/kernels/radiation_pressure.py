"""Acceleration of a sphere by solar radiation pressure, with the shadow of the ellipsoidal Earth."""

import math

from opml.base.constants import SRP_DISTANCE, SRP_PRESSURE, SUN_RADIUS, WGS84_A, WGS84_F
from opml.dynamics.kernels.lanes import WIDTH, compiled, lanes_set, load, select, splat, sqrt, store

WGS84_B = WGS84_A * (1.0 - WGS84_F)  # polar radius of the WGS84 ellipsoid [m]
_CLEARANCE = 0.006  # tangent of an angle larger than the Sun's angular radius (0.0047)


@compiled
def radiation_pressure(x, y, z, sun, illumination, coefficient):
    """Return the acceleration [m/s2] away from the Sun, in the frame of the position (GCRF).

    sun: geocentric position of the Sun [m]
    illumination: part of the Sun's disc in sight
    coefficient: Cr times area over mass [m2/kg] (paper, sec. Truth Dynamic Models)
    """
    dx, dy, dz = x - sun[0], y - sun[1], z - sun[2]
    d2 = dx * dx + dy * dy + dz * dz
    factor = (SRP_PRESSURE * SRP_DISTANCE**2) * coefficient * illumination / (d2 * sqrt(d2))
    return factor * dx, factor * dy, factor * dz


@compiled
def illumination(x, y, z, r2, sun, scratch):
    """Return the part of the Sun's disc in sight, 0 to 1.

    r2: squared distance from the geocentre [m2]
    sun: position of the Sun in ITRF [m]
    scratch: four rows of lanes

    A few multiplications find most arcs clearly in light or in shadow. Only arcs near the edge of the shadow
    are computed, one by one.
    """
    distance = math.sqrt(sun[0] ** 2 + sun[1] ** 2 + sun[2] ** 2)
    ux, uy, uz = sun[0] / distance, sun[1] / distance, sun[2] / distance
    along = x * ux + y * uy + z * uz
    across2 = r2 - along * along
    behind = along < 0.0
    spread = _CLEARANCE * (-along)
    outer = WGS84_A + spread
    inner = WGS84_B - spread
    shaded = behind & (across2 < outer * outer)
    dark = shaded & (across2 < inner * inner) & (inner > 0.0)
    store(scratch, 0, x)
    store(scratch, 1, y)
    store(scratch, 2, z)
    store(scratch, 3, select(dark, splat(0.0), splat(1.0)))
    edge = lanes_set(shaded) & ~lanes_set(dark)
    if edge:
        for lane in range(WIDTH):
            if (edge >> lane) & 1:
                scratch[3, lane] = lit_part(scratch[0, lane], scratch[1, lane], scratch[2, lane], sun)
    return load(scratch, 3)


@compiled
def lit_part(x, y, z, sun):
    """Return the part of the Sun's disc in sight of a point, 0 to 1 (ITRF, m)."""
    separation, earth, disc = limb(x, y, z, sun)
    return part_in_sight(separation, earth, disc)


@compiled
def limb(x, y, z, sun):
    """Return the angle between Sun and Earth, and the angular radii of Earth and Sun [rad], from a point.

    x, y, z, sun: in ITRF [m]

    The Earth's radius is that of the ellipsoid's limb in the plane of point, geocentre and Sun.
    """
    tx, ty, tz = sun[0] - x, sun[1] - y, sun[2] - z
    to_sun = math.sqrt(tx * tx + ty * ty + tz * tz)
    lx, ly, lz = _limb_point(x, y, z, sun)
    separation = _angle(tx, ty, tz, -x, -y, -z)
    earth = _angle(lx - x, ly - y, lz - z, -x, -y, -z)
    return separation, earth, math.asin(SUN_RADIUS / to_sun)


@compiled
def part_in_sight(separation, earth, disc):
    """Return the part of the Sun's disc in sight, 0 to 1.

    separation, earth, disc: from `limb` [rad]

    The Sun's disc and the Earth's limb are circles on the sky (Montenbruck & Gill 2000, sec. 3.4.2, with
    the limb of the ellipsoid in place of the sphere's).
    """
    if separation >= earth + disc:
        return 1.0
    if separation <= earth - disc:
        return 0.0
    if separation <= disc - earth:
        return 1.0 - (earth / disc) ** 2
    # Two overlapping circles: the distance of their common chord from the Sun's centre, then areas.
    chord = (separation**2 + disc**2 - earth**2) / (2.0 * separation)
    half = math.sqrt(max(disc**2 - chord**2, 0.0))
    hidden = (
        disc**2 * math.acos(chord / disc)
        + earth**2 * math.acos((separation - chord) / earth)
        - separation * half
    )
    return 1.0 - hidden / (math.pi * disc**2)


@compiled
def _limb_point(x, y, z, sun):
    """Return the point of the ellipsoid on the tangent from a point outside, on the Sun's side.

    Stretching the polar axis turns the ellipsoid into a sphere and keeps planes and tangents.
    """
    scale = WGS84_A / WGS84_B
    px, py, pz = x, y, z * scale
    r = math.sqrt(px * px + py * py + pz * pz)
    ex, ey, ez = px / r, py / r, pz / r
    qx, qy, qz = sun[0], sun[1], sun[2] * scale
    inward = qx * ex + qy * ey + qz * ez
    nx, ny, nz = qx - inward * ex, qy - inward * ey, qz - inward * ez
    n = math.sqrt(nx * nx + ny * ny + nz * nz)
    near = WGS84_A * WGS84_A / r
    side = WGS84_A * math.sqrt(max(1.0 - (WGS84_A / r) ** 2, 0.0)) / max(n, 1e-300)
    return near * ex + side * nx, near * ey + side * ny, (near * ez + side * nz) / scale


@compiled
def _angle(ax, ay, az, bx, by, bz):
    """Return the angle between two vectors [rad], accurate for small angles, too."""
    cx, cy, cz = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
    return math.atan2(math.sqrt(cx * cx + cy * cy + cz * cz), ax * bx + ay * by + az * bz)
