"""Acceleration of arcs under a force model, the sum of all forces, and the density along them."""

from opml.dynamics.kernels import dtm2000
from opml.dynamics.kernels.added_forces import FORCES, sum_of
from opml.dynamics.kernels.drag import drag
from opml.dynamics.kernels.geodetic import geodetic
from opml.dynamics.kernels.gravity import gravity
from opml.dynamics.kernels.lanes import compiled, select, sqrt
from opml.dynamics.kernels.radiation_pressure import illumination, radiation_pressure
from opml.dynamics.kernels.surroundings import BODIES, ROTATION, SPIN, SUN_ITRF
from opml.dynamics.kernels.third_body import third_bodies

_with_added = sum_of(FORCES.values())

SCRATCH_ROWS = 40  # rows of lanes that `acceleration` needs for intermediate results


@compiled
def acceleration(x, y, z, vx, vy, vz, ballistic, reflection, kind, model, values, factors, scratch):
    """Return ax, ay, az in GCRF [m/s2], geodetic altitude [m] and the part of the Sun in sight.

    x to vz: position [m] and velocity [m/s] in GCRF
    ballistic: Cd times area over mass [m2/kg]
    reflection: Cr times area over mass [m2/kg]
    kind: of the model's activity that an arc is propagated under
    values, factors: from `surroundings.look_up` at the same time
    """
    r = values[ROTATION : ROTATION + 9]
    r2 = x * x + y * y + z * z
    inverse_r = 1.0 / sqrt(r2)
    px = r[0] * x + r[1] * y + r[2] * z
    py = r[3] * x + r[4] * y + r[5] * z
    pz = r[6] * x + r[7] * y + r[8] * z
    gx, gy, gz = gravity(
        px, py, pz, inverse_r, model.weights, model.columns, model.degree, model.gm, model.radius
    )
    central = -model.gm * inverse_r * inverse_r * inverse_r
    ax = central * x + (r[0] * gx + r[3] * gy + r[6] * gz)
    ay = central * y + (r[1] * gx + r[4] * gy + r[7] * gz)
    az = central * z + (r[2] * gx + r[5] * gy + r[8] * gz)

    bx, by, bz = third_bodies(x, y, z, values[BODIES:], model.gms, model.gms.shape[0])

    altitude, rho = density(px, py, pz, inverse_r, kind, model, values, factors, scratch)
    turning = (values[SPIN], values[SPIN + 1], values[SPIN + 2])
    dx, dy, dz = drag(x, y, z, vx, vy, vz, turning, rho, ballistic)

    lit = illumination(px, py, pz, r2, values[SUN_ITRF : SUN_ITRF + 3], scratch)
    sun = values[BODIES : BODIES + 3]
    sx, sy, sz = radiation_pressure(x, y, z, sun, lit, reflection)
    # The small ones first: next to the central acceleration each would lose its last digits.
    total = (ax + (bx + (dx + sx)), ay + (by + (dy + sy)), az + (bz + (dz + sz)))
    state = (x, y, z, vx, vy, vz, inverse_r)
    ax, ay, az = _with_added(state, reflection, model, values, total)
    return ax, ay, az, altitude, lit


@compiled
def density(px, py, pz, inverse_r, kind, model, values, factors, scratch):
    """Return geodetic altitude [m] and density [kg/m3], by DTM2000.

    px, py, pz: position in ITRF [m]
    kind, model, values, factors, scratch: as in `acceleration`
    """
    altitude, sin_lat, cos_lat, sin_lon, cos_lon = geodetic(px, py, pz, inverse_r)
    sun_x, sun_y = values[SUN_ITRF], values[SUN_ITRF + 1]
    norm = (sun_x * sun_x + sun_y * sun_y) ** -0.5
    # Local solar time from midnight, the meridian opposite to the Sun's.
    cos_time = -norm * (sun_x * cos_lon + sun_y * sin_lon)
    sin_time = -norm * (sun_x * sin_lon - sun_y * cos_lon)
    a = model.thermosphere
    rho = dtm2000.density(
        altitude, sin_lat, cos_lat, sin_lon, cos_lon, sin_time, cos_time, a, factors, scratch
    )
    for other in range(1, len(model.flown)):
        if model.flown[other]:
            of_other = dtm2000.density_again(altitude, a, factors[dtm2000.FACTORS * other :], scratch)
            rho = select(kind > other - 0.5, of_other, rho)
    return altitude, rho
