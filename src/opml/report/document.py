"""Short documents: texts, tables, pictures and cards; as Markdown, HTML and tab-separated text.

A text is in Markdown: a heading behind `#`, a list whose items are lines behind `- `, or else a paragraph. It
may hold `code` between backticks, **bold** words between double asterisks and [links](#to-a-heading).
"""

import base64
import html
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path

from opml.base.files import FilePath, write_text
from opml.tables import HOW_TO_CSV


@dataclass(frozen=True)
class Table:
    """A table of texts without `|`, one per cell."""

    header: Sequence[str]
    rows: Sequence[Sequence[str]]


@dataclass(frozen=True)
class Picture:
    """A PNG, which Markdown links to and HTML holds; link: from the document."""

    file: FilePath
    link: str
    shows: str


@dataclass(frozen=True)
class Card:
    """A small panel: a title, a line that says most, texts, and a row of marks."""

    title: str
    line: str
    kind: str  # names its colour; marks: what is seen, what a pointer shows, and its kind, each
    texts: Sequence[str]
    marks: Sequence[tuple[str, str, str]]


Block = str | Table | Picture | Card | list[Picture] | list[Card]
"""A part of a document; narrow pictures, or cards, stand side by side, as many as the page has room for."""

_HEADING = re.compile(r"(#+) (.*)", re.DOTALL)


def items(texts: Iterable[str]) -> str:
    """Return a list of texts."""
    return "\n".join(f"- {text}" for text in texts)


def _anchor(heading: str) -> str:
    """Return the name that readers of Markdown give to a heading."""
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


def markdown(blocks: Iterable[Block]) -> str:
    """Return the document as Markdown."""
    return "\n\n".join(_markdown(block) for block in blocks) + "\n"


def html_page(blocks: Iterable[Block], *, title: str) -> str:
    """Return the document as one HTML page that needs nothing from outside to be read."""
    body = "\n".join(_html(block) for block in blocks)
    style = (files("opml") / "data" / "report.css").read_text(encoding="utf-8").replace("\n", "")
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{html.escape(title)}</title>\n"
        f"<style>{style}</style>\n<body>\n{body}\n</body>\n</html>\n"
    )


def tab_separated(table: Table) -> str:
    """Return one table as tab-separated text, backticks removed."""
    lines = ("\t".join(cells) for cells in (table.header, *table.rows))
    return "\n".join(lines).replace("`", "") + "\n"


def write(blocks: Sequence[Block], path_md: FilePath, path_tsv: FilePath, path_html: FilePath) -> None:
    """Write a document as Markdown and HTML, and its first table as tab-separated text.

    The pages end with a line on tables as CSV.
    No file is left half written.
    """
    pages = [*blocks, HOW_TO_CSV]
    title = next(block for block in blocks if isinstance(block, str)).removeprefix("# ")
    table = next(block for block in blocks if isinstance(block, Table))
    for path, text in (
        (path_md, markdown(pages)),
        (path_html, html_page(pages, title=title)),
        (path_tsv, tab_separated(table)),
    ):
        write_text(path, text)


_LINK = re.compile(r"\[([^\]]+)\]\((https?://[^)\s]+|(?!//)[^):\s]+)\)")
"""A link to a page or a place; to nothing that runs."""

_MARKS = str.maketrans({"`": "'", "*": "\u2217", "[": "(", "]": ")", "|": "/"})

_NUMBERS = re.compile(r"-|[-+]?\.?\d[\d.,e+\-]*( %)?( / [-+]?\d[\d.e+\-]*| \([^a-z]+ to [^a-z]+\))?")
"""A cell of a number, of two, or of one with its interval."""

_TIME = re.compile(r"[\dT:-]+Z")
_TAG_OR_TIME = re.compile(r"<[^>]*>|(\d{4}-\d\d-\d\d(?:T[\d:]+Z?)?)")  # a time of a text is not broken
_SENTENCE = 40  # characters of a cell that is not to be squeezed to a word a line


