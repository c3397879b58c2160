"""The tables that pass from stage to stage: their columns, and how they are written to and read from Parquet.

Every column carries its unit, frame and meaning as Parquet field metadata. Pages carry checksums and the
footer a SHA-256 digest of its own text, so that a damaged file is noticed by its reader.
``python -m opml.tables`` prints docs/data.md.
"""

import hashlib
import json
import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq

from opml.constants import BODIES
from opml.errors import InputError
from opml.files import replacing

ENVIRONMENT = ("earth_orientation", "ephemerides", "solar_activity", "gravity_field")
"""The tables of the environment, which the force models are made of."""

STATE = ("x", "y", "z", "vx", "vy", "vz")
COMPONENTS = tuple(f"e_{axis}" for axis in STATE)
PARAMETERS = (*STATE, "cd")

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


def _real(name: str, unit: str, meaning: str, frame: str = "") -> Column:
    return Column(name, "float64", unit, frame, meaning)


def _count(name: str, meaning: str) -> Column:
    return Column(name, "int64", "1", "", meaning)


def _text(name: str, meaning: str) -> Column:
    return Column(name, "string", "", "", meaning)


def _flag(name: str, meaning: str) -> Column:
    return Column(name, "bool", "", "", meaning)


def _unit(parameter: str) -> str:
    return "1" if parameter == "cd" else "m/s" if parameter.startswith("v") else "m"


def _state(frame: str, meaning: str, *, prefix: str = "", suffix: str = "") -> tuple[Column, ...]:
    """Return six columns of position and velocity."""
    return tuple(_real(f"{prefix}{axis}{suffix}", _unit(axis), f"{meaning}, {axis}", frame) for axis in STATE)


def _covariance() -> tuple[Column, ...]:
    """Return the lower triangle, row by row, of the covariance of position, velocity and drag coefficient."""
    columns = []
    for row, a in enumerate(PARAMETERS):
        for b in PARAMETERS[: row + 1]:
            units = [unit for unit in (_unit(a), _unit(b)) if unit != "1"]
            columns.append(
                _real(f"cov_{a}_{b}", " ".join(units) or "1", f"covariance of {a} and {b}", "GCRF")
            )
    return tuple(columns)


_SINCE = "elapsed SI seconds since the epoch"
_T = _real("t", "s", _SINCE)

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
    _real("duration", "s", "prediction duration t_j - t_i"),
    *(
        _real(f"d_{name}", unit, f"{meaning}: predicted to t_i from t_b minus estimated at t_i", "GCRF")
        for name, unit, meaning in _ELEMENTS
    ),
    *_state("RSW of the estimate at t_i", "state predicted to t_i from t_b minus estimate", prefix="eps_"),
    *(
        _real(_ABSOLUTE.get(name, name), unit, f"{meaning} of the estimate at t_i", "GCRF")
        for name, unit, meaning in _ELEMENTS
    ),
    _real("cd_b", "1", "drag coefficient estimated at t_b"),
    _real("d_cd", "1", "drag coefficient estimated at t_b minus at t_i"),
    _real("elevation_max", "rad", "highest measured elevation of the track at t_i", "topocentric"),
    _real("azimuth_at_max", "rad", "azimuth of that measurement, from north eastwards", "topocentric"),
    _real("range_at_max", "m", "range of that measurement", "topocentric"),
)
LEARNING_VARIABLES = tuple(column.name for column in LEARNING_COLUMNS)

_ERRORS = _state("RSW of the true state at t_j", "predicted minus true state at t_j", prefix="e_")
_PAIR = (
    _count("i", "track of the estimate the prediction starts from"),
    _count("j", "track whose start is predicted"),
)
_PREDICTED = "RSW of the predicted state at t_j"
_SENSITIVITIES = (
    _real("cd_mean", "1", "running mean of the drag coefficients estimated up to t_i"),
    *_state(_PREDICTED, "change of the prediction per unit of Cd, state at t_i held", prefix="s_"),
    *_state(_PREDICTED, "the same where the state moves along the fit's covariance", prefix="v_"),
    *_state(_PREDICTED, "prediction minus the one made again with cd_mean", prefix="r_"),
)
_MECHANISM = (
    _real("cd", "1", "drag coefficient estimated at t_i"),
    *_SENSITIVITIES,
    _real("cd_long", "1", "drag coefficient of the long arc that ends at t_i"),
    _real("d_cd_long", "1", "cd_long minus the running mean of the long arcs'"),
    *_state(_PREDICTED, "prediction minus that from the long arc", prefix="l_"),
    *_state(_PREDICTED, "as v, of the prediction from the long arc", prefix="v_long_"),
)
MECHANISM_AXES = ("s", "v", "r", "l", "v_long", "floor")
"""Families of columns of the mechanism, one an error component: `v` is `v_y` for e_y."""

