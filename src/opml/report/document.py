"""Short documents of headings, paragraphs and tables, written as Markdown, HTML and tab-separated text."""

import html
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from opml.base.files import FilePath, replacing
from opml.tables import HOW_TO_CSV


@dataclass(frozen=True)
class Heading:
    """A heading, of level 1 for the document's title."""

    text: str
    level: int = 2


@dataclass(frozen=True)
class Paragraph:
    """A paragraph; `code` stands between backticks, **bold** words between double asterisks."""

    text: str


@dataclass(frozen=True)
class Table:
    """A table of texts without `|`, one per cell."""

    header: Sequence[str]
    rows: Sequence[Sequence[str]]


Block = Heading | Paragraph | Table


def markdown(blocks: Iterable[Block]) -> str:
    """Return the document as Markdown."""
    return "\n\n".join(_markdown(block) for block in blocks) + "\n"


def html_page(blocks: Iterable[Block], *, title: str) -> str:
    """Return the document as one HTML page without references to anything outside."""
    body = "\n".join(_html(block) for block in blocks)
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{html.escape(title)}</title>\n"
        f"<style>{_STYLE}</style>\n<body>\n{body}\n</body>\n</html>\n"
    )


def tab_separated(table: Table) -> str:
    """Return one table as tab-separated text, backticks removed."""
    lines = ("\t".join(cells) for cells in (table.header, *table.rows))
    return "\n".join(lines).replace("`", "") + "\n"


def write(
    blocks: Sequence[Block],
    path_md: FilePath,
    path_tsv: FilePath,
    path_html: FilePath,
) -> None:
    """Write a document as Markdown and HTML, and its first table as tab-separated text.

    The pages end with a line on tables as CSV.
    No file is left half written.
    """
    pages = [*blocks, Paragraph(HOW_TO_CSV)]
    title = next(block.text for block in blocks if isinstance(block, Heading))
    table = next(block for block in blocks if isinstance(block, Table))
    for path, text in (
        (path_md, markdown(pages)),
        (path_html, html_page(pages, title=title)),
        (path_tsv, tab_separated(table)),
    ):
        with replacing(path) as temporary:
            temporary.write_text(text, encoding="utf-8")


_STYLE = (
    "body{font:15px/1.5 sans-serif;max-width:70em;margin:2em auto;padding:0 1em;color:#222}"
    "table{border-collapse:collapse;margin:1em 0}"
    "th,td{border-bottom:1px solid #ccc;padding:.3em .7em;text-align:left;vertical-align:top}"
    "th{border-bottom:2px solid #888}code{background:#f2f2f2;padding:0 .2em;overflow-wrap:anywhere}"
)


def _markdown(block: Block) -> str:
    match block:
        case Heading(text, level):
            return f"{'#' * level} {text}"
        case Paragraph(text):
            return text
        case Table(header, rows):
            lines = [header, ["---"] * len(header), *rows]
            return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def _html(block: Block) -> str:
    match block:
        case Heading(text, level):
            return f"<h{level}>{_inline(text)}</h{level}>"
        case Paragraph(text):
            return f"<p>{_inline(text)}</p>"
        case Table(header, rows):
            lines = [_row(header, "th"), *(_row(row, "td") for row in rows)]
            return "<table>\n" + "\n".join(lines) + "\n</table>"


def _row(cells: Sequence[str], tag: str) -> str:
    return "<tr>" + "".join(f"<{tag}>{_inline(cell)}</{tag}>" for cell in cells) + "</tr>"


def _inline(text: str) -> str:
    bold = re.sub(r"\*\*(.+?)\*\*", r"<strong>\1</strong>", html.escape(text))
    return re.sub(r"`([^`]*)`", r"<code>\1</code>", bold)
