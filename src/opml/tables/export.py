"""Tables in the notation of a file's suffix, for tools that read no Parquet."""

import json
from collections.abc import Callable, Mapping
from typing import Any

import pandas as pd

from opml.base.files import FilePath, replacing, suffix_of, write_text
from opml.tables.columns import Schema
from opml.tables.listing import comma_separated
from opml.tables.parquet import write_table

TABLE_SUFFIXES = (".csv", ".json", ".parquet")  # suffixes that `write_as` knows


def write_as(
    path: FilePath, frame: pd.DataFrame, schema: str | Schema, *, metadata: Mapping[str, Any]
) -> None:
    """Write a table as CSV, JSON (metadata and rows) or Parquet, whole or not at all; NaN is empty or null.

    frame, schema, metadata: as in `write_table`

    Raises InputError for another suffix.
    """
    _WRITERS[suffix_of(path, TABLE_SUFFIXES)](path, frame, schema, metadata=metadata)


def _write_csv(path: FilePath, frame: pd.DataFrame, _: str | Schema, *, metadata: Mapping[str, Any]) -> None:
    with replacing(path) as temporary:
        comma_separated(frame, temporary)


def _write_json(path: FilePath, frame: pd.DataFrame, _: str | Schema, *, metadata: Mapping[str, Any]) -> None:
    rows = json.loads(frame.to_json(orient="records", double_precision=15))
    write_text(path, json.dumps({**metadata, "rows": rows}, indent=1) + "\n")


_WRITERS: Mapping[str, Callable[..., None]] = {
    ".csv": _write_csv,
    ".json": _write_json,
    ".parquet": write_table,
}
