"""Kinds of measurement: each is one value of KINDS, which settings, checks, jobs and fits ask.

Their files are checked and read in `opml.catalog.measured_files`; measurements of fits are in
`opml.catalog.fit.fixes.MEASUREMENTS`.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import pandas as pd

from opml.base.errors import InputError
from opml.tables import SCHEMAS


@dataclass(frozen=True)
class Kind:
    """One kind of measurement."""

    name: str  # of the setting of its files
    table: str = ""  # name of the schema of its measurements; '' where no orbit is fitted to it
    stations: str = ""  # name in the place of a station set; '' where stations of the sheet measure
    options: str = ""  # the setting with the options of reading; '' without any
    needs_options: bool = False  # whether there is no default of it
    beneath: str = ""  # file of the settings beneath a user's; '' without any
    tells_orbit: bool = True  # whether a first orbit can be determined from the measurements alone
    for_mornings: bool = True  # whether mornings read it


TRACKS = Kind("tracks", "tracking")
FIXES = Kind("fixes", "fixes", stations="fixes", options="fixing")
RANGES = Kind(
    "ranges",
    "laser_ranges",
    stations="ranges",
    options="ranging",
    needs_options=True,
    beneath="config/ranges.yaml",
    tells_orbit=False,
    for_mornings=False,
)
ELEMENTS = Kind("elements", options="histories")

KINDS = [TRACKS, FIXES, RANGES, ELEMENTS]


def of_fits() -> list[Kind]:
    """Return the kinds that orbits are fitted to."""
    return [kind for kind in KINDS if kind.table]


def in_place_of_stations() -> list[str]:
    """Return the names in the place of a station set, where none of the sheet measured."""
    return list(dict.fromkeys(kind.stations for kind in KINDS if kind.stations))


def names(kinds: Sequence[Kind] = KINDS) -> str:
    """Return the names of kinds, in words."""
    *most, last = (kind.name for kind in kinds)
    return f"{', '.join(most)} or {last}"


def of_table(table: pd.DataFrame) -> Kind:
    """Return the kind whose schema has columns of a table that schemas of other kinds have not.

    Raises InputError for a table of no kind.
    """
    columns = {kind.table: {*SCHEMAS[kind.table].names} for kind in of_fits()}
    for kind in of_fits():
        others = set().union(*(names for name, names in columns.items() if name != kind.table))
        if columns[kind.table] & set(table.columns) - others:
            return kind
    raise InputError(f"expected a table {', '.join(columns)}, got one of {', '.join(table.columns)}")
