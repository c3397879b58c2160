"""Schemas of the tables from the dataset to P_ML."""

from opml.tables.catalog_tables import LABEL_COLUMNS, LABELLED
from opml.tables.columns import ERRORS, NO_TRUTH, PAIR, SINCE, Schema, count, flag, real, state_columns, text

PLANE, ELLIPSOID, WHOLE = "plane", "ellipsoid", "state"
"""Quantities of a calibration with several components: e_x and e_y, the position, the whole state."""

LEVELS = (0.1, 0.25, 0.5, 0.75, 0.9, 0.95, 0.99)  # levels of the stated uncertainties

_ELEMENTS = (
    ("a", "m", "semi-major axis"),
    ("e", "1", "eccentricity"),
    ("i", "rad", "inclination"),
    ("argp", "rad", "argument of perigee"),
    ("raan", "rad", "right ascension of the ascending node"),
    ("nu", "rad", "true anomaly"),
)

# The estimate's inclination cannot be `i`, which is the index of the estimate.
_ABSOLUTE = {"i": "inc"}

LEARNING_COLUMNS = (
    real("duration", "s", "prediction duration t_j - t_i"),
    *(
        real(f"d_{name}", unit, f"{meaning}: predicted to t_i from t_b minus estimated at t_i", "GCRF")
        for name, unit, meaning in _ELEMENTS
    ),
    *state_columns(
        "RSW of the estimate at t_i", "state predicted to t_i from t_b minus estimate", prefix="eps_"
    ),
    *(
        real(_ABSOLUTE.get(name, name), unit, f"{meaning} of the estimate at t_i", "GCRF")
        for name, unit, meaning in _ELEMENTS
    ),
    real("cd_b", "1", "drag coefficient estimated at t_b"),
    real("d_cd", "1", "drag coefficient estimated at t_b minus at t_i"),
    real("elevation_max", "rad", "highest measured elevation of the track at t_i", "topocentric"),
    real("azimuth_at_max", "rad", "azimuth of that measurement, from north eastwards", "topocentric"),
    real("range_at_max", "m", "range of that measurement", "topocentric"),
)

LEARNING_VARIABLES = tuple(column.name for column in LEARNING_COLUMNS)

_EVALUATION = (
    *PAIR,
    real("duration", "s", "prediction duration t_j - t_i"),
    real("true", "SI", "true prediction error of the component (m or m/s)", "RSW"),
    real("predicted", "SI", "error predicted by the model (m or m/s)", "RSW"),
    real("residual", "SI", "true minus predicted error (m or m/s)", "RSW"),
)

_SPLIT = (
    text("rso", "RSO, or pool of RSOs, the model was trained on"),
    text(
        "stations",
        "station set, then noise seed, window and interpretation of t_b where they differ from the settings, "
        "and reference of the errors where it is not the truth",
    ),
    text("train", "training split, then its seed where it differs from the settings"),
    text("learner", "learner"),
    text("component", "error component"),
    text("target", "RSO the model is applied to"),
    text("test", "rows the model is applied to"),
)

_DATASET = (
    *PAIR,
    count("b", "track of the earlier estimate, -1 where there is none"),
    real("t_i", "s", f"epoch of the estimate, {SINCE}"),
    real("t_j", "s", f"epoch predicted to, {SINCE}"),
    real("t_b", "s", f"epoch of the earlier estimate, {SINCE}"),
    real("gap", "s", "time between the two estimates, t_i - t_b"),
    *LEARNING_COLUMNS,
)

_KEPT = (
    flag("keep", "whether the row survived cleaning"),
    text("reason", "why the row was dropped, empty where it was kept"),
)

