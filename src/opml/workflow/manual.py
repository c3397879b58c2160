"""The pages of the documentation, which travel with the package."""

import re
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
        near = get_close_matches(name, _names(), n=3, cutoff=0.5)
        expected = f"a page such as {' or '.join(near)}" if near else "a page that `opml docs` lists"
        raise InputError(f"docs: expected {expected}, got {name}")
    text = (MANUAL / f"{name}.md").read_text(encoding="utf-8")
    return _INCLUDED.sub(lambda found: (MANUAL / found[1]).read_text(encoding="utf-8"), text).rstrip("\n")


def contents() -> str:
    """Return the folder of the pages, and their names and titles in the order of the site."""
    lines = [f"`opml docs PAGE` prints a page of {MANUAL.resolve()}"]
    for caption, name in _CAPTION_OR_PAGE.findall(_index()):
        lines += ["", caption] if caption else [f"  {name:16}{_title(page(name))}"]
    return "\n".join(lines)


def _index() -> str:
    return (MANUAL / "index.md").read_text(encoding="utf-8")


def _names() -> list[str]:
    return [name for _, name in _CAPTION_OR_PAGE.findall(_index()) if name]


def _title(text: str) -> str:
    return next(line.removeprefix("# ") for line in text.splitlines() if line.startswith("# "))
