"""Schema of the table of mean elements flown by SGP4."""

from opml.tables.columns import SINCE, Schema, count, flag, real, text

ELEMENTS = ["mean_motion", "eccentricity", "inclination", "raan", "argp", "mean_anomaly", "bstar"]
"""Columns of the mean elements; a list, as pandas selects columns by a list."""

IMPROVED_LEADS = (1, 3, 5, 7)
"""Days from the date to the errors that the table of improved sets expects."""

_FRAME = "TEME of the set's epoch"
_ALONG = "along the track"

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
    Schema(
        "improved_sets",
        "an object, with the newest set of mean elements that was public on a date, improved",
        (
            count("number", "catalogue number of the object"),
            real("t", "d", "epoch of the set, modified Julian day (UTC)"),
            real("age", "d", "age of the set on the date"),
            real("height", "m", "mean height above the equatorial radius"),
            text("applied", "what improved the set: learned, density or unchanged"),
            text("population", "population whose corrector was applied, '' without one"),
            text("why", "why the object's own past did not choose, '' where it did"),
            real("motion", "rad/min", "mean motion of the improved set"),
            real("bstar", "1/(6378.135 km)", "B* of the improved set"),
            real("motion_before", "rad/min", "mean motion of the set as published"),
            real("bstar_before", "1/(6378.135 km)", "B* of the set as published"),
            *(
                column
                for lead in IMPROVED_LEADS
                for column in (
                    real(f"sgp4_{lead}d", "m", f"expected error of SGP4 {lead} d after the date", _ALONG),
                    real(
                        f"sigma_{lead}d", "m", f"the same of the improved set {lead} d after the date", _ALONG
                    ),
                )
            ),
        ),
    ),
    Schema(
        "corrector",
        "a node of a tree of a trained model",
        (
            count("part", "number of the part of the catalogue, see the metadata"),
            text("quantity", "miss: what is taken off; size: logarithm of the size of what is left"),
            count("tree", "number of the tree"),
            count("feature", "number of the feature asked, -1 at a leaf"),
            real("threshold", "1", "the branch is the left one where the feature is not above it"),
            count("left", "row of the left node in its part and quantity, its own at a leaf"),
            count("right", "row of the right node in its part and quantity, its own at a leaf"),
            real("value", "1", "what a leaf adds, in scales or logarithms of these"),
        ),
    ),
)
