"""The page docs/data.md, written from the schemas."""

from collections.abc import Iterable

from opml.tables.columns import Column, Schema
from opml.tables.schemas import SCHEMAS

_PREAMBLE = """\
# Tables

Every table is a Parquet file, written once by one rule and read by the next. Units are SI, angles are in
radians. The file keeps each column's unit, frame and meaning (Arrow field metadata), and epoch, time scale,
seed, settings digest and version (file metadata, as JSON values). This page is written by
`opml tables > docs/data.md`."""


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
