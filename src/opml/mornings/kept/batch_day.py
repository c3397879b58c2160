"""Records of a batch of objects on a day: one folder, whose tables have rows of all of them.

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
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
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


@dataclass(frozen=True)
class MorningMark:
    """Settings, stations and models of a morning of an object."""

    settings: str  # their digest
    stations: Mapping[str, str]  # digests of those that measured the object, by name
    models: Sequence[str]  # of its ephemerides; none where it made none


FinishedMorning = tuple[Records, Mapping[str, Any], MorningMark]
"""A morning of an object that is over: its records, its outcome and how it was made."""


class BatchDay:
    """The folder of a batch on a day, read as it is when it is first asked."""

    def __init__(self, folder: Path) -> None:
        """Take the folder, which need not be there."""
        self.folder = folder
        self._tables: dict[str, pd.DataFrame] = {}

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
        """Outcomes of objects, by name."""
        return {one["object"]: one for one in outcomes.read(self.folder / _OUTCOMES)}

    def table(self, name: str) -> pd.DataFrame:
        """Return a table by its name. Raises InputError where it is missing or damaged."""
        if name not in self._tables:
            self._tables[name] = read_table(self.folder / f"{name}.parquet", of_objects(SCHEMAS[name]))
        return self._tables[name]

    def rows(self, table: str, name: str) -> pd.DataFrame:
        """Return the rows of an object. Raises InputError as `table` does."""
        return rows_of(self.table(table), name, SCHEMAS[table])

    def paths(self, name: str) -> list[Paths]:
        """Return the ephemerides of an object, if any are there."""
        models = self.marks[name].models
        if not models or self._paths is None:
            return []
        rows = rows_of(self._paths, name, paths_schema(models))
        return [Paths(rows)] if len(rows) else []

    @cached_property
    def _paths(self) -> pd.DataFrame | None:
        """The ephemerides, if any are there."""
        file = self.folder / PATHS
        if not file.exists():
            return None
        return read_table(file, of_objects(paths_schema(read_metadata(file)["models"])))

    def write(self, made: Mapping[str, FinishedMorning], *, metadata: Mapping[str, Any]) -> None:
        """Write mornings of objects beside those that are there; metadata: of the tables."""
        records = {name: own for name, (own, _, _) in made.items()}
        became = {name: outcome for name, (_, outcome, _) in made.items()}
        marks = dict(sorted((self.marks | {name: mark for name, (_, _, mark) in made.items()}).items()))
        for table, schema in ((table, SCHEMAS[table]) for table in Records.TABLES):
            rows = {
                name: records[name].tables[table] if name in records else self.rows(table, name)
                for name in marks
            }
            self._write(f"{table}.parquet", rows, schema, metadata)
        paths = {name: records[name].paths if name in records else self.paths(name) for name in marks}
        if tables := {name: one.table for name, own in paths.items() for one in own}:
            models = list(dict.fromkeys(model for name in tables for model in marks[name].models))
            self._write(PATHS, tables, paths_schema(models), {**metadata, "models": models})
        whole = [became[name] if name in became else self.outcomes[name] for name in marks]
        outcomes.write(self.folder / _OUTCOMES, whole)
        with replacing(self.folder / _DONE) as temporary:
            temporary.write_text(json.dumps({name: vars(mark) for name, mark in marks.items()}) + "\n")

    def _write(
        self, file: str, rows: Mapping[str, pd.DataFrame], schema: Schema, metadata: Mapping[str, Any]
    ) -> None:
        """Write rows of objects below each other; those that lack a column have no values there."""
        table = joined([one.assign(object=name) for name, one in rows.items()], schema)
        write_table(self.folder / file, table, of_objects(schema), metadata=metadata)


def joined(tables: Sequence[pd.DataFrame], schema: Schema) -> pd.DataFrame:
    """Return tables of objects below each other, with the columns of a schema."""
    whole = of_objects(schema)
    filled = [one.reindex(columns=whole.names) for one in tables if len(one)]
    return pd.concat(filled, ignore_index=True) if filled else whole.empty()


def rows_of(table: pd.DataFrame, name: str, schema: Schema) -> pd.DataFrame:
    """Return the rows of an object in a table whose objects are sorted, with the columns of a schema."""
    objects = table["object"].to_numpy(object)
    first, end = (int(np.searchsorted(objects, name, side)) for side in ("left", "right"))
    return table.iloc[first:end][schema.names].reset_index(drop=True)
