"""The tables that pass from stage to stage: their columns, and how they are written to and read from Parquet.

Every column carries its unit, frame and meaning as Parquet field metadata. Pages carry checksums and the
footer a SHA-256 digest of its own text, so that a damaged file is noticed by its reader. The tables of
trained models are declared by their learners, in opml.learning.
"""

import hashlib
import json
import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, BinaryIO

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq

from opml.constants import BODIES
from opml.errors import InputError
from opml.files import FilePath, replacing
from opml.thermosphere import ALTITUDES, DENSITIES

ENVIRONMENT = ("earth_orientation", "ephemerides", "solar_activity", "gravity_field")
"""The tables of the environment, which the force models are made of."""

OUTLOOKS = "outlooks"
"""One more, where the assumed model forecasts the activity."""

THERMOSPHERE = "thermosphere"
"""One more, where the truth flies through another atmosphere than DTM2000's."""

OPTIONAL = (OUTLOOKS, THERMOSPHERE)
"""The tables of an environment that some force models do without."""

FLIGHTS = "flights"
"""The tables of which truths one job made."""

STATE = ["x", "y", "z", "vx", "vy", "vz"]
"""Columns of a state; a list, so that a DataFrame takes it as it is."""

COMPONENTS = tuple(f"e_{axis}" for axis in STATE)
PARAMETERS = [*STATE, "cd"]
"""Columns of what is estimated."""

PLANE, ELLIPSOID, WHOLE = "plane", "ellipsoid", "state"
"""Quantities of a calibration that are several components together: e_x and e_y, the position, all six."""

LEVELS = (0.1, 0.25, 0.5, 0.75, 0.9, 0.95, 0.99)
"""Levels that uncertainties are stated at."""

DOUBT = [f"doubt_{axis}" for axis in "xyz"]
"""Columns of how far a state may be off that an ephemeris is held against."""

SPREAD = [f"{cause}_{axis}" for cause in ("drag", "weather") for axis in "xyz"]
"""Columns of how far drag and the weather ahead may take a prediction."""

POSITION_COVARIANCES = [f"cov_{a}_{b}" for a, b in (*("xx", "yx", "yy"), *("zx", "zy", "zz"))]
"""Columns of the lower triangle, row by row, of a position's covariance."""

_ARROW = {"float64": pa.float64(), "int64": pa.int64(), "bool": pa.bool_(), "string": pa.string()}


@dataclass(frozen=True)
class Column:
    """One column; `frame` is '' where no frame applies."""

    name: str
    dtype: str
    unit: str
    frame: str
    meaning: str


@dataclass(frozen=True)
class Schema:
    """A table: what one row is, and its columns in order."""

    name: str
    row: str
    columns: tuple[Column, ...]

    @property
    def names(self) -> list[str]:
        """Return the columns' names in order."""
        return [column.name for column in self.columns]


def real(name: str, unit: str, meaning: str, frame: str = "") -> Column:
    """Return a column of floating point numbers."""
    return Column(name, "float64", unit, frame, meaning)


def count(name: str, meaning: str) -> Column:
    """Return a column of whole numbers."""
    return Column(name, "int64", "1", "", meaning)


def text(name: str, meaning: str) -> Column:
    """Return a column of texts."""
    return Column(name, "string", "", "", meaning)


def flag(name: str, meaning: str) -> Column:
    """Return a column of yes or no."""
    return Column(name, "bool", "", "", meaning)


def _unit(parameter: str) -> str:
    return "1" if parameter == "cd" else "m/s" if parameter.startswith("v") else "m"


def _state(frame: str, meaning: str, *, prefix: str = "", suffix: str = "") -> tuple[Column, ...]:
    """Return six columns of position and velocity."""
    return tuple(real(f"{prefix}{axis}{suffix}", _unit(axis), f"{meaning}, {axis}", frame) for axis in STATE)


def _covariance(parameters: Sequence[str], frame: str) -> tuple[Column, ...]:
    """Return the lower triangle, row by row, of the covariance of parameters."""
    columns = []
    for row, a in enumerate(parameters):
        for b in parameters[: row + 1]:
            units = [unit for unit in (_unit(a), _unit(b)) if unit != "1"]
            columns.append(real(f"cov_{a}_{b}", " ".join(units) or "1", f"covariance of {a} and {b}", frame))
    return tuple(columns)


