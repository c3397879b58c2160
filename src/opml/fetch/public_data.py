"""Space weather, Earth orientation and element sets, fetched into the folder of `base.files.data_folder`.

    public_data.renew([Query.of("25544"), Query("group", "stations")], say=print)
    public_data.sets_of(Query.of("25544"))

Of a download of element sets those that the one before did not have become a file in `gp/<query>/`, under the
time of its arrival: these files are the history. The weather is that of five years, joined to what was there
before, so that its 60 years are requested at most once.
"""

import csv
import io
import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from urllib.parse import quote, unquote, urlencode

import astropy_iers_data
import pandas as pd

from opml.base.errors import InputError
from opml.base.files import FilePath, data_folder, write_text
from opml.base.progress import Progress, counted
from opml.environment import earth_orientation, solar_activity, space_weather
from opml.fetch.downloads import Download, Downloads, NoAnswerError, now
from opml.interop import formats

SETS_HOURS, WEATHER_HOURS, EARTH_HOURS = 2.0, 6.0, 24.0  # during which a file is requested once

_SERVERS = {"OPML_CELESTRAK": "https://celestrak.org", "OPML_IERS": astropy_iers_data.IERS_A_URL}
"""Addresses by the variables of the environment that name others."""

_KINDS = {"number": "CATNR", "name": "NAME", "group": "GROUP"}  # of queries, with CelesTrak's words
_SHORT, _LONG = "SW-Last5Years.csv", "SW-All.csv"
_COLUMNS = ["DATE", *space_weather.KP, "F10.7_OBS", "F10.7_DATA_TYPE", "F10.7_OBS_CENTER81"]


@dataclass(frozen=True)
class Query:
    """A request of element sets: by number, name (or a part of it) or group, and its value."""

    kind: str
    value: str

    @classmethod
    def of(cls, text: str) -> "Query":
        """Return the query of an object's number or name."""
        return cls("number" if text.isdigit() else "name", text)

    @property
    def label(self) -> str:
        """The query as the name of its files."""
        return f"{self.kind}-{quote(self.value.lower(), safe='')}"

    @property
    def download(self) -> Download:
        """CelesTrak's file of it, in CSV, as TLEs have no numbers above 99999."""
        query = urlencode({_KINDS[self.kind]: self.value, "FORMAT": "CSV"})
        url = f"{_server('OPML_CELESTRAK')}/NORAD/elements/gp.php?{query}"
        return Download(f"{self.label}.csv", url, SETS_HOURS, partial(_check_sets, self.value))

    @property
    def folder(self) -> Path:
        """Folder of its history."""
        return sets_folder() / self.label


def sets_folder() -> Path:
    """Return the folder of the history of all element sets."""
    return data_folder() / "gp"


def renew(queries: Iterable[Query], *, say: Progress) -> None:
    """Fetch element sets, weather and Earth orientation, each unless it was requested recently.

    Raises NoAnswerError at the first answer without data; nothing else is requested then.
    """
    renew_object_data(queries, say=say)
    bulletin = earth_orientation.fetched_bulletin()
    file = Download(bulletin.name, _server("OPML_IERS"), EARTH_HOURS, _check_earth)
    is_new = _downloads().renew(file)
    say(f"Earth orientation: {'new' if is_new else 'unchanged'}: {bulletin}")


def renew_object_data(queries: Iterable[Query], *, say: Progress) -> None:
    """Fetch element sets and the weather, as `renew`."""
    for query in queries:
        say(f"{query.value}: {_renew_sets(query)}")
    say(f"space weather: {'new' if _renew_weather() else 'unchanged'}: {solar_activity.fetched_weather()}")


def queries() -> list[Query]:
    """Return all queries of element sets that there were so far."""
    names = (name.removesuffix(".csv").partition("-") for name in _downloads().requests())
    return [Query(kind, unquote(value)) for kind, _, value in names if kind in _KINDS]


def numbers_of(query: Query) -> list[str]:
    """Return the numbers of a query's objects: its own, or those in its last download."""
    if query.kind == "number":
        return [query.value]
    rows = csv.DictReader(_lines(_downloads().path(query.download.name)))
    return sorted({row["NORAD_CAT_ID"] for row in rows}, key=int)


