"""The pages docs/data.md and docs/data/*.md, made from the schemas."""

from collections.abc import Sequence
from functools import partial
from pathlib import Path

from opml.learning.models import learners
from opml.tables import Column, Schema
from opml.tables.schemas import STAGES

_PREAMBLE = """\
# Tables

Every table is a Parquet file, written once by one rule and read by the next. Units are SI, angles are in
radians. The file keeps each column's unit, frame and meaning (Arrow field metadata), and epoch, time scale,
seed, settings digest and version (file metadata, as JSON values). `opml table FILE` prints all this of a
table, and `opml table FILE --csv` its rows. These pages are written by `python -m validation.pages`.

| stage | tables |
| --- | --- |"""


def pages() -> dict[Path, partial[str]]:
    """Return what makes each page, by its path: the list of all tables, and a page for each stage."""
    stages = STAGES | {"models": learners.schemas()}
    texts = {Path("docs/data.md"): partial(overview, stages)}
    return texts | {_path(stage): partial(stage_page, stage, schemas) for stage, schemas in stages.items()}


def overview(stages: dict[str, Sequence[Schema]]) -> str:
    """Return the page that lists the tables of every stage."""
    rows = [
        f"| [{stage}](data/{_path(stage).name}) | "
        + ", ".join(f"[`{schema.name}`](data/{_path(stage).name}#{schema.name})" for schema in schemas)
        + " |"
        for stage, schemas in stages.items()
    ]
    menu = ["", "```{toctree}", ":hidden:", "", *(f"data/{_path(stage).stem}" for stage in stages), "```"]
    return "\n".join([_PREAMBLE, *rows, *menu]) + "\n"


def stage_page(stage: str, schemas: Sequence[Schema]) -> str:
    """Return the page that describes the tables of a stage."""
    lines = [f"# Tables: {stage}"]
    for schema in schemas:
        lines += ["", f"## {schema.name}", "", f"One row is {schema.row}.", ""]
        lines += ["| column | type | unit | frame | meaning |", "| --- | --- | --- | --- | --- |"]
        lines += [_column_row(column) for column in (*schema.columns, *schema.optional)]
    return "\n".join(lines) + "\n"


def _path(stage: str) -> Path:
    return Path("docs/data") / f"{stage.replace(' ', '_')}.md"


def _column_row(column: Column) -> str:
    cells = (f"`{column.name}`", column.dtype, column.unit or "-", column.frame or "-", column.meaning)
    return f"| {' | '.join(cells)} |"
