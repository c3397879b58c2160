"""All schemas by their names, except those of trained models: what `opml/data/tables.yaml` says of tables."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from importlib.resources import files
from pathlib import Path
from typing import Any

from opml.base.yaml_files import read_yaml
from opml.tables.columns import (
    PARAMETERS,
    STATE,
    Column,
    Schema,
    count,
    covariance,
    flag,
    real,
    text,
    unit_of,
)

_SHEET = read_yaml(Path(str(files("opml") / "data" / "tables.yaml")))
_GROUPS, _VARYING = _SHEET.pop("groups"), _SHEET.pop("varying")

_KINDS = {"count": count, "text": text, "flag": flag}
_VECTORS = {"<state>": STATE, "<xyz>": STATE[:3]}
_COVARIANCES = {"state": STATE, "parameters": PARAMETERS}


def _columns(items: Sequence[Any]) -> Iterator[Column]:
    """Yield the columns of a table or group of the sheet."""
    for item in items:
        if isinstance(item[0], list):
            yield from _columns(item)
        else:
            yield from _column(*item)


def _column(name: str, kind: str | int, meaning: str, frame: str = "") -> Iterator[Column]:
    """Yield the column of a line, or those of a covariance or of all axes that a mark stands for."""
    if name == "<covariance>":
        yield from covariance(_COVARIANCES[str(kind)], meaning)
    elif kind in _KINDS:
        yield _KINDS[str(kind)](name, meaning)
    elif mark := next((mark for mark in _VECTORS if mark in name), ""):
        for axis in _VECTORS[mark]:
            unit = unit_of(axis) if mark == "<state>" else str(kind)
            yield real(name.replace(mark, axis), unit, f"{meaning}, {axis}", frame)
    else:
        yield real(name, str(kind), meaning, frame)


def _schema(name: str, table: dict[str, Any], *more: Column) -> Schema:
    columns, optional = (tuple(_columns(table.get(part, []))) for part in ("columns", "optional"))
    return Schema(name, table["row"], (*columns, *more), optional)


def mechanism_schema(resonances: Sequence[tuple[int, int]]) -> Schema:
    """Return the schema of the table `mechanism` with two columns for each resonance (k, m)."""
    meaning = "along-track drift per unit of an acceleration as the {part} of {k} (w + M) + {m} (W - theta)"
    drifts = (
        real(f"{name}_{k}_{m}", "s2", meaning.format(part=part, k=k, m=m))
        for k, m in resonances
        for name, part in (("cos", "cosine"), ("sin", "sine"))
    )
    return _schema("mechanism", _SHEET["catalogue"]["mechanism"], *drifts)


def paths_schema(models: Sequence[str]) -> Schema:
    """Return the schema of the table `paths`: ephemerides of models from the newest estimate of a morning."""
    frame = "RSW of the predicted state at t_j"
    errors = (real(f"e_y_{name}", "m", f"along-track error that {name} expects", frame) for name in models)
    return _varying("paths", *errors)


def _varying(name: str, *more: Column) -> Schema:
    return _schema(name, _VARYING[name], *more)


def of_objects(schema: Schema) -> Schema:
    """Return the schema of a file with the rows of several objects, sorted by their names."""
    return replace(schema, columns=(text("object", "name of the object"), *schema.columns))


STAGES = {
    stage: tuple(
        mechanism_schema(((1, 15), (1, 16), (2, 31))) if name == "mechanism" else _schema(name, table)
        for name, table in tables.items()
    )
    for stage, tables in _SHEET.items()
}
"""Schemas by the stage of the workflow that makes the tables."""

SCHEMAS: dict[str, Schema] = {schema.name: schema for schemas in STAGES.values() for schema in schemas}

LEARNING_VARIABLES = tuple(column.name for column in _columns(_GROUPS["learning_variables"]))

SIZES = [column.name for column in _columns(_GROUPS["sizes"])]
"""Columns of the sizes of errors that an ephemeris was given."""