_SINCE = "elapsed SI seconds since the epoch"
_T = real("t", "s", _SINCE)

_KNOWN_STATE = "RSW of the state that it is held against"
_SPREAD = (
    *(real(f"drag_{axis}", "m", f"how far a tenth more drag takes it, {axis}", "RSW") for axis in "xyz"),
    *(
        real(f"weather_{axis}", "m", f"root mean square distance of the weather's futures, {axis}", "RSW")
        for axis in "xyz"
    ),
)

_ACTIVITY = (
    real("f107", "sfu", "F10.7 solar radio flux of the day before"),
    real("f107_mean", "sfu", "F10.7 solar radio flux, 81-day mean"),
    real("kp_3h", "1", "geomagnetic index Kp, 3 hours"),
    real("kp_24h", "1", "geomagnetic index Kp, mean of 24 hours"),
)
_ELEMENTS = (
    ("a", "m", "semi-major axis"),
    ("e", "1", "eccentricity"),
    ("i", "rad", "inclination"),
    ("argp", "rad", "argument of perigee"),
    ("raan", "rad", "right ascension of the ascending node"),
    ("nu", "rad", "true anomaly"),
)
# The estimate's own elements, where `i` would clash with the index of the estimate.
_ABSOLUTE = {"i": "inc"}

