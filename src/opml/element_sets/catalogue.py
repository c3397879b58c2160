"""The sets of many objects, as people download them, and which of them were known on a morning."""

import logging
from collections.abc import Iterable
from dataclasses import dataclass
from functools import partial

import numpy as np
import pandas as pd
from sgp4.api import Satrec

from opml.base import epochs
from opml.base.files import FilePath
from opml.interop.element_sets.element_set import ElementSet, mean_height, of_files
from opml.interop.element_sets.known_sets import LATENCY, find_files, readable

_MOST_DAYS = 1e6  # more than any modified Julian day
_MADE_LATE = "element sets made more than %g d after their epochs: %d of %d: is CREATION_DATE a download's?"
_LATE = 3.0  # days after its epoch when no publisher makes a set any more

_log = logging.getLogger(__name__)


@dataclass(frozen=True, eq=False)
class ElementCatalogue:
    """Sets of mean elements, by object and epoch.

    table: columns number (of the catalogue), t (epoch), known (when it was public; modified Julian days,
        UTC), bstar [1/(6378.135 km)], motion [rad/min], eccentricity, inclination [rad], height [m] (mean,
        above the equatorial radius), file, place and line (where the set is)
    """

    table: pd.DataFrame
    satellites: list[Satrec]  # what SGP4 propagates, a set a row

    def until(self, date: float) -> "ElementCatalogue":
        """Return the sets that were known at a time (modified Julian day, UTC)."""
        return self.take(np.flatnonzero(self.table["known"].to_numpy() <= date))

    def daily(self) -> "ElementCatalogue":
        """Return the last set of each object and UTC day."""
        day = self.table["number"].to_numpy() * _MOST_DAYS + np.floor(self.table["t"].to_numpy())
        return self.take(np.flatnonzero(np.append(day[1:], np.inf)[: len(day)] != day))

    def newest(self) -> "ElementCatalogue":
        """Return the last set of each object."""
        number = self.table["number"].to_numpy()
        return self.take(np.flatnonzero(np.append(number[1:] != number[:-1], True)[: len(number)]))

    @property
    def by_number(self) -> pd.DataFrame:
        """The table by the number of the object."""
        return self.table.set_index("number", drop=False)

    def take(self, rows: np.ndarray) -> "ElementCatalogue":
        """Return the sets of some rows, in order."""
        return ElementCatalogue(
            self.table.iloc[rows].reset_index(drop=True), [self.satellites[row] for row in rows]
        )


def read(
    paths: Iterable[FilePath], *, latency: float = LATENCY, leave_out_damaged: bool = False
) -> ElementCatalogue:
    """Read the sets of files and folders, in all formats that `mean_elements` reads.

    latency: days from epoch to publication of sets that do not say when they were made
    leave_out_damaged: however many damaged sets there are; otherwise one in twenty of a file at most

    Files that are unreadable, or too many of whose sets are, are skipped, as `of_files`; raises its error.
    """
    sets = of_files(find_files(paths), partial(readable, leave_out_damaged=leave_out_damaged))
    sets.sort(key=lambda one: (one.number, _epoch(one.satellite), one.created))
    table = _table(sets, latency)
    late = int((table["known"] - table["t"] > _LATE).sum())
    if 2 * late > len(table):
        _log.warning(_MADE_LATE, _LATE, late, len(table))
    return ElementCatalogue(table, [one.satellite for one in sets])


def _epoch(satellite: Satrec) -> float:
    """Return the epoch of a set as modified Julian day (UTC)."""
    return float(satellite.jdsatepoch - epochs.MJD_ZERO + satellite.jdsatepochF)


def _table(sets: list[ElementSet], latency: float) -> pd.DataFrame:
    satellites = [one.satellite for one in sets]
    t = np.array([_epoch(one) for one in satellites], dtype=float)
    created = np.array([epochs.mjd(one.created) if one.created else np.nan for one in sets])
    motion = np.array([one.no_kozai for one in satellites], dtype=float)
    return pd.DataFrame(
        {
            "number": np.array([one.number for one in sets], dtype=np.int64),
            "t": t,
            "known": np.where(np.isfinite(created), np.fmax(created, t), t + latency),
            "bstar": np.array([one.bstar for one in satellites], dtype=float),
            "motion": motion,
            "eccentricity": np.array([one.ecco for one in satellites], dtype=float),
            "inclination": np.array([one.inclo for one in satellites], dtype=float),
            "height": mean_height(motion),
            "file": [str(one.path) for one in sets],
            **{name: np.array([getattr(one, name) for one in sets], np.int64) for name in ("place", "line")},
        }
    )
