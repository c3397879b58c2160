"""Reader of laser ranges in the ILRS's consolidated laser ranging data format (CRD), versions 1 and 2.

Normal points are read, ranges to a satellite there and back; full-rate data are passed over. Times are UTC.
Source: Ricklefs & Moore 2009, Consolidated Laser Ranging Data Format, version 1.01; version 2.01, 2019.
"""

import logging
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np
import pandas as pd

from opml.base import epochs
from opml.base.constants import DAY, SPEED_OF_LIGHT
from opml.base.errors import InputError
from opml.base.files import FilePath
from opml.interop.orbit_arcs import choose_satellites, contents, line_error, numbers

_HECTO, _NANO, _PICO, _PERCENT = 1e2, 1e-9, 1e-12, 1e-2

_UTC = ("3", "4", "7")  # time scales of a station that are UTC: of the observatory, of GPS, of the BIPM

_TWO_WAY = "2"
_QUALITY, _POOR = 21, "2"  # word of H4 that gives the quality
_SENT, _BOUNCED, _RECEIVED = "2", "1", "0"
_WEATHER = (
    (400.0, 1100.0, "a pressure [hPa]"),
    (200.0, 340.0, "a temperature [K]"),
    (0.0, 100.0, "a humidity [%]"),
)
"""Limits of the weather of a station."""

_LIGHT = (300.0, 2000.0)  # wavelengths of lasers [nm]
_LONGEST_FLIGHT = 3.0  # to the Moon and back [s]
_PASSED_OVER = re.compile(r"00|10|12|21|30|4[0-2]|5[0-1]|60|9\d|C[1-7]|H5|H9")
_Row = tuple[int, list[str]]  # line and words
_log = logging.getLogger(__name__)


@dataclass
class _Pass:
    """The lines of one pass of a station."""

    head: dict[str, _Row]
    wavelengths: dict[str, _Row] = field(default_factory=dict)
    points: list[_Row] = field(default_factory=list)
    weather: list[_Row] = field(default_factory=list)


def read(paths: Sequence[FilePath], *, epoch: str, satellite: str | None = None) -> pd.DataFrame:
    """Read the normal points of CRD files, in the order of their passes.

    satellite: name, ILRS number, SIC or NORAD number; None: that of the first pass

    Columns: track, the number of the pass; t, when the light was received [s]; station, its number, and
    system, with which it was occupied; flight, of the light there and back [s]; scatter, of the single ranges
    of a point, one way [m], NaN where not stated; wavelength [m]; pressure [Pa], temperature [K] and
    humidity [1], between those of the pass; path and line. Of passes of a station that overlap, which are one
    that was released again, the newest release counts.

    Raises InputError, naming file and line, for a malformed or truncated file, another satellite, and data
    that are no ranges there and back by UTC, are without refraction, to the centre of mass or with the
    station's delay, and weather that cannot be. Passes that their station calls poor are left out and logged.
    """
    tables = []
    for path in paths:
        for one in _passes(path, satellite):
            satellite = satellite or one.head["H3"][1][1]
            if one.head["H4"][1][_QUALITY : _QUALITY + 1] == [_POOR]:  # says the station itself
                _log.warning("%s: line %d: a pass of poor quality is ignored", path, one.head["H4"][0])
            elif one.points:
                tables.append(_points(path, one, epoch))
    if not tables:
        raise InputError(f"{paths[0]}: expected normal points, got none")
    passes = sorted(_newest(tables), key=lambda table: float(table["t"].iloc[0]))
    whole = pd.concat([table.assign(track=number) for number, table in enumerate(passes)], ignore_index=True)
    return whole.drop(columns="release")


