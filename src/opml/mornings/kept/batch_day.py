"""What the mornings of a batch of objects leave on a day: one folder, whose tables have rows of all of them.

kept_estimates.parquet   estimates that were made, over all windows
judged.parquet           how far ephemerides of earlier mornings were off these, model by model
issued.parquet           the models that were selected and their sizes of errors
paths.parquet            ephemerides of all models, as long as later mornings may judge them
outcomes.json.gz         what became of each object
done.json                the objects whose mornings are over; written last

Rows of an object count once `done.json` names it. A job that was killed left the objects of it as they were,
and those that failed are added later.
"""

import json
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from opml.base.errors import InputError
from opml.base.files import replacing
from opml.ephemerides.paths import Paths
from opml.mornings import outcomes
from opml.mornings.records import Records
from opml.tables import SCHEMAS, Schema, of_objects, paths_schema, read_metadata, read_table, write_table

PATHS = "paths.parquet"  # the file of ephemerides

_DONE, _OUTCOMES = "done.json", "outcomes.json.gz"
_ABSENT: dict[str, Any] = {"bool": False, "int64": 0, "float64": np.nan, "string": ""}
"""What optional columns hold for objects that lack them."""


@dataclass(frozen=True)
class MorningMark:
    """How a morning of an object was made."""

    settings: str  # their digest
    stations: Mapping[str, str]  # digests of those that measured the object, by name
    optional: Sequence[str]  # columns that its tables have beside those of their schemas
    models: Sequence[str]  # of its ephemerides; none where it made none


@dataclass(frozen=True)
class FinishedMorning:
    """A morning of an object that is over; settings, stations: as those of its mark."""

    records: Records
    outcome: Mapping[str, Any]
    settings: str
    stations: Mapping[str, str]

    @property
    def mark(self) -> MorningMark:
        """How it was made."""
        optional = [
            column.name
            for name, table in self.records.tables.items()
            for column in SCHEMAS[name].optional
            if column.name in table
        ]
        more = paths_schema([]).optional
        optional += [c.name for c in more if any(c.name in one.table for one in self.records.paths)]
        models = [model for paths in self.records.paths for model in paths.models]
        return MorningMark(self.settings, self.stations, optional, models)


class BatchDay:
    """The folder of a batch on a day, read as it is when it is first asked."""

    def __init__(self, folder: Path) -> None:
        """Take the folder, which need not be there."""
        self.folder = folder
        self._tables: dict[str, ObjectRows] = {}

    @cached_property
    def marks(self) -> dict[str, MorningMark]:
        """The objects whose mornings are over, and how these were made."""
        path = self.folder / _DONE
        with suppress(FileNotFoundError, NotADirectoryError):
            try:
                return {name: MorningMark(**one) for name, one in json.loads(path.read_text()).items()}
            except (ValueError, TypeError, AttributeError):
                raise InputError(f"{path}: expected what opml wrote, got other text") from None
        return {}

    @cached_property
    def outcomes(self) -> dict[str, dict[str, Any]]:
        """What became of objects, by name."""
        return {one["object"]: one for one in outcomes.read(self.folder / _OUTCOMES)}

    def table(self, name: str) -> "ObjectRows":
        """Return a table by its name. Raises InputError where it is missing or damaged."""
        return self._read(f"{name}.parquet", SCHEMAS[name])

    def rows(self, table: str, name: str) -> pd.DataFrame:
        """Return the rows of an object. Raises InputError as `table` does."""
        return self.table(table).rows(name, self.marks[name].optional)

    def paths(self, name: str) -> list[Paths]:
        """Return the ephemerides of an object, if any are there."""
        models = self.marks[name].models
        if not models or self._paths is None:
            return []
        schema, optional = paths_schema(models), self.marks[name].optional
        names = [*schema.names, *(one.name for one in schema.optional if one.name in optional)]
        rows = self._paths.rows(name, optional)
        return [Paths(rows[names])] if len(rows) else []

    @cached_property
    def _paths(self) -> "ObjectRows | None":
        """The ephemerides, if any are there."""
        file = self.folder / PATHS
        if not file.exists():
            return None
        return self._read(PATHS, paths_schema(read_metadata(file)["models"]))

    def write(self, made: Mapping[str, FinishedMorning], *, metadata: Mapping[str, Any]) -> None:
        """Write mornings of objects beside those that are there; metadata: of the tables."""
        marks = dict(sorted((self.marks | {name: one.mark for name, one in made.items()}).items()))
        for table, schema in ((table, SCHEMAS[table]) for table in Records.TABLES):
            rows = {
                name: made[name].records.tables[table] if name in made else self.rows(table, name)
                for name in marks
            }
            self._write(f"{table}.parquet", rows, schema, metadata)
        paths = {name: made[name].records.paths if name in made else self.paths(name) for name in marks}
        if tables := {name: one.table for name, found in paths.items() for one in found}:
            models = list(dict.fromkeys(model for name in tables for model in marks[name].models))
            of_none, of_all = paths_schema([]), paths_schema(models)
            schema = replace(of_none, optional=(*of_none.optional, *of_all.columns[len(of_none.columns) :]))
            self._write(PATHS, tables, schema, {**metadata, "models": models})
        told = [made[name].outcome if name in made else self.outcomes[name] for name in marks]
        outcomes.write(self.folder / _OUTCOMES, told)
        with replacing(self.folder / _DONE) as temporary:
            temporary.write_text(json.dumps({name: vars(mark) for name, mark in marks.items()}) + "\n")

    def _write(
        self, file: str, rows: Mapping[str, pd.DataFrame], schema: Schema, metadata: Mapping[str, Any]
    ) -> None:
        """Write rows of objects below each other; those that lack a column of some have no values there."""
        table, whole = joined([one.assign(object=name) for name, one in rows.items()], schema)
        write_table(self.folder / file, table, whole, metadata=metadata)

    def _read(self, file: str, schema: Schema) -> "ObjectRows":
        if file not in self._tables:
            table = read_table(self.folder / file, of_objects(schema))
            self._tables[file] = ObjectRows.of(table, schema)
        return self._tables[file]


def joined(tables: Sequence[pd.DataFrame], schema: Schema) -> tuple[pd.DataFrame, Schema]:
    """Return tables of objects below each other, and their columns, with all optional ones that some have.

    Those that lack one have no values there.
    """
    found = [column for column in schema.optional if any(column.name in one for one in tables)]
    filled = [
        one.assign(**{c.name: _ABSENT[c.dtype] for c in found if c.name not in one})
        for one in tables
        if len(one)
    ]
    whole = of_objects(replace(schema, columns=(*schema.columns, *found), optional=()))
    return pd.concat(filled, ignore_index=True) if filled else whole.empty(), whole


@dataclass(frozen=True)
class ObjectRows:
    """A table by object; slices: of its rows."""

    table: pd.DataFrame
    schema: Schema
    slices: Mapping[str, slice]

    @classmethod
    def of(cls, table: pd.DataFrame, schema: Schema) -> "ObjectRows":
        """Take a table whose objects are sorted."""
        names, first = np.unique(table["object"].to_numpy(str), return_index=True)
        ends = np.append(first, len(table))[1:]
        slices = {str(name): slice(a, b) for name, a, b in zip(names, first, ends, strict=True)}
        return cls(table, schema, slices)

    def rows(self, name: str, optional: Iterable[str] = ()) -> pd.DataFrame:
        """Return the rows of an object; optional: columns that it has beside those of the schema."""
        names = [*self.schema.names, *(one.name for one in self.schema.optional if one.name in optional)]
        return self.table.iloc[self.slices.get(name, slice(0))][names].reset_index(drop=True)
