"""The folder of all days: what mornings left on them, as the job of a batch of objects reads and writes it.

`days/2026-02-15/batch_0/` has what the mornings of a batch left (`batch_day`). Objects are found in whatever
batch they were.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from datetime import date, timedelta
from pathlib import Path
from typing import Any

import pandas as pd

from opml.base.errors import InputError
from opml.base.files import FilePath
from opml.mornings.calendar import HORIZON
from opml.mornings.kept.batch_day import PATHS, BatchDay, FinishedMorning, joined, rows_of
from opml.mornings.records import Records
from opml.tables import SCHEMAS

_BATCH = "batch_"


class Store:
    """Records of the mornings of objects, by day."""

    def __init__(self, days: FilePath, batch: str, objects: Iterable[str]) -> None:
        """Take the folder of all days, the batch that is written, and the names of its objects."""
        self._days, self._own, self._objects = Path(days), f"{_BATCH}{batch}", list(objects)
        self._places: dict[date, dict[str, BatchDay]] = {}
        self._past: dict[tuple[str, tuple[date, ...]], pd.DataFrame] = {}

    def done(self, until: date) -> dict[str, list[date]]:
        """Return by object the dates up to one of the newest mornings that are over, HORIZON, ascending."""
        dates: dict[str, list[date]] = {name: [] for name in self._objects}
        wanted = set(dates)
        for day in self._dates(until):
            for name in wanted & self.places(day).keys():
                dates[name].append(day)
            wanted = {name for name in wanted if len(dates[name]) < HORIZON}
            if not wanted:
                break
        return {name: found[::-1] for name, found in dates.items()}

    def places(self, day: date) -> Mapping[str, BatchDay]:
        """Return where what a morning left is, of each object whose morning is over."""
        if day not in self._places:
            folder, lacking = self._days / day.isoformat(), set(self._objects)
            known: dict[str, BatchDay] = {}
            others = (one for one in sorted(folder.glob(f"{_BATCH}*")) if one.name != self._own)
            for place in map(BatchDay, (folder / self._own, *others)):
                known |= dict.fromkeys(lacking & place.marks.keys(), place)
                lacking -= known.keys()
                if not lacking:
                    break
            self._places[day] = known
        return self._places[day]

    def message(self, day: date, name: str) -> Path:
        """Return the path of the message of an object."""
        return self._days / day.isoformat() / name / f"{name}.oem"

    def check_next(self, before: date, after: date, name: str) -> None:
        """Raise InputError where two mornings of an object are not of one day and the next."""
        if (gone := before + timedelta(days=1)) != after:
            folder = self._days / gone.isoformat()
            raise InputError(
                f"{folder}: expected the morning of {name} that later ones build on, got none; put it back, "
                "or remove the days after it, and all are run again"
            )

    def check_made(self, day: date, name: str, settings: str, stations: Mapping[str, str]) -> None:
        """Raise InputError where a morning was made with other settings or stations, by their digests."""
        place = self.places(day)[name]
        mark, instead = place.marks[name], "give another folder of results, or remove these"
        if mark.settings != settings:
            raise InputError(
                f"{place.folder}: expected mornings of {name} that were made with these settings, got "
                f"others; {instead}"
            )
        for station, digest in stations.items():
            if mark.stations.get(station, digest) != digest:
                raise InputError(
                    f"{place.folder}: expected the station {station} as it measured {name} then, got other "
                    f"numbers; {instead}"
                )

    def records(self, name: str, days: Sequence[date], *, since: date) -> Records:
        """Return the records of mornings of an object, with ephemerides since a day.

        Raises InputError where a table is missing or damaged, or ephemerides are gone.
        """
        places = [self.places(day)[name] for day in days]
        estimates, judged, issued = (
            rows_of(self._rows(table, tuple(days)), name, SCHEMAS[table]) for table in Records.TABLES
        )
        recent = [place for day, place in zip(days, places, strict=True) if day >= since]
        paths = [one for place in recent for one in _whole_paths(place, name)]
        return Records(estimates, judged, issued, paths)

    def let_go(self) -> None:
        """Let go of the tables that were read so far: ephemerides of a batch fill a tenth of a gigabyte."""
        self._places.clear()
        self._past.clear()

    def _rows(self, table: str, days: tuple[date, ...]) -> pd.DataFrame:
        """Return the rows of days of all objects, read once: those of an object in the order of the days."""
        if (table, days) not in self._past:
            parts = []
            for places in map(self.places, days):
                for place in dict.fromkeys(places.values()):
                    rows = place.table(table)
                    own = [name for name in place.marks if places.get(name) is place]
                    parts.append(rows[rows["object"].isin(own)])
            whole = joined(parts, SCHEMAS[table])
            self._past[table, days] = whole.sort_values("object", kind="stable", ignore_index=True)
        return self._past[table, days]

    def write(self, day: date, made: Mapping[str, FinishedMorning], *, metadata: Mapping[str, Any]) -> None:
        """Write mornings of a day that are over; metadata: of the tables."""
        BatchDay(self._days / day.isoformat() / self._own).write(made, metadata=metadata)
        self._places.pop(day, None)

    def drop_paths(self, first: date, *, until: date) -> None:
        """Remove the batch's ephemerides of days before one, where all mornings of `until` are over."""
        over = self.places(until).keys()
        for day in (first - timedelta(days=k) for k in range(1, HORIZON)):
            place = BatchDay(self._days / day.isoformat() / self._own)
            if (file := place.folder / PATHS).exists() and place.marks.keys() <= over:
                file.unlink()

    def _dates(self, until: date) -> Iterator[date]:
        """Yield the days up to one that have a folder, the newest first."""
        names = sorted((path.name for path in self._days.glob("[0-9]*-*-*")), reverse=True)
        yield from (day for day in map(date.fromisoformat, names) if day <= until)


def _whole_paths(place: BatchDay, name: str) -> Sequence[Any]:
    paths = place.paths(name)
    if place.marks[name].models and not paths:
        raise InputError(
            f"{place.folder / PATHS}: expected ephemerides of {name}, which later mornings judge, got none; "
            "those of more than a week before the last morning are not kept, and all mornings are run again "
            "if all are removed"
        )
    return paths
