"""Texts of reports: pieces of Markdown in `opml/data/reports`, with places for numbers and rows of tables."""

import re
from collections.abc import Iterable, Iterator, Sequence
from functools import cache
from importlib.resources import files

from opml.report.document import Block, Table


@cache
def _pieces(report: str) -> dict[str, str]:
    text = (files("opml") / "data" / "reports" / f"{report}.md").read_text(encoding="utf-8")
    _, *parts = re.split(r"^<!-- (\w+) -->\n", text, flags=re.MULTILINE)
    return {name: part.strip() for name, part in zip(parts[::2], parts[1::2], strict=True)}


def blocks(piece: str, rows: Sequence[Sequence[str]] = (), /, **values: object) -> Iterator[Block]:
    """Yield headings, paragraphs and tables of a piece, as `report.name`; rows: of its table."""
    report, _, name = piece.partition(".")
    for part in _pieces(report)[name].split("\n\n"):
        text = " ".join(part.splitlines()).format(**values)
        if part.startswith("|"):
            cells = text.removeprefix("| ").removesuffix(" |").split(" | ")
            yield Table([cell for cell in cells if cell], rows)
        else:
            yield text


def sentences(piece: str, /, **values: object) -> str:
    """Return the text of a piece of one paragraph."""
    report, _, name = piece.partition(".")
    return " ".join(_pieces(report)[name].splitlines()).format(**values)


def across(cells: Iterable[str]) -> str:
    """Return some cells of a table's header as its text has them."""
    return " | ".join(cells)
