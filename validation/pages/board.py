"""The tables of docs/benchmark.md, one per task: the columns of benchmark/board.tsv that a page can show."""

import csv
from collections.abc import Iterator
from itertools import groupby
from pathlib import Path

from validation.case import ROOT

TABLE = Path("docs/tables/board.md")
BOARD = ROOT / "benchmark" / "board.tsv"

_LEADS = (1, 3, 5, 7)
_COLUMNS = {
    **{f"{lead} d [m]": f"S, {lead} d" for lead in _LEADS},
    "95 % at 7 d [m]": "95 % of S",
    "R at 7 d [m]": "R, 7 d",
    "W at 7 d [m]": "W, 7 d",
}
_INSIDE = "inside 90 % at 7 d"


def page() -> str:
    """Return a table per task, a row per tool: medians [m], the least of each column in bold."""
    with BOARD.open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file, delimiter="\t"))
    return "\n".join(
        line for task, own in groupby(rows, key=lambda row: row["task"]) for line in _task(task, list(own))
    )


def _task(task: str, rows: list[dict[str, str]]) -> Iterator[str]:
    numbers = {name: [int(row[name].split()[0]) for row in rows] for name in _COLUMNS}
    yield f"`{task}`, errors [m]:\n"
    yield f"| tool | {' | '.join(_COLUMNS.values())} | inside 90 % |"
    yield f"|{' --- |' * (2 + len(_COLUMNS))}"
    for k, row in enumerate(rows):
        cells = (f"**{own[k]}**" if own[k] == min(own) else str(own[k]) for own in numbers.values())
        inside = row[_INSIDE].split()[0]
        yield f"| {row['tool'].removeprefix('opml 1.0.0: ')} | {' | '.join(cells)} | {inside} |"
    yield ""