def _newest(tables: Sequence[pd.DataFrame]) -> list[pd.DataFrame]:
    """Return the passes, of those that overlap and are of one station the newest release alone."""
    found: list[pd.DataFrame] = []
    for table in sorted(tables, key=lambda table: (table["station"].iloc[0], table["t"].min())):
        before = found[-1] if found and found[-1]["station"].iloc[0] == table["station"].iloc[0] else None
        if before is not None and table["t"].min() <= before["t"].max():
            found[-1] = max(before, table, key=lambda one: int(one["release"].iloc[0]))
        else:
            found.append(table)
    if len(found) < len(tables):
        _log.info("%d passes are left out, as others of their station overlap them", len(tables) - len(found))
    return found


def _passes(path: FilePath, satellite: str | None) -> Iterator[_Pass]:
    head: dict[str, _Row] = {}
    current: _Pass | None = None
    number = 1
    for number, text in enumerate(contents(path).decode("latin-1").splitlines(), 1):
        words = text.split()
        kind = words[0].upper() if words else "00"
        if kind in ("H1", "H2", "H3", "H4"):
            head[kind] = number, words
            if kind == "H4":
                _check_head(path, head, satellite)
                satellite = satellite or head["H3"][1][1]
                current = _Pass(dict(head))
        elif kind == "H8" and current is not None:
            yield current
            current = None
        elif kind in ("C0", "11", "20") and current is not None:
            _keep(path, current, kind, (number, words))
        elif _PASSED_OVER.fullmatch(kind) is None:
            raise line_error(path, number, "a record of CRD, of a pass between H4 and H8", text)
    if current is not None:
        raise line_error(path, number, "H8 at the end of a pass", "the end of the file")


def _keep(path: FilePath, current: _Pass, kind: str, row: _Row) -> None:
    number, words = row
    fewest, into = {"C0": (4, None), "11": (5, current.points), "20": (5, current.weather)}[kind]
    if len(words) < fewest:
        raise line_error(path, number, f"{fewest} words or more", " ".join(words))
    if into is None:
        current.wavelengths[words[3]] = row
    else:
        into.append(row)


def _check_head(path: FilePath, head: dict[str, _Row], satellite: str | None) -> None:
    """Raise InputError for a pass that lacks a header, and one of data that are not read."""
    number, last = head["H4"]
    for kind, words, what in (
        ("H1", 3, "H1 CRD"),
        ("H2", 6, "H2 of a station"),
        ("H3", 5, "H3 of a satellite"),
    ):
        line, found = head.get(kind, (number, []))
        if len(found) < words:
            raise line_error(path, line, f"{what} before H4", " ".join(found))
    if head["H1"][1][1].upper() != "CRD" or head["H1"][1][2] not in ("1", "2"):
        raise line_error(path, head["H1"][0], "H1 CRD of version 1 or 2", " ".join(head["H1"][1]))
    if head["H2"][1][5] not in _UTC:
        raise line_error(path, head["H2"][0], "UTC, time scale 3, 4 or 7", " ".join(head["H2"][1]))
    choose_satellites(path, [head["H3"][1][1:5]], satellite)
    if len(last) < 21:
        raise line_error(path, number, "H4 with times and flags", " ".join(last))
    for word, wanted, what in (
        (15, "0", "refraction"),
        (16, "0", "centre of mass"),
        (18, "1", "the station's delay"),
        (20, _TWO_WAY, "ways"),
    ):
        if last[word] != wanted:
            raise line_error(path, number, f"{wanted} for {what}", last[word])


def _points(path: FilePath, one: _Pass, epoch: str) -> pd.DataFrame:
    lines = np.array([number for number, _ in one.points])
    line, words = one.head["H4"]
    sent, flight = numbers(path, np.array([words[1:3] for _, words in one.points]), lines).T
    is_flight = (flight > 0.0) & (flight < _LONGEST_FLIGHT)
    strange = np.flatnonzero(~is_flight | (sent < 0.0) | (sent > DAY))
    if strange.size:
        number, point = one.points[strange[0]]
        raise line_error(path, number, "a second of the day and a time of flight", " ".join(point[1:3]))
    seconds = _since_midnight(path, one, sent)
    parts = {_SENT: 1.0, _BOUNCED: 0.5, _RECEIVED: 0.0}
    for number, point in one.points:
        if point[4] not in parts:
            raise line_error(path, number, "epoch event 0, 1 or 2", point[4])
    later = flight * [parts[point[4]] for _, point in one.points]
    return pd.DataFrame(
        {
            "t": _midnight(path, one, epoch) + seconds + later,
            "station": one.head["H2"][1][2],
            "release": int(numbers(path, np.array([words[14:15]]), np.array([line]))[0, 0]),
            "system": "".join(word.zfill(2) for word in one.head["H2"][1][3:5]),
            "flight": flight,
            "scatter": _scatter(one),
            "wavelength": _wavelengths(path, one),
            **_weather(path, one, seconds),
            "path": str(path),
            "line": lines,
        }
    )


