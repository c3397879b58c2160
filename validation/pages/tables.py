"""The page docs/data.md, made from the schemas."""

from pathlib import Path

from opml.learning.models import learners
from opml.tables import SCHEMAS, Column

PAGE = Path("docs/data.md")
"""Page with the columns of every table."""

_PREAMBLE = """\
# Tables

Every table is a Parquet file, written once by one rule and read by the next. Units are SI, angles are in
radians. The file keeps each column's unit, frame and meaning (Arrow field metadata), and epoch, time scale,
seed, settings digest and version (file metadata, as JSON values). `opml table FILE` prints all this of a
table, and `opml table FILE --csv` its rows. This page is written by `python -m validation.pages`."""


def tables_page() -> str:
    """Return the page that describes every table, those of models before those of their errors."""
    tables = list(SCHEMAS.values())
    before = tables.index(SCHEMAS["evaluation"])
    lines = [_PREAMBLE]
    for schema in (*tables[:before], *learners.schemas(), *tables[before:]):
        lines += ["", f"## {schema.name}", "", f"One row is {schema.row}.", ""]
        lines += ["| column | type | unit | frame | meaning |", "| --- | --- | --- | --- | --- |"]
        lines += [_column_row(column) for column in (*schema.columns, *schema.optional)]
    return "\n".join(lines) + "\n"


def _column_row(column: Column) -> str:
    cells = (f"`{column.name}`", column.dtype, column.unit or "-", column.frame or "-", column.meaning)
    return f"| {' | '.join(cells)} |"
