"""A force model as the kernels read it, and the acceleration of arcs under it."""

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd

from opml.constants import BODIES, GM
from opml.dynamics import dtm2000, surroundings
from opml.dynamics.drag import drag
from opml.dynamics.frames import ORIENTATION, spin
from opml.dynamics.geodetic import geodetic
from opml.dynamics.gravity import gravity, weights
from opml.dynamics.lanes import compiled, sqrt
from opml.dynamics.radiation_pressure import illumination, radiation_pressure
from opml.dynamics.surroundings import ROTATION, SPIN, SUN_ITRF, Tables
from opml.dynamics.third_body import third_bodies
from opml.epochs import days_of_year

SCRATCH_ROWS = 40
"""Rows that `acceleration` needs to put intermediate lanes down."""

_ACTIVITY = ["f107", "f107_mean", "kp_3h", "kp_24h"]


def build(
    earth_orientation: pd.DataFrame,
    ephemerides: pd.DataFrame,
    solar_activity: pd.DataFrame,
    gravity_field: pd.DataFrame,
    *,
    epoch: str,
    degree: int,
    order: int,
    bodies: Sequence[str],
    gm: float,
    radius: float,
    gms: Mapping[str, float] = GM,
) -> Tables:
    """Tables of a force model, from the environment's tables.

    earth_orientation, ephemerides, solar_activity: DataFrames at the same uniform nodes;
    gravity_field: DataFrame n, m, c, s (fully normalised); epoch: UTC text; degree, order: of the
    field used; bodies: names of the third bodies that pull; gm [m3/s2], radius [m]: of the field;
    gms: of the bodies [m3/s2].
    """
    t = earth_orientation["t"].to_numpy()
    names = ["sun", *(name for name in BODIES if name in bodies and name != "sun")]
    columns = [f"{name}_{axis}" for name in names for axis in "xyz"]
    c, s = np.zeros((degree + 1, order + 1)), np.zeros((degree + 1, order + 1))
    used = gravity_field[(gravity_field["n"] <= degree) & (gravity_field["m"] <= order)]
    c[used["n"], used["m"]] = used["c"]
    s[used["n"], used["m"]] = used["s"]
    midnight, days = days_of_year(epoch, t[-1])
    thermosphere = dtm2000.coefficients()
    return Tables(
        first=float(t[0]),
        step=float(t[1] - t[0]),
        orientation=np.ascontiguousarray(earth_orientation[ORIENTATION].to_numpy(float)),
        spin=np.ascontiguousarray(spin(earth_orientation)),
        bodies=np.ascontiguousarray(ephemerides[columns].to_numpy(float)),
        gms=np.array([gms[name] if name in bodies else 0.0 for name in names]),
        activity=np.ascontiguousarray(solar_activity[_ACTIVITY].to_numpy(float)),
        midnight=float(midnight),
        seasons=np.ascontiguousarray(dtm2000.seasons(thermosphere, days)),
        thermosphere=thermosphere,
        weights=weights(c, s),
        columns=order + 2,
        degree=degree + 1,
        gm=float(gm),
        radius=float(radius),
    )


@compiled
def acceleration(x, y, z, vx, vy, vz, ballistic, reflection, tables, values, factors, scratch):
    """(ax, ay, az [m/s2], geodetic altitude [m]) of arcs in GCRF.

    x to vz: position [m] and velocity [m/s]; ballistic: Cd A/m, reflection: Cr A/m [m2/kg];
    values, factors: from `surroundings.look_up` at the same time; scratch: (SCRATCH_ROWS, WIDTH).
    """
    r = values[ROTATION : ROTATION + 9]
    r2 = x * x + y * y + z * z
    inverse_r = 1.0 / sqrt(r2)
    px = r[0] * x + r[1] * y + r[2] * z
    py = r[3] * x + r[4] * y + r[5] * z
    pz = r[6] * x + r[7] * y + r[8] * z
    gx, gy, gz = gravity(
        px, py, pz, r2, inverse_r, tables.weights, tables.columns, tables.degree, tables.gm, tables.radius
    )
    central = -tables.gm * inverse_r * inverse_r * inverse_r
    ax = central * x + (r[0] * gx + r[3] * gy + r[6] * gz)
    ay = central * y + (r[1] * gx + r[4] * gy + r[7] * gz)
    az = central * z + (r[2] * gx + r[5] * gy + r[8] * gz)

    bx, by, bz = third_bodies(x, y, z, values[surroundings.BODIES :], tables.gms, tables.gms.shape[0])

    altitude, rho = density(px, py, pz, inverse_r, tables, values, factors, scratch)
    turning = (values[SPIN], values[SPIN + 1], values[SPIN + 2])
    dx, dy, dz = drag(x, y, z, vx, vy, vz, turning, rho, ballistic)

    lit = illumination(px, py, pz, r2, values[SUN_ITRF : SUN_ITRF + 3], scratch)
    sun = values[surroundings.BODIES : surroundings.BODIES + 3]
    sx, sy, sz = radiation_pressure(x, y, z, sun, lit, reflection)
    return ax + (bx + (dx + sx)), ay + (by + (dy + sy)), az + (bz + (dz + sz)), altitude


@compiled
def density(px, py, pz, inverse_r, tables, values, factors, scratch):
    """(geodetic altitude [m], DTM2000 density [kg/m3]) at ITRF positions [m]."""
    altitude, sin_lat, cos_lat, sin_lon, cos_lon = geodetic(px, py, pz, inverse_r)
    sun_x, sun_y = values[SUN_ITRF], values[SUN_ITRF + 1]
    norm = (sun_x * sun_x + sun_y * sun_y) ** -0.5
    # Local solar time, counted from midnight: opposite the Sun's meridian.
    cos_time = -norm * (sun_x * cos_lon + sun_y * sin_lon)
    sin_time = -norm * (sun_x * sin_lon - sun_y * cos_lon)
    a = tables.thermosphere
    rho = dtm2000.density(
        altitude, sin_lat, cos_lat, sin_lon, cos_lon, sin_time, cos_time, a, factors, scratch
    )
    return altitude, rho
