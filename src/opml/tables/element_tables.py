"""Schema of the table of mean elements flown by SGP4."""

from opml.tables.columns import SINCE, Schema, count, flag, real, text

ELEMENTS = ["mean_motion", "eccentricity", "inclination", "raan", "argp", "mean_anomaly", "bstar"]
"""Columns of the mean elements; a list, as pandas selects columns by a list."""

_FRAME = "TEME of the set's epoch"

ELEMENT_SCHEMAS = (
    Schema(
        "element_sets",
        "a set of mean elements for SGP4, by object and epoch",
        (
            count("number", "catalogue number of the object"),
            real("t", "s", f"epoch of the set, {SINCE}"),
            real("mean_motion", "rad/s", "mean motion of the set (Kozai's)"),
            real("eccentricity", "1", "mean eccentricity"),
            real("inclination", "rad", "mean inclination", _FRAME),
            real("raan", "rad", "mean right ascension of the ascending node", _FRAME),
            real("argp", "rad", "mean argument of perigee", _FRAME),
            real("mean_anomaly", "rad", "mean anomaly"),
            real("bstar", "1/(6378.135 km)", "drag term B*"),
            flag("is_deep", "whether its period is 225 minutes or more, where SGP4 adds Sun and Moon"),
            real("t_created", "s", f"when the set was made, {SINCE}; NaN where the file does not tell"),
            text("file", "name of the file that the set was read from"),
            count("line", "line of the file where the set begins"),
        ),
    ),
)
