"""Schemas of the tables of the environment, and their names."""

from opml.base.constants import BODIES
from opml.base.thermosphere_grid import ALTITUDES, DENSITIES
from opml.tables.columns import TIME, Schema, count, real

ENVIRONMENT = ("earth_orientation", "ephemerides", "solar_activity", "gravity_field")
"""Tables from which every force model is made."""

OUTLOOKS = "outlooks"  # table of forecast activity, where the assumed model knows forecasts only

THERMOSPHERE = "thermosphere"
"""Table of densities, where the truth is propagated through another atmosphere than DTM2000's."""

OPTIONAL = (OUTLOOKS, THERMOSPHERE)  # tables that only some force models need

_ACTIVITY = (
    real("f107", "sfu", "F10.7 solar radio flux of the day before"),
    real("f107_mean", "sfu", "F10.7 solar radio flux, 81-day mean"),
    real("kp_3h", "1", "geomagnetic index Kp, 3 hours"),
    real("kp_24h", "1", "geomagnetic index Kp, mean of 24 hours"),
)

ENVIRONMENT_SCHEMAS = (
    Schema(
        "earth_orientation",
        "a node of the environment's time grid",
        (
            TIME,
            real("x_cip", "rad", "x of the celestial intermediate pole, IERS corrections included", "GCRF"),
            real("y_cip", "rad", "y of the celestial intermediate pole, IERS corrections included", "GCRF"),
            real("s_cio", "rad", "CIO locator s"),
            real("x_pole", "rad", "x of polar motion", "ITRF"),
            real("y_pole", "rad", "y of polar motion", "ITRF"),
            real("era_offset", "rad", "Earth rotation angle, unwrapped, minus its conventional rate times t"),
        ),
    ),
    Schema(
        "ephemerides",
        "a node of the environment's time grid",
        (
            TIME,
            *(
                real(f"{body}_{axis}", "m", f"geocentric position of {body}, {axis}", "GCRF")
                for body in BODIES
                for axis in "xyz"
            ),
        ),
    ),
    Schema("solar_activity", "a node of the environment's time grid", (TIME, *_ACTIVITY)),
    Schema(
        OUTLOOKS,
        "a node of the environment's time grid as it was forecast at a time of issue before",
        (
            real("issued", "s", "when the forecast was made, in elapsed SI seconds since the epoch"),
            TIME,
            *_ACTIVITY,
        ),
    ),
    Schema(
        "futures",
        "a node of the environment's time grid, in one of the futures issued at an earlier time",
        (
            count("member", "number of the future, that of the most similar day first"),
            real("issued", "s", "when it was issued, in elapsed SI seconds since the epoch"),
            TIME,
            *_ACTIVITY,
        ),
    ),
    Schema(
        THERMOSPHERE,
        "a node of the environment's time grid, a local time and a latitude",
        (
            TIME,
            real("local_time", "rad", "mean local solar time, 0 at midnight"),
            real("latitude", "rad", "geodetic latitude", "ITRF"),
            *(
                real(name, "kg/m3", f"density at {altitude / 1e3:g} km")
                for name, altitude in zip(DENSITIES, ALTITUDES, strict=True)
            ),
        ),
    ),
    Schema(
        "gravity_field",
        "a degree and order of the Earth's field",
        (
            count("n", "degree"),
            count("m", "order"),
            real("c", "1", "fully normalised cosine coefficient at the epoch", "ITRF"),
            real("s", "1", "fully normalised sine coefficient at the epoch", "ITRF"),
        ),
    ),
)