def sets_of(query: Query) -> list[Path]:
    """Return the folders that have sets of a query: its own, of a number those of others with it, too."""
    folders = [query.folder] if query.folder.exists() else []
    if query.kind == "number":
        mark = f",{int(query.value)},".encode()
        for other in queries():
            path = _downloads().path(other.download.name)
            if other != query and path.exists() and mark in path.read_bytes():
                folders.append(other.folder)
    return folders


def sets_or_files(paths: Sequence[FilePath], say: Progress) -> tuple[Sequence[FilePath], str | None]:
    """Return files of an object and None; for its number or name alone, its fetched sets and that text.

    Where a server gives no data, the newest files serve, and their age is reported. Raises NoAnswerError
    where there is none of the object.
    """
    text = str(paths[0])
    if len(paths) > 1 or os.path.exists(text) or os.path.basename(text) != text.partition(".")[0]:
        return paths, None
    query = Query.of(text)
    try:
        renew_object_data([query], say=say)
    except NoAnswerError as error:
        if not sets_of(query):
            raise
        say(f"{error}; at hand: {_ages(query)}")
    return sets_of(query), text


def _downloads() -> Downloads:
    return Downloads(data_folder() / "downloads")


def _server(variable: str) -> str:
    return os.environ.get(variable, _SERVERS[variable])


def _ages(query: Query) -> str:
    """Return in words how long ago the sets of a query and the weather were fetched."""
    ages = {"sets": query.download.name, "weather": _SHORT}
    known = ((name, _downloads().age(file)) for name, file in ages.items())
    return ", ".join(f"{name} of {age.total_seconds() / 3600.0:.0f} h ago" for name, age in known if age)


def _renew_sets(query: Query) -> str:
    path = _downloads().path(query.download.name)
    before = set(_lines(path)) if path.exists() else set()
    _downloads().renew(query.download)
    header, *rows = _lines(path)
    new = [row for row in rows if row not in before] if header in before else rows
    if new:
        write_text(query.folder / f"{now():%Y-%m-%dT%H%M%S}.csv", "\n".join([header, *new]) + "\n")
    return f"{counted(len(rows), 'set')}, {len(new)} new: {query.folder}"


def _lines(path: Path) -> list[str]:
    return path.read_text(encoding="utf-8").splitlines()


def _renew_weather() -> bool:
    """Fetch five years of weather, and all where days are missing before them; return whether it is new."""
    path, short = solar_activity.fetched_weather(), _weather_file(_SHORT)
    if not _downloads().renew(short) and path.exists():
        return False
    new = _downloads().path(_SHORT).read_text(encoding="utf-8")
    joined = _joined(solar_activity.read_text(solar_activity.resolve(solar_activity.NEWEST)), new)
    if joined is None:
        _downloads().renew(_weather_file(_LONG))
        joined = _downloads().path(_LONG).read_text(encoding="utf-8")
    write_text(path, joined)
    return True


def _weather_file(name: str) -> Download:
    url = f"{_server('OPML_CELESTRAK')}/SpaceData/{name}"
    return Download(name, url, WEATHER_HOURS, _check_weather)


def _joined(known: str, new: str) -> str | None:
    """Return the weather of two CSSI files, the second's days in the place of the first's.

    None where days are missing between them.
    """
    old, recent = (
        pd.read_csv(io.StringIO(text), comment="#", dtype=str, keep_default_na=False)[_COLUMNS]
        for text in (known, new)
    )
    old = old[~old["F10.7_DATA_TYPE"].isin(space_weather.PREDICTED)]
    begin = recent["DATE"].iloc[0]
    if pd.Timestamp(old["DATE"].iloc[-1]) + pd.Timedelta(days=1) < pd.Timestamp(begin):
        return None
    return str(pd.concat([old[old["DATE"] < begin], recent]).to_csv(index=False))


def _check_sets(wanted: str, content: bytes) -> None:
    """Raise InputError for a body without a row of element sets in CSV; wanted: value of the query."""
    kind = formats.of(wanted, content, formats.ELEMENTS)
    if kind.name != "OMM" or len(content.splitlines()) < 2:
        raise InputError(f"{wanted}: expected a row of element sets in CSV, got {kind.name}")


def _check_weather(content: bytes) -> None:
    space_weather.read("space weather", content.decode("utf-8", "replace"))


def _check_earth(content: bytes) -> None:
    earth_orientation.daily_values("finals2000A", content.decode("ascii", "replace").splitlines())