def _markdown(block: Block) -> str:
    match block:
        case str():
            return block
        case Table(header, rows):
            lines = [header, ["---"] * len(header), *rows]
            return "\n".join(f"| {' | '.join(line)} |" for line in lines)
        case Picture(_, link, shows):
            return f"![{shows}]({link})"
        case Card():
            return _markdown_card(block)
        case list():
            return "\n\n".join(map(_markdown, block))


def _markdown_card(card: Card) -> str:
    marks = "".join(seen for seen, _, _ in card.marks)
    return "\n".join([f"**{card.title}. {card.line}**", "", *card.texts, *([marks] if marks else [])])


def as_it_is(text: str) -> str:
    """Return a text that somebody else wrote, such as a line of a file, without what would mark it up."""
    return text.translate(_MARKS)


def _html(block: Block) -> str:
    match block:
        case str():
            return _html_text(block)
        case Table(header, rows):
            kinds = [_kind([row[k] for row in rows]) for k in range(len(header))]
            lines = [_row(header, "th", kinds), *(_row(row, "td", kinds) for row in rows)]
            return "<table>\n" + "\n".join(lines) + "\n</table>"
        case Picture(file, _, shows):
            data = base64.b64encode(Path(file).read_bytes()).decode()
            return (
                f'<p class="picture"><img alt="{html.escape(shows)}" src="data:image/png;base64,{data}"></p>'
            )
        case Card():
            return _html_card(block)
        case list():
            kind = "cards" if block and isinstance(block[0], Card) else "pictures"
            return f'<div class="{kind}">\n' + "\n".join(map(_html, block)) + "\n</div>"


def _html_text(text: str) -> str:
    if heading := _HEADING.fullmatch(text):
        level, words = len(heading[1]), heading[2]
        return f'<h{level} id="{_anchor(words)}">{_inline(words)}</h{level}>'
    if text.startswith("- "):
        lines = (line.removeprefix("- ") for line in text.split("\n"))
        return "<ul>\n" + "\n".join(f"<li>{_inline(line)}</li>" for line in lines) + "\n</ul>"
    return f"<p>{_inline(text)}</p>"


def _html_card(card: Card) -> str:
    marks = "".join(
        f'<span class="{_class(kind)}" title="{html.escape(title)}">{html.escape(seen)}</span>'
        for seen, title, kind in card.marks
    )
    texts = "".join(f"<p>{_inline(text)}</p>" for text in card.texts)
    return (
        f'<section class="{_class(card.kind)}"><h2>{_inline(card.title)}</h2>'
        f'<p class="line">{_inline(card.line)}</p>{texts}<p class="marks">{marks}</p></section>'
    )


def _class(kind: str) -> str:
    return _anchor(kind)


def _kind(cells: Sequence[str]) -> str:
    """Return the class of a column's cells, as ` class="number"`: what all of them are, or one a sentence."""
    kinds = {"number": _NUMBERS, "time": _TIME}
    classes = [name for name, form in kinds.items() if cells and all(map(form.fullmatch, cells))]
    classes += ["sentence"] if any(len(cell) >= _SENTENCE for cell in cells) else []
    return f' class="{classes[0]}"' if classes else ""


def _row(cells: Sequence[str], tag: str, kinds: Sequence[str]) -> str:
    texts = (f"<{tag}{kind}>{_inline(cell)}</{tag}>" for cell, kind in zip(cells, kinds, strict=True))
    return f"<tr>{''.join(texts)}</tr>"


def _inline(text: str) -> str:
    bold = re.sub(r"\*\*(.+?)\*\*", r"<strong>\1</strong>", html.escape(text))
    linked = _LINK.sub(r'<a href="\2">\1</a>', bold)
    coded = re.sub(r"`([^`]*)`", r"<code>\1</code>", linked)
    return _TAG_OR_TIME.sub(
        lambda match: f'<span class="time">{match[1]}</span>' if match[1] else match[0], coded
    )
