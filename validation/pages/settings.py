"""The page config/keys.md, made from the models of the settings."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from opml.base.section import Section
from opml.base.setting_types import TypeSchema
from opml.study.settings.json_schema import choices, dereferenced, json_schema
from opml.study.settings.model.run import RunAlone
from opml.study.settings.model.study_parts import ClaimSettings, Entry, OwnStudySettings, PaperStudy

KEYS = Path("config/keys.md")
"""Page with the tables of keys."""


class _Part(NamedTuple):
    """Keys of one model: their heading, what they are, the mapping that they stand in."""

    heading: str
    sentence: str
    mapping: str
    model: type[Section]


_PARTS = (
    _Part("The run", "What is simulated, or read from files.", "", RunAlone),
    _Part("A study of your own", "What is asked of the run.", "study", OwnStudySettings),
    _Part("The paper", "The paper's figures and tables.", "study", PaperStudy),
    _Part(
        "Entries",
        "An entry of `evaluations`, `grids`, `curves` and the like is a model on a test. Besides its own\n"
        "keys it has these, as far as they make sense for it.",
        "<entry>",
        Entry,
    ),
    _Part(
        "Claims",
        "An item of `claims` compares a sentence of the paper with our numbers of an entry.",
        "claims",
        ClaimSettings,
    ),
)

_TOP = """## Every key

Written by `python -m validation.pages` from the models that check them. How files of settings are combined:
[settings](README.md).
"""


def keys_page() -> str:
    """Return the page with a table of the keys of each part of the settings."""
    parts = (f"\n### {part.heading}\n\n{part.sentence}\n\n{_table(part)}" for part in _PARTS)
    return _TOP + "".join(parts)


def _table(part: _Part) -> str:
    schema = json_schema(part.model)
    heading = "| key | meaning | unit, values |\n| --- | --- | --- |\n"
    rows = [
        row
        for key, node in schema["properties"].items()
        for row in _rows(schema, node, f"{part.mapping}.{key}".removeprefix("."))
    ]
    return heading + "".join(f"{row}\n" for row in rows)


def _rows(schema: TypeSchema, node: TypeSchema, key: str) -> Iterator[str]:
    """Yield the row of a setting, or those of the mapping that it is.

    Keys that every entry may have stand in a table of their own.
    """
    inner = dereferenced(schema, node)
    if word := inner.get("propertyNames", {}).get("placeholder"):
        key, inner = f"{key}.<{word}>", dereferenced(schema, inner["additionalProperties"])
    if "properties" in inner and "allOf" not in inner:
        for name, below in inner["properties"].items():
            if not below.get("shared"):
                yield from _rows(schema, below, f"{key}.{name}")
    else:
        yield f"| `{key}` | {_meaning(node)} | {_values(node, inner)} |"


def _meaning(node: TypeSchema) -> str:
    """Return what a setting means, with a link to the page that tells more."""
    meaning: str = node["description"]
    if see := node.get("see"):
        page, _, heading = see.partition("#")
        link = f"../docs/{see}" if page else f"README.md{see}"
        meaning += f" ([{(heading or Path(page).stem).replace('-', ' ')}]({link}))"
    return meaning


def _values(node: TypeSchema, inner: TypeSchema) -> str:
    """Return what may stand under a key, with its unit and its default."""
    unit, words = node.get("unit", ""), _words(inner)
    values = f"{words} [{unit}]" if words and unit else words or unit
    if "default" in node:
        default = node["default"]
        values += f"; by default `{default if isinstance(default, str) else json.dumps(default)}`"
    return values


def _words(node: TypeSchema) -> str:
    """Return what is expected at a node, or the names that it takes."""
    if "errorMessage" in node:
        return str(node["errorMessage"]).replace("<", "\\<")
    if names := choices(node) or choices(node.get("properties", {}).get("kind", {})):
        return ", ".join(f"`{name}`" for name in names)
    return {"boolean": "`true`, `false`", "number": "a number"}.get(node.get("type", ""), "")