_EVALUATION = (
    *_PAIR,
    _real("duration", "s", "prediction duration t_j - t_i"),
    _real("true", "SI", "true prediction error of the component (m or m/s)", "RSW"),
    _real("predicted", "SI", "error predicted by the model (m or m/s)", "RSW"),
    _real("residual", "SI", "true minus predicted error (m or m/s)", "RSW"),
)
_SPLIT = (
    _text("rso", "RSO, or pool of RSOs, the model was trained on"),
    _text("stations", "station set; seed of the noise, window and reading of t_b where not the settings'"),
    _text("train", "training split, with its seed where not the settings'"),
    _text("learner", "learner"),
    _text("component", "error component"),
    _text("target", "RSO the model is applied to"),
    _text("test", "rows the model is applied to"),
)


def mechanism_schema(resonances: Sequence[tuple[int, int]]) -> Schema:
    """Return the schema of the mechanism with the resonances (k, m) chosen."""
    meaning = "along-track drift per unit of an acceleration as the {part} of {k} (w + M) + {m} (W - theta)"
    drifts = tuple(
        _real(f"{name}_{k}_{m}", "s2", meaning.format(part=part, k=k, m=m))
        for k, m in resonances
        for name, part in (("cos", "cosine"), ("sin", "sine"))
    )
    row = "a pair of an estimate i and a later track start j"
    return Schema("mechanism", row, (*_PAIR, *_MECHANISM, *drifts))


def model_schema(variables: Sequence[str], kind: str = "svr") -> Schema:
    """Return the schema of a trained model of a kind over the chosen learning variables."""
    if kind in ("svr", "gaussian_process"):
        row, weight = _EXPANSIONS[kind]
        return Schema(f"model_{kind}", row, (weight, *(_standardised(name) for name in variables)))
    return Schema(f"model_{kind}", *_MODELS[kind])


def _standardised(variable: str) -> Column:
    return _real(variable, "1", f"{variable}, standardised")


_EXPANSIONS = {
    "svr": ("a support vector", _real("dual_coef", "1", "dual coefficient alpha - alpha*")),
    "gaussian_process": ("a row learned from", _real("weight", "1", "weight of the row's kernel")),
}
_MODELS: dict[str, tuple[str, tuple[Column, ...]]] = {
    "none": ("nothing: there is no number to keep", ()),
    "repredict": ("nothing: there is no number to keep", ()),
    "duration_mean": (
        "a bin of prediction durations",
        (
            _real("duration", "s", "mean duration of the bin's rows"),
            _real("mean", "SI", "their mean error (m or m/s)", "RSW"),
        ),
    ),
    "ridge": (
        "a learning variable",
        (
            _text("variable", "learning variable"),
            _real("x_mean", "SI", "its mean"),
            _real("x_scale", "SI", "its standard deviation"),
            _real("coefficient", "SI", "coefficient of the standardised variable (m or m/s)", "RSW"),
        ),
    ),
    "mechanism": (
        "a term of the linear law",
        (_text("term", "product of learning variables"), _real("coefficient", "SI", "its coefficient")),
    ),
    "boosting": (
        "a node of a regression tree",
        (
            _count("tree", "number of the tree"),
            _count("feature", "number of the learning variable asked, -1 at a leaf"),
            _real("threshold", "SI", "the branch is the left one where the variable is not above it"),
            _count("left", "row of the left node, its own at a leaf"),
            _count("right", "row of the right node, its own at a leaf"),
            _real("value", "SI", "what a leaf adds to the predicted error (m or m/s)", "RSW"),
        ),
    ),
    "mlp": (
        "a weight",
        (
            _count("layer", "number of the layer"),
            _count("source", "neuron of the layer before, -1 for the constant 1"),
            _count("neuron", "neuron of the layer"),
            _real("weight", "1", "weight"),
        ),
    ),
}


