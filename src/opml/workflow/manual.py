"""The pages of the documentation, which travel with the package."""

import re
from collections import Counter
from difflib import get_close_matches

from opml.base.errors import InputError
from opml.base.files import MANUAL

_CAPTION_OR_PAGE = re.compile(r"^:caption: (.+)$|^(\w+)$", re.MULTILINE)

_INCLUDED = re.compile(r"^```\{include\} (\S+)\n```$", re.MULTILINE)


def page(name: str) -> str:
    """Return the text of a page, such as `operations`; a file that it includes stands in its place.

    Raises InputError where there is no such page.
    """
    if name not in _names():
        close = get_close_matches(name, _names(), n=3, cutoff=0.75)
        near = " or ".join(_pages_with(f"opml {name} ") or close or _pages_with(name))
        expected = f"a page such as {near}" if near else "a page that `opml docs` lists"
        raise InputError(f"docs: expected {expected}, got {name}")
    return _INCLUDED.sub(lambda names: (MANUAL / names[1]).read_text(encoding="utf-8"), _text(name)).rstrip(
        "\n"
    )


def contents() -> str:
    """Return the folder of the pages, and their names and titles in the order of the site."""
    lines = [f"`opml docs PAGE` prints a page of {MANUAL.resolve()}"]
    for caption, name in _CAPTION_OR_PAGE.findall(_text("index")):
        lines += ["", caption] if caption else [f"  {part:19}{_title(page(part))}" for part in _parts(name)]
    return "\n".join(lines)


def _pages_with(text: str) -> list[str]:
    """Return the pages that have a text, at most two and none of tables, that with most of it first."""
    pages = [name for name in _names() if "/" not in name]
    counts = Counter({name: _text(name).lower().count(text.lower()) for name in pages})
    return [name for name, count in counts.most_common(2) if count]


def _text(name: str) -> str:
    return (MANUAL / f"{name}.md").read_text(encoding="utf-8")


def _names() -> list[str]:
    names = [name for _, name in _CAPTION_OR_PAGE.findall(_text("index")) if name]
    return [part for name in names for part in _parts(name)]


def _parts(name: str) -> list[str]:
    return [name, *sorted(f"{name}/{path.stem}" for path in MANUAL.glob(f"{name}/*.md"))]


def _title(text: str) -> str:
    return next(line.removeprefix("# ") for line in text.splitlines() if line.startswith("# "))