LEARNING_SCHEMAS = (
    Schema(
        "dataset",
        f"a pair of an estimate i and a later track start j, before cleaning{NO_TRUTH}",
        (*_DATASET, *ERRORS, *_KEPT),
    ),
    Schema(
        "labelled",
        "a pair of an estimate i and a later track start j, before cleaning, with a catalogue's errors",
        (*_DATASET, *LABEL_COLUMNS, *LABELLED, *_KEPT),
    ),
    Schema("evaluation", "a pair of an estimate i and a later track start j", _EVALUATION),
    Schema(
        "rolling",
        "a pair of an estimate i and a later track start j",
        (
            *_EVALUATION,
            real("day", "d", "when the model was trained, days since the epoch"),
            count("trained", "rows that it was trained on"),
            real("predicted_once", "SI", "error predicted by the model of the first day (m or m/s)", "RSW"),
        ),
    ),
    Schema(
        "intervals",
        "a pair of an estimate i and a later track start j",
        (*_EVALUATION, real("half_width", "SI", "half the prediction interval's width (m or m/s)", "RSW")),
    ),
    Schema(
        "coverage",
        "an experiment",
        (
            *_SPLIT,
            real(
                "level", "1", "nominal share of an estimate's rows inside the intervals, mean over estimates"
            ),
            real("rows_inside", "1", "share of all rows inside"),
            real("estimates_inside", "1", "share of each estimate's rows inside, mean over estimates"),
            real("half_width", "SI", "median half width (m or m/s)", "RSW"),
            real("half_width_last_day", "SI", "median half width in the last day of durations", "RSW"),
            real("error_last_day", "SI", "median absolute true error in the last day of durations", "RSW"),
        ),
    ),
    Schema(
        "calibration",
        "a quantity, a prediction duration and a level of an experiment",
        (
            *_SPLIT,
            text("quantity", "e_x, e_y, e_z, the plane of the first two, the ellipsoid of all three"),
            real("day", "d", "prediction duration"),
            count("rows", "rows of about that duration, six hours to either side"),
            real("level", "1", "nominal share of the rows inside"),
            real("inside", "1", "share of the rows inside"),
            real(
                "stated",
                "SI",
                "median half width (m); of several components the quantile of chi-square at the level",
                "RSW",
            ),
            real(
                "found",
                "SI",
                "size that the share `level` of the errors stay below (m); of several components that of "
                "their squared Mahalanobis distances",
                "RSW",
            ),
        ),
    ),
    Schema(
        "conjunctions",
        "a model, a covariance, a prediction duration and an angle",
        (
            text(
                "model",
                "that predicts: none, sgp4, fit96, the best without learning, the one selected each day",
            ),
            text("covariance", "that it goes with: the fit's own, or of past errors"),
            text("weather", "that the predictions knew: forecast, observed, monthly or as in the file"),
            real("day", "d", "prediction duration"),
            text("crossing", "angle between the directions of both objects [deg]: any, or a range"),
            real("flagged", "1", "share of the collisions that raise an alarm"),
            real("alarms", "1", "alarms that are raised per collision"),
            real("per_approach", "1", "alarms that are raised per approach within a kilometre"),
            count("predictions", "of about that duration, half a day to either side"),
        ),
    ),
    Schema(
        "metrics",
        "an experiment",
        (
            *_SPLIT,
            count("seed_noise", "seed of the measurement noise"),
            count("seed_split", "seed of the training split, the learner's draws and the resampling"),
            real("kernel_scale", "1", "kernel scale of the model, also where a rule chose it; else NaN"),
            count("rows", "rows evaluated"),
            count("estimates", "distinct estimates among them"),
            real("p_ml", "%", "performance metric P_ML"),
            real("p_ml_low", "%", "5th percentile of P_ML over resampled estimates"),
            real("p_ml_high", "%", "95th percentile of P_ML over resampled estimates"),
            real("fraction_reduced", "1", "fraction of rows whose error the model reduces"),
            real("p_ml_later", "%", "P_ML of the same rows against later estimates; NaN of a truth's label"),
            real("last_before", "SI", "mean absolute error of the longest half day of durations"),
            real("last_after", "SI", "mean absolute residual error of the same rows"),
        ),
    ),
)