_TABLES = (
    Schema(
        "earth_orientation",
        "a node of the environment's time grid",
        (
            _T,
            _real("x_cip", "rad", "x of the celestial intermediate pole, IERS corrections included", "GCRF"),
            _real("y_cip", "rad", "y of the celestial intermediate pole, IERS corrections included", "GCRF"),
            _real("s_cio", "rad", "CIO locator s"),
            _real("x_pole", "rad", "x of polar motion", "ITRF"),
            _real("y_pole", "rad", "y of polar motion", "ITRF"),
            _real(
                "era_offset", "rad", "Earth rotation angle, unwrapped, minus its conventional rate times t"
            ),
        ),
    ),
    Schema(
        "ephemerides",
        "a node of the environment's time grid",
        (
            _T,
            *(
                _real(f"{body}_{axis}", "m", f"geocentric position of {body}, {axis}", "GCRF")
                for body in BODIES
                for axis in "xyz"
            ),
        ),
    ),
    Schema(
        "solar_activity",
        "a node of the environment's time grid",
        (
            _T,
            _real("f107", "sfu", "F10.7 solar radio flux of the day before"),
            _real("f107_mean", "sfu", "F10.7 solar radio flux, 81-day mean"),
            _real("kp_3h", "1", "geomagnetic index Kp, 3 hours"),
            _real("kp_24h", "1", "geomagnetic index Kp, mean of 24 hours"),
        ),
    ),
    Schema(
        "gravity_field",
        "a degree and order of the Earth's field",
        (
            _count("n", "degree"),
            _count("m", "order"),
            _real("c", "1", "fully normalised cosine coefficient at the epoch", "ITRF"),
            _real("s", "1", "fully normalised sine coefficient at the epoch", "ITRF"),
        ),
    ),
    Schema("truth", "an epoch of the tracking grid", (_T, *_state("GCRF", "true state"))),
    Schema(
        "tracking",
        "a measurement by one station",
        (
            _count("track", "number of the track, from 0"),
            _T,
            _text("station", "station"),
            _real("azimuth", "rad", "measured azimuth, from north eastwards", "topocentric"),
            _real("elevation", "rad", "measured elevation", "topocentric"),
            _real("range", "m", "measured range", "topocentric"),
            _real("azimuth_true", "rad", "azimuth without noise, from north eastwards", "topocentric"),
            _real("elevation_true", "rad", "elevation without noise", "topocentric"),
            _real("range_true", "m", "range without noise", "topocentric"),
        ),
    ),
    Schema(
        "estimates",
        "a track",
        (
            _count("track", "number of the track"),
            _real("t", "s", f"start of the track, {_SINCE}"),
            *_state("GCRF", "estimated state at the track's start"),
            _real("cd", "1", "estimated drag coefficient"),
            *_covariance(),
            _count("iterations", "iterations of the least squares"),
            _flag("converged", "whether the least squares converged"),
            _text("reason", "why there is no usable estimate, empty where there is one"),
            _count("tracks_used", "tracks within the estimation window"),
            _count("measurements_used", "measurements within the estimation window"),
            _real("weighted_rms", "1", "root mean square of the weighted residuals"),
        ),
    ),
    Schema(
        "predictions",
        "a pair of an estimate i and a later track start j",
        (
            *_PAIR,
            _real("t_i", "s", f"epoch of the estimate, {_SINCE}"),
            _real("t_j", "s", f"epoch predicted to, {_SINCE}"),
            *_state("GCRF", "predicted state at t_j"),
            *_state("GCRF", "true state at t_j", suffix="_true"),
            *_ERRORS,
            _text("reason", "why there is no prediction (state and errors are NaN then), else empty"),
        ),
    ),
    Schema(
        "dataset",
        "a pair of an estimate i and a later track start j, before cleaning",
        (
            *_PAIR,
            _count("b", "track of the earlier estimate, -1 where there is none"),
            _real("t_i", "s", f"epoch of the estimate, {_SINCE}"),
            _real("t_j", "s", f"epoch predicted to, {_SINCE}"),
            _real("t_b", "s", f"epoch of the earlier estimate, {_SINCE}"),
            _real("gap", "s", "time between the two estimates, t_i - t_b"),
            *LEARNING_COLUMNS,
            *_ERRORS,
            _flag("keep", "whether the row survived cleaning"),
            _text("reason", "why the row was dropped, empty where it was kept"),
        ),
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
            _real("drift", "m", "along-track error by the estimate's own error of semi-major axis"),
            *_state("RSW of the true state at t_j", "error from the true state and Cd", prefix="floor_"),
        ),
    ),
    mechanism_schema(((1, 15), (1, 16), (2, 31))),
    model_schema(LEARNING_VARIABLES),
    *(model_schema(LEARNING_VARIABLES, kind) for kind in ("gaussian_process", *_MODELS)),
    Schema(
        "evaluation",
        "a pair of an estimate i and a later track start j",
        _EVALUATION,
    ),
    Schema(
        "intervals",
        "a pair of an estimate i and a later track start j",
        (*_EVALUATION, _real("half_width", "SI", "half the prediction interval's width (m or m/s)", "RSW")),
    ),
    Schema(
        "coverage",
        "an experiment",
        (
            *_SPLIT,
            _real(
                "level", "1", "share of rows that the intervals promise to hold, in the mean over estimates"
            ),
            _real("rows_inside", "1", "share of the rows inside"),
            _real("estimates_inside", "1", "its mean over estimates"),
            _real("half_width", "SI", "median of half the width (m or m/s)", "RSW"),
            _real("half_width_last_day", "SI", "the same for the longest predictions, within a day", "RSW"),
            _real("error_last_day", "SI", "median absolute true error of those", "RSW"),
        ),
    ),
    Schema(
        "metrics",
        "an experiment",
        (
            *_SPLIT,
            _count("rows", "rows evaluated"),
            _count("estimates", "distinct estimates among them"),
            _real("p_ml", "%", "performance metric P_ML"),
            _real("p_ml_low", "%", "5th percentile of P_ML over resampled estimates"),
            _real("p_ml_high", "%", "95th percentile of P_ML over resampled estimates"),
            _real("fraction_reduced", "1", "fraction of rows whose error the model reduces"),
        ),
    ),
)
SCHEMAS: dict[str, Schema] = {schema.name: schema for schema in _TABLES}