def _midnight(path: FilePath, one: _Pass, epoch: str) -> float:
    """Return when the day of the pass's beginning began [s since `epoch`]."""
    number, words = one.head["H4"]
    year, month, day = numbers(path, np.array([words[2:5]]), np.array([number]))[0]
    try:
        return epochs.seconds_between(epoch, f"{year:04.0f}-{month:02.0f}-{day:02.0f}T00:00:00")
    except InputError:
        raise line_error(path, number, "a date", " ".join(words[2:5])) from None


def _since_midnight(path: FilePath, one: _Pass, seconds: np.ndarray) -> np.ndarray:
    """Return seconds of the day (n,) as those since the midnight before the pass, which may go on behind."""
    number, words = one.head["H4"]
    hour, minute, second = numbers(path, np.array([words[5:8]]), np.array([number]))[0]
    begin = 3600.0 * hour + 60.0 * minute + second
    return np.where(seconds < begin - 0.5 * DAY, seconds + DAY, seconds)


def _scatter(one: _Pass) -> np.ndarray:
    """Return the scatter (n,) [m] of the single ranges of each point, NaN where its record has none."""
    texts = pd.Series([words[7] if len(words) > 7 else "" for _, words in one.points], dtype="str")
    spread = pd.to_numeric(texts, errors="coerce").to_numpy(float)
    return np.where(spread > 0.0, 0.5 * SPEED_OF_LIGHT * _PICO * spread, np.nan)


def _wavelengths(path: FilePath, one: _Pass) -> np.ndarray:
    """Return the wavelength (n,) of each point [m], by the system that its record names."""
    lengths = []
    for number, words in one.points:
        if words[3] not in one.wavelengths:
            raise line_error(path, number, f"a record C0 of {words[3]} in the pass", "none")
        line, setup = one.wavelengths[words[3]]
        length = numbers(path, np.array([[setup[2]]]), np.array([line]))[0, 0]
        if not _LIGHT[0] <= length <= _LIGHT[1]:
            raise line_error(path, line, f"a wavelength of {_LIGHT[0]:g} to {_LIGHT[1]:g} nm", setup[2])
        lengths.append(length * _NANO)
    return np.array(lengths)


def _weather(path: FilePath, one: _Pass, seconds: np.ndarray) -> dict[str, np.ndarray]:
    """Return pressure, temperature and humidity (n,) at seconds (n,) of the pass, between its records."""
    if not one.weather:
        raise line_error(path, one.points[0][0], "a record 20 of the weather in the pass", "none")
    lines = np.array([number for number, _ in one.weather])
    values = numbers(path, np.array([words[1:5] for _, words in one.weather]), lines)
    for (number, words), row in zip(one.weather, values[:, 1:], strict=True):
        for value, word, (low, high, what) in zip(row, words[2:5], _WEATHER, strict=True):
            if not low <= value <= high:
                raise line_error(path, number, f"{what} of {low:g} to {high:g}", word)
    at = _since_midnight(path, one, values[:, 0])
    order = np.argsort(at, kind="stable")
    units = {"pressure": _HECTO, "temperature": 1.0, "humidity": _PERCENT}
    return {
        name: np.interp(seconds, at[order], values[order, k]) * unit
        for k, (name, unit) in enumerate(units.items(), 1)
    }
