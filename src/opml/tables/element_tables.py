"""Schemas of tables of mean elements propagated by SGP4, and of what a catalogue of them teaches."""

from collections.abc import Sequence

from opml.tables.columns import SINCE, Schema, count, flag, real, text

ELEMENTS = ["mean_motion", "eccentricity", "inclination", "raan", "argp", "mean_anomaly", "bstar"]
"""Columns of the mean elements; a list, as pandas selects columns by a list."""

IMPROVED_MODELS = ("density", "learned")
"""What improves sets of mean elements: their drag, scaled by the density, and what a catalogue taught."""

IMPROVED_LEADS = (1, 3, 5, 7)  # days from the date to the errors that the table of improved sets expects

_FRAME = "TEME of the set's epoch"
_ALONG = "along the track"

_PREDICTION = (
    count("number", "catalogue number of the object"),
    real("morning", "d", "when the prediction was made, modified Julian day (UTC)"),
    count("lead", "days from the morning to what is predicted"),
    count("band", "number of the band of height"),
)

_SET = (
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
    real("t_created", "s", f"when the set was made, {SINCE}; NaN where the file does not state it"),
    text("file", "name of the file that the set was read from"),
    count("line", "line of the file where the set begins"),
)

ELEMENT_SCHEMAS = (
    Schema("element_sets", "a set of mean elements for SGP4, by object and epoch", _SET),
    Schema(
        "improved_history",
        "a set of an object as a model improved it when it became known, by model and epoch",
        (text("model", "what improved it: density or learned"), *_SET),
    ),
    Schema(
        "improved_sets",
        "an object, with the newest set of mean elements that was public on a date, improved",
        (
            count("number", "catalogue number of the object"),
            real("t", "d", "epoch of the set, modified Julian day (UTC)"),
            real("age", "d", "age of the set on the date"),
            real("height", "m", "mean height above the equatorial radius"),
            text("applied", "what counted most in it: learned, density or unchanged"),
            text("population", "population whose corrector that was, '' without one"),
            real("weight", "1", "part that it counted by the object's own past"),
            text("why", "why the object's past does not decide, '' where it does"),
            real("motion", "rad/min", "mean motion of the improved set"),
            real("bstar", "1/(6378.135 km)", "B* of the improved set"),
            real("motion_before", "rad/min", "mean motion of the set as published"),
            real("bstar_before", "1/(6378.135 km)", "B* of the set as published"),
            real("jump", "1", "how many times its usual distance the set misses those before it; or NaN"),
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
            text("quantity", "miss: the error subtracted; size: logarithm of the residual error's size"),
            count("tree", "number of the tree"),
            count("feature", "number of the feature asked, -1 at a leaf"),
            real("threshold", "1", "rows with a feature up to it go to the node `left`"),
            count("left", "row of that node in its part and quantity; at a leaf this row"),
            count("right", "row of the node for all others; at a leaf this row"),
            real("value", "1", "what a leaf adds, in scales or logarithms of these"),
        ),
    ),
    Schema(
        "expected_errors",
        "a lead of a prediction from element sets",
        (
            count("lead", "days from the date of the prediction"),
            text("utc", "time, UTC"),
            real("along_track", "m", "standard deviation of the prediction along the track"),
            real("radial", "m", "the same outwards"),
            real("cross_track", "m", "the same across"),
            real("sgp4_along_track", "m", "the same of SGP4 from the published set, along the track"),
        ),
    ),
    Schema(
        "catalogue_residuals",
        "a judged prediction of an object that was not learned from",
        (
            *_PREDICTION,
            real("error", "m", "SGP4 less the later set that judges", _ALONG),
            real("scaled", "m", "its residual error after the density-scaled prediction", _ALONG),
            real("learned", "m", "its residual error after the learned prediction", _ALONG),
            real("sigma", "m", "standard deviation of `learned`, NaN where nothing was learned", _ALONG),
            real("improved", "m", "its residual error with the improved set", _ALONG),
            real("improved_sigma", "m", "standard deviation of `improved`", _ALONG),
            text("applied", "what counted most in the improved set: learned, density, unchanged"),
        ),
    ),
    Schema(
        "catalogue_scores",
        "a band of height and a lead of a test, and a learner",
        (
            text("test", "name of the test"),
            text("learner", "name of the learner"),
            count("band", "number of the band of height, -1 for all of them"),
            count("lead", "days from the morning to what is predicted"),
            *(count(name, f"number of {name}") for name in ("predictions", "objects", "weeks")),
            real("sgp4_median", "m", "median error of SGP4", _ALONG),
            real("sgp4_p95", "m", "95th percentile of the error of SGP4", _ALONG),
            *(
                column
                for name in ("scaled", "learned", "improved")
                for column in (
                    real(f"{name}_median", "%", f"median error of the {name} prediction, of SGP4's"),
                    real(f"{name}_low", "%", f"2.5th percentile of {name}_median over weeks and objects"),
                    real(f"{name}_high", "%", f"97.5th percentile of {name}_median over weeks and objects"),
                    real(f"{name}_p95", "%", f"the same of the 95th percentile of the {name} prediction"),
                    real(f"{name}_p_ml", "%", f"P_ML of the {name} prediction"),
                )
            ),
            real("gain_median", "%", "median error of the learned prediction, of the scaled one's"),
            real("gain_low", "%", "2.5th percentile of gain_median over weeks and objects"),
            real("gain_high", "%", "97.5th percentile of gain_median over weeks and objects"),
            real("coverage", "%", "share of `learned` inside its intervals of 90 %, NaN without any"),
            real("improved_coverage", "%", "the same of `improved`"),
            real("worst_week", "%", "the least of improved_coverage in a week"),
            real("log_score", "1", "mean of ln(sigma / 1 m) + (improved / sigma)^2 / 2, 5 sigma at most"),
            real("unchanged", "%", "share of the predictions whose set stays as it was published"),
        ),
    ),
)


def catalogue_densities_schema(heights: Sequence[str]) -> Schema:
    """Return the schema of mean densities, by the names of the columns of the heights."""
    return Schema(
        "catalogue_densities",
        "a quarter of a day",
        (
            real("t", "d", "begin of the quarter, modified Julian day (UTC)"),
            *(
                real(name, "ln kg/m3", "logarithm of the density of NRLMSIS at a height, mean over the globe")
                for name in heights
            ),
        ),
    )


def catalogue_rows_schema(features: Sequence[str]) -> Schema:
    """Return the schema of rows to learn from, by the names of their features."""
    return Schema(
        "catalogue_rows",
        "a judged prediction of an object on a morning",
        (
            *_PREDICTION,
            real("judged", "d", "when the set that judges was public, modified Julian day (UTC)"),
            real("error", "m", "SGP4 less the later set that judges", _ALONG),
            real("density", "m", "what the density-scaled prediction takes off it", _ALONG),
            real("scale", "m", "unit of distances: the drag's own displacement and 30 m a day", _ALONG),
            real("missed", "1", "largest distance of the newest set from those before it, in scales"),
            real("response", "m 6378.135 km", "what a change of B* does", _ALONG),
            real("bstar", "1/(6378.135 km)", "B* of the newest set"),
            real("target", "1", "what is to be learned, in scales"),
            *(real(name, "1", "feature of the corrector") for name in features),
        ),
    )