def write_table(
    path: str | os.PathLike, frame: pd.DataFrame, schema: str | Schema, *, metadata: Mapping[str, Any]
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


def read_table(path: str | os.PathLike, schema: str | Schema) -> pd.DataFrame:
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


def read_tables(paths: Iterable[str | os.PathLike], schema: str | Schema) -> pd.DataFrame:
    """Read tables of one schema below each other; errors as in `read_table`."""
    return pd.concat([read_table(path, schema) for path in paths], ignore_index=True)


def read_metadata(path: str | os.PathLike) -> dict[str, Any]:
    """Return what `write_table` was given as metadata.

    Raises
    ------
    InputError : where the file is missing or damaged.
    """
    with _reading(path), pq.ParquetFile(path) as file:
        values = _metadata(path, file)
    return {key: value for key, value in values.items() if key != "table"}


def markdown() -> str:
    """Return the description of every table, as docs/data.md holds it."""
    lines = [
        "# Tables",
        "",
        "Every table is a Parquet file, written once by one rule and read by the next. Units are SI, angles",
        "radians. Each column carries its unit, frame and meaning in the file (Arrow field metadata); the",
        "file's own metadata holds epoch, time scale, seed, settings digest and version as JSON values.",
        "This page is written by `python -m opml.tables > docs/data.md`.",
    ]
    for schema in SCHEMAS.values():
        lines += ["", f"## {schema.name}", "", f"One row is {schema.row}.", ""]
        lines += ["| column | type | unit | frame | meaning |", "| --- | --- | --- | --- | --- |"]
        for column in schema.columns:
            cells = (
                f"`{column.name}`",
                column.dtype,
                column.unit or "-",
                column.frame or "-",
                column.meaning,
            )
            lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


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


@contextmanager
def _reading(path: str | os.PathLike) -> Iterator[None]:
    """Turn what a missing or damaged file raises, wherever it is noticed, into one line."""
    try:
        yield
    except FileNotFoundError:
        raise InputError(f"{path}: no such file") from None
    except (pa.ArrowException, OSError, ValueError, KeyError) as error:
        raise InputError(f"{path}: damaged, or not a table in Parquet ({error})") from None


def _check_column(path: str | os.PathLike, arrow: pa.Schema, column: Column, table: str) -> None:
    if column.name not in arrow.names:
        raise InputError(f"{path}: {column.name}: column of table {table} is missing")
    found = arrow.field(column.name).type
    if found != _ARROW[column.dtype]:
        raise InputError(f"{path}: {column.name}: expected {column.dtype}, got {found}")


def _metadata(path: str | os.PathLike, file: pq.ParquetFile) -> dict[str, Any]:
    """Return the file's metadata, its digest checked; a table that `write_table` did not write has none."""
    values = {key: json.loads(value) for key, value in _texts(file.schema_arrow.metadata).items()}
    digest = values.pop("digest", None)
    if digest != _footer_digest(file.schema_arrow, values, file.metadata.num_rows):
        raise InputError(f"{path}: damaged, or not written by opml (its footer does not match its digest)")
    return values


if __name__ == "__main__":
    print(markdown())