LEARNING_COLUMNS = (
    real("duration", "s", "prediction duration t_j - t_i"),
    *(
        real(f"d_{name}", unit, f"{meaning}: predicted to t_i from t_b minus estimated at t_i", "GCRF")
        for name, unit, meaning in _ELEMENTS
    ),
    *_state("RSW of the estimate at t_i", "state predicted to t_i from t_b minus estimate", prefix="eps_"),
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

_ERRORS = _state("RSW of the true state at t_j", "predicted minus true state at t_j", prefix="e_")
_PAIR = (
    count("i", "track of the estimate the prediction starts from"),
    count("j", "track whose start is predicted"),
)
SIGMA_STATE = [f"sigma_{name}" for name in STATE]
"""Columns of the standard deviations that a covariance is made of (`rsw_covariance.stated`)."""

SIGMAS = [f"sigma_{name}" for name in COMPONENTS]
"""Columns of a label's uncertainty, by error component."""

_HELD_AGAINST = "RSW of the later estimate at t_j"
_LABELS = _state(_HELD_AGAINST, "predicted state minus later estimate at t_j", prefix="e_")
_LABELLED = (
    *_state(_HELD_AGAINST, "formal standard deviation of the estimate at t_j", prefix="sigma_e_"),
    real("t_known", "s", f"end of the last track that the later estimate is made of, {_SINCE}"),
)
_PREDICTED = "RSW of the predicted state at t_j"
_SENSITIVITIES = (
    real("cd_mean", "1", "running mean of the drag coefficients estimated up to t_i"),
    *_state(_PREDICTED, "change of the prediction per unit of Cd, state at t_i held", prefix="s_"),
    *_state(
        _PREDICTED,
        "change per unit of Cd, state at t_i moved with Cd along the fit's covariance",
        prefix="v_",
    ),
    *_state(_PREDICTED, "prediction minus the one repeated with cd_mean", prefix="r_"),
)
_MECHANISM = (
    real("cd", "1", "drag coefficient estimated at t_i"),
    *_SENSITIVITIES,
    real("cd_long", "1", "drag coefficient of the long arc that ends at t_i"),
    real("d_cd_long", "1", "cd_long minus the running mean of the long arcs' drag coefficients"),
    *_state(_PREDICTED, "prediction minus the one from the long arc", prefix="l_"),
    *_state(_PREDICTED, "as v, for the prediction from the long arc", prefix="v_long_"),
)
_ARCS = (
    real("cd_arc", "1", "drag coefficient of the arc that ends at t_i"),
    real(
        "cd_past", "1", "mean of the arcs' drag coefficients up to t_i, weighted by 1/variance, with memory"
    ),
    *_state(_PREDICTED, "prediction minus that of the arc", prefix="l_arc_"),
    *_state(
        _PREDICTED, "change of the arc's prediction per unit of Cd along its covariance", prefix="v_arc_"
    ),
    *_state(_PREDICTED, "prediction minus that of the arc with Cd held by its past", prefix="h_arc_"),
)
_THERMOMETER = (
    real(
        "factor", "1", "logarithm of the density over the assumed one in the step of t_i, but for a constant"
    ),
    real("cd_window", "1", "drag coefficient of the arc's window, as the catalogue's fits together have it"),
    real("cd_ahead", "1", "drag coefficient from t_i on that makes up for what the factor did and will do"),
    *_state(_PREDICTED, "prediction minus that of the arc with these", prefix="thermo_"),
)
MECHANISM_AXES = ("s", "v", "r", "l", "v_long", "floor", "l_arc", "v_arc", "h_arc", "thermo")
"""Families of columns of the mechanism, with one column per error component: of `v`, `v_y` is for e_y."""

_EVALUATION = (
    *_PAIR,
    real("duration", "s", "prediction duration t_j - t_i"),
    real("true", "SI", "true prediction error of the component (m or m/s)", "RSW"),
    real("predicted", "SI", "error predicted by the model (m or m/s)", "RSW"),
    real("residual", "SI", "true minus predicted error (m or m/s)", "RSW"),
)
_SPLIT = (
    text("rso", "RSO, or pool of RSOs, the model was trained on"),
    text(
        "stations",
        "station set, then noise seed, window and reading of t_b where they differ from the settings, and "
        "what errors are held against where it is not the truth",
    ),
    text("train", "training split, then its seed where it differs from the settings"),
    text("learner", "learner"),
    text("component", "error component"),
    text("target", "RSO the model is applied to"),
    text("test", "rows the model is applied to"),
)


def mechanism_schema(resonances: Sequence[tuple[int, int]]) -> Schema:
    """Return the schema of the mechanism with the resonances (k, m) chosen."""
    meaning = "along-track drift per unit of an acceleration as the {part} of {k} (w + M) + {m} (W - theta)"
    drifts = tuple(
        real(f"{name}_{k}_{m}", "s2", meaning.format(part=part, k=k, m=m))
        for k, m in resonances
        for name, part in (("cos", "cosine"), ("sin", "sine"))
    )
    row = "a pair of an estimate i and a later track start j"
    return Schema("mechanism", row, (*_PAIR, *_MECHANISM, *drifts))


_NO_TRUTH = "; NaN where there is no truth"

_DATASET = (
    *_PAIR,
    count("b", "track of the earlier estimate, -1 where there is none"),
    real("t_i", "s", f"epoch of the estimate, {_SINCE}"),
    real("t_j", "s", f"epoch predicted to, {_SINCE}"),
    real("t_b", "s", f"epoch of the earlier estimate, {_SINCE}"),
    real("gap", "s", "time between the two estimates, t_i - t_b"),
    *LEARNING_COLUMNS,
)
_KEPT = (
    flag("keep", "whether the row survived cleaning"),
    text("reason", "why the row was dropped, empty where it was kept"),
)


_TABLES = (
    Schema(
        "earth_orientation",
        "a node of the environment's time grid",
        (
            _T,
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
            _T,
            *(
                real(f"{body}_{axis}", "m", f"geocentric position of {body}, {axis}", "GCRF")
                for body in BODIES
                for axis in "xyz"
            ),
        ),
    ),
    Schema(
        "solar_activity",
        "a node of the environment's time grid",
        (_T, *_ACTIVITY),
    ),
    Schema(
        OUTLOOKS,
        "a node of the environment's time grid as it was forecast at a time of issue before",
        (
            real("issued", "s", "when the forecast was made, in elapsed SI seconds since the epoch"),
            _T,
            *_ACTIVITY,
        ),
    ),
    Schema(
        "futures",
        "a node of the environment's time grid, by one of the futures told at a time of issue before",
        (
            count("member", "number of the future, that of the most similar day first"),
            real("issued", "s", "when it was told, in elapsed SI seconds since the epoch"),
            _T,
            *_ACTIVITY,
        ),
    ),
    Schema(
        THERMOSPHERE,
        "a node of the environment's time grid, a local time and a latitude",
        (
            _T,
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
    Schema("truth", "an epoch of the tracking grid", (_T, *_state("GCRF", "true state"))),
    Schema(FLIGHTS, "an RSO of those whose truths one job made", (text("rso", "name"),)),
    Schema(
        "tracking",
        f"a measurement by one station{_NO_TRUTH}",
        (
            count("track", "number of the track, from 0"),
            _T,
            text("station", "station"),
            real("azimuth", "rad", "measured azimuth, from north eastwards", "topocentric"),
            real("elevation", "rad", "measured elevation", "topocentric"),
            real("range", "m", "measured range", "topocentric"),
            real("azimuth_true", "rad", "azimuth without noise, from north eastwards", "topocentric"),
            real("elevation_true", "rad", "elevation without noise", "topocentric"),
            real("range_true", "m", "range without noise", "topocentric"),
        ),
    ),
    Schema(
        "starts",
        "a track that was measured",
        (
            count("track", "number of the track"),
            real("t", "s", f"start of the track, {_SINCE}"),
            *_state("GCRF", "first orbit at the track's start, NaN where it does not last"),
            real("age", "s", "time between the track's start and the one that the orbit was known at"),
        ),
    ),
    Schema(
        "estimates",
        "a track",
        (
            count("track", "number of the track"),
            real("t", "s", f"start of the track, {_SINCE}"),
            *_state("GCRF", "estimated state at the track's start"),
            real("cd", "1", "estimated drag coefficient"),
            *_covariance(PARAMETERS, "GCRF"),
            count("iterations", "iterations of the least squares"),
            flag("converged", "whether the least squares converged"),
            text("reason", "why there is no usable estimate, empty where there is one"),
            count("tracks_used", "tracks within the estimation window"),
            count("measurements_used", "measurements within the estimation window"),
            real("weighted_rms", "1", "root mean square of the weighted residuals"),
        ),
    ),
    Schema(
        "predictions",
        f"a pair of an estimate i and a later track start j{_NO_TRUTH}",
        (
            *_PAIR,
            real("t_i", "s", f"epoch of the estimate, {_SINCE}"),
            real("t_j", "s", f"epoch predicted to, {_SINCE}"),
            *_state("GCRF", "predicted state at t_j"),
            *_state("GCRF", "true state at t_j", suffix="_true"),
            *_ERRORS,
            text("reason", "why there is no prediction (state and errors are NaN then), else empty"),
        ),
    ),
    Schema(
        "labels",
        "a pair of an estimate i and a later track start j",
        (
            *_PAIR,
            *_LABELS,
            *_LABELLED,
            text("reason", "why there is no label (its numbers are NaN then), else empty"),
        ),
    ),
    Schema(
        "dataset",
        f"a pair of an estimate i and a later track start j, before cleaning{_NO_TRUTH}",
        (*_DATASET, *_ERRORS, *_KEPT),
    ),
    Schema(
        "labelled",
        "a pair of an estimate i and a later track start j, before cleaning, with a catalogue's errors",
        (*_DATASET, *_LABELS, *_LABELLED, *_KEPT),
    ),
    Schema(
        "sensitivities",
        "a pair of an estimate i and a later track start j",
        (*_PAIR, *_SENSITIVITIES),
    ),
    Schema(
        "oracle",
        "a pair of an estimate i and a later track start j",
        (
            *_PAIR,
            real("drift", "m", "along-track error due to the error of the estimate's semi-major axis"),
            *_state(
                "RSW of the true state at t_j",
                "error of the prediction from the true state and Cd at t_i",
                prefix="floor_",
            ),
        ),
    ),
    mechanism_schema(((1, 15), (1, 16), (2, 31))),
    Schema(
        "covariances",
        "a pair of an estimate i and a later track start j",
        (
            *_PAIR,
            *(
                real(
                    name,
                    "m m",
                    "covariance of the fit at t_i, carried to t_j: "
                    + " and ".join(name.removeprefix("cov_").split("_")),
                    _PREDICTED,
                )
                for name in POSITION_COVARIANCES
            ),
        ),
    ),
    Schema("arcs", "a pair of an estimate i and a later track start j", (*_PAIR, *_ARCS)),
    Schema(
        "evaluation",
        "a pair of an estimate i and a later track start j",
        _EVALUATION,
    ),
    Schema("thermometer", "a pair of an estimate i and a later track start j", (*_PAIR, *_THERMOMETER)),
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
        "ensemble",
        "a pair of the predictions, and a future",
        (
            *_PAIR,
            count("member", "number of the future"),
            *(
                real(
                    f"d_{axis}", "m", f"prediction under the future minus the prediction, {axis}", _PREDICTED
                )
                for axis in "xyz"
            ),
        ),
    ),
    Schema(
        "fan",
        "a pair of the predictions",
        (
            *_PAIR,
            real("duration", "s", "prediction duration t_j - t_i"),
            real("e_y", "m", "true along-track error of the prediction", "RSW of the true state at t_j"),
            real("mean", "m", "mean of what the futures say of that error", _PREDICTED),
            real("sigma", "m", "their standard deviation", _PREDICTED),
            real("low", "m", "their lower quantile, at (1 - level) / 2", _PREDICTED),
            real("median", "m", "their median", _PREDICTED),
            real("high", "m", "their upper quantile", _PREDICTED),
            real("crps", "m", "continuous ranked probability score of the futures"),
        ),
    ),
    Schema(
        "scores",
        "a day of prediction durations, of the fans",
        (
            count("day", "prediction durations up to so many days, from the day before"),
            count("rows", "predictions"),
            real("inside", "1", "share of the errors from low to high"),
            real("width", "m", "mean distance from low to high"),
            real("crps", "m", "mean continuous ranked probability score"),
            real("error", "m", "mean absolute along-track error of the prediction itself"),
        ),
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
    Schema("spread", "a pair of an estimate i and a later track start j", (*_PAIR, *_SPREAD)),
    Schema(
        "replay",
        "a pair of an estimate i and a later track start j",
        (
            *_PAIR,
            real("t_i", "s", f"epoch of the estimate, {_SINCE}"),
            real("t_j", "s", f"epoch of the later track's start, {_SINCE}"),
            real("t_known", "s", f"when the error was known, {_SINCE}"),
            real("morning", "s", f"when what the ephemeris was made with was known, {_SINCE}"),
            real("duration", "s", "prediction duration t_j - t_i"),
            real("rate", "rad/s", "rate at which the position turns"),
            real("before", "m", "along-track error of the prediction before correction", _KNOWN_STATE),
            *_state(_KNOWN_STATE, "error of the ephemeris at t_j", prefix="e_"),
            *(
                real(name, "m", "standard deviation of that state, 0 of a truth", _KNOWN_STATE)
                for name in DOUBT
            ),
            *_SPREAD,
            *_state(
                "RSW of the ephemeris",
                "standard deviation stated that morning, of velocities beside positions; NaN without a past",
                prefix="sigma_",
            ),
        ),
    ),
    Schema(
        "corrected",
        "an epoch after an estimate",
        (
            count("i", "track of the estimate the ephemeris starts from"),
            real("t_i", "s", f"epoch of the estimate, {_SINCE}"),
            _T,
            *_state("GCRF", "corrected state"),
            *_state("GCRF", "predicted state, before correction", suffix="_predicted"),
            *_covariance(STATE, "RSW of the corrected state"),
        ),
    ),
    Schema(
        "forecast",
        "an epoch after an estimate",
        (
            count("i", "track of the estimate the ephemeris starts from"),
            real("t_i", "s", f"epoch of the estimate, {_SINCE}"),
            _T,
            *_state("GCRF", "predicted state"),
            *_covariance(STATE, "RSW of the predicted state"),
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
SCHEMAS: dict[str, Schema] = {schema.name: schema for schema in _TABLES}


def symmetric(table: pd.DataFrame, columns: Sequence[str]) -> np.ndarray:
    """Return matrices (n, k, k) from the columns of their lower triangles, row by row."""
    row, column = np.tril_indices(int(np.sqrt(2 * len(columns))))
    full = np.empty((len(table), row[-1] + 1, row[-1] + 1))
    full[:, row, column] = full[:, column, row] = table[list(columns)].to_numpy()
    return full


def write_table(
    path: FilePath, frame: pd.DataFrame, schema: str | Schema, *, metadata: Mapping[str, Any]
) -> None:
    """Write `frame` as Parquet, whole or not at all: a temporary file takes the name when it is complete.

    Parameters
    ----------
    frame : table with exactly the schema's columns, in any order.
    schema : name of a schema, or a schema (of a model, whose columns vary).
    metadata : JSON values kept in the file, such as epoch, seed and settings digest.

    Raises
    ------
    ValueError : where the columns are not the schema's.
    """
    schema = _resolve(schema)
    if set(frame.columns) != set(schema.names) or len(frame.columns) != len(schema.names):
        odd = sorted(set(frame.columns) ^ set(schema.names))
        raise ValueError(f"table {schema.name}: columns missing or not in the schema: {odd}")
    arrays = [_array(frame[column.name], column.dtype) for column in schema.columns]
    arrow = _arrow_schema(schema)
    values = {"table": schema.name, **metadata}
    values["digest"] = _footer_digest(arrow, values, len(frame))
    texts = {key: json.dumps(value, sort_keys=True, allow_nan=False) for key, value in sorted(values.items())}
    table = pa.table(arrays, schema=arrow.with_metadata(texts))

    with replacing(path) as temporary:
        pq.write_table(table, temporary, compression="zstd", write_statistics=False, write_page_checksum=True)
        _seal(temporary)


def read_table(path: FilePath, schema: str | Schema) -> pd.DataFrame:
    """Read a table and check it against its schema.

    Raises
    ------
    InputError : where the file is missing or damaged, or lacks a column or has it in another type.
    """
    schema = _resolve(schema)
    with _reading(path), pq.ParquetFile(path, page_checksum_verification=True) as file:
        for column in schema.columns:
            _check_column(path, file.schema_arrow, column, schema.name)
        _metadata(path, file)
        table = file.read(columns=schema.names, use_threads=False)
        if table.num_rows != file.metadata.num_rows:
            raise InputError(f"{path}: damaged, got {table.num_rows} of {file.metadata.num_rows} rows")
        return table.to_pandas()


def read_tables(paths: Iterable[FilePath], schema: str | Schema) -> pd.DataFrame:
    """Read tables of one schema below each other; errors as in `read_table`."""
    return pd.concat([read_table(path, schema) for path in paths], ignore_index=True)


def read_metadata(path: FilePath) -> dict[str, Any]:
    """Return what `write_table` was given as metadata.

    Raises
    ------
    InputError : where the file is missing or damaged.
    """
    with _reading(path), pq.ParquetFile(path) as file:
        values = _metadata(path, file)
    return {key: value for key, value in values.items() if key != "table"}


def read_kind(path: FilePath) -> str:
    """Return the name of the schema that a table was written by. Errors as in `read_metadata`."""
    with _reading(path), pq.ParquetFile(path) as file:
        return str(_metadata(path, file)["table"])


_PREAMBLE = """\
# Tables

Every table is a Parquet file, written once by one rule and read by the next. Units are SI, angles are in
radians. The file keeps each column's unit, frame and meaning (Arrow field metadata), and epoch, time scale,
seed, settings digest and version (file metadata, as JSON values). This page is written by
`python -m opml.learning.learners > docs/data.md`."""


def markdown(models: Iterable[Schema]) -> str:
    """Return the description of every table, as docs/data.md holds it; `models` are the models' tables."""
    tables = list(SCHEMAS.values())
    before = tables.index(SCHEMAS["evaluation"])
    lines = [_PREAMBLE]
    for schema in (*tables[:before], *models, *tables[before:]):
        lines += ["", f"## {schema.name}", "", f"One row is {schema.row}.", ""]
        lines += ["| column | type | unit | frame | meaning |", "| --- | --- | --- | --- | --- |"]
        lines += [_described(column) for column in schema.columns]
    return "\n".join(lines)


def _described(column: Column) -> str:
    cells = (f"`{column.name}`", column.dtype, column.unit or "-", column.frame or "-", column.meaning)
    return f"| {' | '.join(cells)} |"


def _resolve(schema: str | Schema) -> Schema:
    return SCHEMAS[schema] if isinstance(schema, str) else schema


def _array(values: pd.Series, dtype: str) -> pa.Array:
    if dtype == "string":
        return pa.array([str(value) for value in values], type=pa.string())
    # A numpy array keeps NaN a number; pandas' own conversion would make it a missing value.
    return pa.array(np.asarray(values).astype(dtype, casting="same_kind"), type=_ARROW[dtype])


def _arrow_schema(schema: Schema) -> pa.Schema:
    return pa.schema(
        pa.field(
            column.name,
            _ARROW[column.dtype],
            nullable=False,
            metadata={"unit": column.unit, "frame": column.frame, "meaning": column.meaning},
        )
        for column in schema.columns
    )


def _footer_digest(arrow: pa.Schema, values: Mapping[str, Any], rows: int) -> str:
    """Digest what the page checksums do not cover: names, types, units, metadata and the number of rows."""
    fields = [[field.name, str(field.type), _texts(field.metadata)] for field in arrow]
    text = json.dumps([fields, dict(values), rows], sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()


def _texts(metadata: Mapping[bytes, bytes] | None) -> dict[str, str]:
    # Arrow adds PARQUET:field_id on reading.
    items = (metadata or {}).items()
    return {key.decode(): value.decode() for key, value in items if not key.startswith(b"PARQUET:")}


_SEAL = b"opmlseal"
_DIGEST_BYTES = hashlib.sha256().digest_size
_TAIL_BYTES = 8  # of a Parquet file: the length of its footer and four letters


def _seal(path: FilePath) -> None:
    """Put a digest of the footer before it: where pages lie is told there, and no page's checksum covers it.

    Readers find the footer from the end of the file, and pages from its beginning: both stay where they are.
    """
    with open(path, "r+b") as file:
        start, footer = _footer(file)
        file.seek(start)
        file.write(_SEAL + hashlib.sha256(footer).digest() + footer)


def _check_seal(path: FilePath) -> None:
    """Raise InputError where a footer is not the one that was sealed; older versions sealed none."""
    with open(path, "rb") as file:
        start, footer = _footer(file)
        file.seek(max(start - len(_SEAL) - _DIGEST_BYTES, 0))
        seal = file.read(len(_SEAL) + _DIGEST_BYTES)
    if seal.startswith(_SEAL) and seal[len(_SEAL) :] != hashlib.sha256(footer).digest():
        raise InputError(f"{path}: damaged (its footer does not match its seal)")


def _footer(file: BinaryIO) -> tuple[int, bytes]:
    """Where a Parquet file's footer starts, as its length tells, and what follows from there."""
    end = file.seek(0, os.SEEK_END)
    file.seek(max(end - _TAIL_BYTES, 0))
    length = int.from_bytes(file.read(4), "little")
    start = max(end - _TAIL_BYTES - length, 0)
    file.seek(start)
    return start, file.read()


@contextmanager
def _reading(path: FilePath) -> Iterator[None]:
    """Turn what a missing or damaged file raises, wherever it is noticed, into one line."""
    try:
        _check_seal(path)
        yield
    except FileNotFoundError:
        raise InputError(f"{path}: no such file") from None
    except (pa.ArrowException, OSError, ValueError, KeyError) as error:
        raise InputError(f"{path}: damaged, or not a table in Parquet ({error})") from None


def _check_column(path: FilePath, arrow: pa.Schema, column: Column, table: str) -> None:
    if column.name not in arrow.names:
        raise InputError(f"{path}: {column.name}: column of table {table} is missing")
    dtype = arrow.field(column.name).type
    if dtype != _ARROW[column.dtype]:
        raise InputError(f"{path}: {column.name}: expected {column.dtype}, got {dtype}")


def _metadata(path: FilePath, file: pq.ParquetFile) -> dict[str, Any]:
    """Return the file's metadata, its digest checked; a table that `write_table` did not write has none."""
    values = {key: json.loads(value) for key, value in _texts(file.schema_arrow.metadata).items()}
    digest = values.pop("digest", None)
    if digest != _footer_digest(file.schema_arrow, values, file.metadata.num_rows):
        raise InputError(f"{path}: damaged, or not written by opml (its footer does not match its digest)")
    return values
