"""Names of RSOs, station sets and learners."""

import re
from collections.abc import Iterable, Mapping
from typing import TypeVar

from opml.base.errors import InputError
from opml.naming.spelling import NUMBER, POSITIVE, alternatives

Settings = TypeVar("Settings")


def rso_parts(text: str, sheet: Iterable[str]) -> tuple[str, str, str]:
    """Return the row of the sheet, the inclination and the offset in an RSO's name, '' for an absent part.

    Raises InputError for a text that is not canonical or names no row of the sheet.
    """
    match = re.fullmatch(_rso(r"(?P<base>[^_]*)"), text)
    if match is None or match["base"] not in sheet:
        raise InputError(
            f"RSO '{text}': expected one of {', '.join(sheet)}, then at most _i<degrees> and _a<+ or -><km>"
        )
    return match["base"], match["i"] or "", match["a"] or ""


def rso_pattern(sheet: Iterable[str]) -> str:
    """Return the regular expression of every canonical RSO, without named groups."""
    return re.sub(r"\?P<\w+>", "?:", _rso(f"(?:{alternatives(sheet)})"))


def _rso(base: str) -> str:
    return rf"{base}(?:_i(?P<i>{NUMBER}))?(?:_a(?P<a>[+-]{POSITIVE}))?"


def rso_name(base: str, inclination: str, offset: str) -> str:
    """Return the name of a row of the sheet with an inclination [deg] and an offset of its axis [km].

    '' leaves a part out.
    """
    return base + (f"_i{inclination}" if inclination else "") + (f"_a{offset}" if offset else "")


def station_names(text: str, known: Iterable[str]) -> list[str]:
    """Return the stations in a set's canonical name. Raises InputError for any other text."""
    known, names = list(known), text.split("-")
    if unknown := [name for name in names if name not in known]:
        raise InputError(f"stations '{text}': expected names from {', '.join(known)}, got '{unknown[0]}'")
    canonical = "-".join(name for name in known if name in names)
    if text != canonical:
        raise InputError(f"stations '{text}': expected '{canonical}', each name once in the sheet's order")
    return names


def stations_pattern(sheet: Iterable[str]) -> str:
    """Return the regular expression of stations in any order; `station_names` checks the order."""
    name = alternatives(sheet)
    return f"(?:{name})(?:-(?:{name}))*"


def parse_learner(text: str, learners: Mapping[str, Settings]) -> Settings:
    """Return the settings of the learner in a name. Raises InputError for an unknown text."""
    if text not in learners:
        raise InputError(f"learner '{text}': expected one of {', '.join(learners)}")
    return learners[text]
