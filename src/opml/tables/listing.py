"""Tables as text for people: what a file holds, and all of it as comma-separated values."""

import json
import re
from typing import TextIO

import pandas as pd

from opml.base.files import FilePath
from opml.tables.parquet import read_metadata, read_schema, read_table

FIRST_ROWS = 3
_LONGEST = 1000  # characters of an entry of the metadata that are shown

_NUMBER = r"(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
_FORMULA = re.compile(rf"[=@\t]|[+-](?!{_NUMBER}(?:,[+-]?{_NUMBER})*$)")
"""Beginning of a text that a spreadsheet evaluates; a number is none, nor the coordinates of a place."""

HOW_TO_CSV = "Any table as CSV: `opml table FILE --csv`"  # what every page of results ends with


def head(path: FilePath) -> str:
    """Return a table's kind, its metadata, and of each column the unit, the first values and the meaning.

    Raises InputError where the file is missing or damaged.
    """
    schema = read_schema(path)
    frame = read_table(path, schema)
    first = frame.head(FIRST_ROWS)
    cells = [
        [
            *(column.name, column.unit or "-", *map(_cell, first[column.name])),
            f"{column.meaning} ({column.frame})" if column.frame else column.meaning,
        ]
        for column in schema.columns
    ]
    numbers = [f"row {number}" for number in range(len(first))]
    return "\n".join(
        [
            f"{path}: {schema.name}, {len(frame)} rows",
            *(f"{key}: {_plain(value)}" for key, value in read_metadata(path).items()),
            "",
            *_aligned([["column", "unit", *numbers, "meaning"], *cells]),
        ]
    )


def comma_separated(frame: pd.DataFrame, file: TextIO | FilePath) -> None:
    """Write rows as comma-separated values, a line for the names of the columns first.

    Texts that a spreadsheet would take for a formula begin with an apostrophe.
    """
    texts = frame.select_dtypes(["object", "string"]).map(
        lambda value: f"'{value}" if isinstance(value, str) and _FORMULA.match(value) else value
    )
    frame.assign(**texts).to_csv(file, index=False)


def write_csv(path: FilePath, file: TextIO) -> None:
    """Write a table to an open file as `comma_separated` has it.

    Raises InputError where the table's file is missing or damaged; nothing is written then.
    """
    comma_separated(read_table(path, read_schema(path)), file)


def _cell(value: object) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value) or "-"


def _plain(value: object) -> str:
    """Return an entry of the metadata, the first part of a long one with its length."""
    text = value if isinstance(value, str) else json.dumps(value)
    if len(text) <= _LONGEST:
        return text
    return f"{text[:_LONGEST]} ... ({len(text)} characters)"


def _aligned(rows: list[list[str]]) -> list[str]:
    widths = pd.DataFrame(rows).map(len).max().tolist()
    return ["  ".join(map(str.ljust, row, widths)).rstrip() for row in rows]
