"""Reader of positions, with velocities or without, from CSV: the fixes of a GPS receiver.

The first line says what the columns are; a column called - is passed over:

    gps,x_itrf_m,y_itrf_m,z_itrf_m,-,sigma_r_m,sigma_s_m,sigma_w_m
    2019-09-03T00:00:00.000,1602171.9,5991628.1,-2835238.7,0.9,3,6,3

Cells are between commas, semicolons, tabs or blanks; the line may begin with #, and between other separators
numbers may have decimal commas. Times are in UTC, GPS, TAI, TT or Unix seconds, states in ITRF, GCRF or
EME2000, lengths in m or km. Standard deviations are those along the radial direction, along the track and
across it. Names may be others in use, as `Time (UTCG)`, `x_ecef (km)` or GMAT's `Sat.EarthMJ2000Eq.VX`. A
file without a frame is refused; without a unit, that counts in which the positions are those of an orbit.
"""

import csv
import logging
import re
from collections.abc import Iterator, Sequence
from datetime import UTC, datetime

import numpy as np

from opml.base.errors import InputError
from opml.base.files import FilePath
from opml.interop.orbit_arcs import EVERY, Arc, check_ascending, line_error, numbers, times

PASSED_OVER = "-"  # name of a column that is not read
SCALES = ("utc", "gps", "tai", "tt")  # names of columns of times
UNIX = "unix"  # that of seconds of UTC since 1970 without leap seconds

EXAMPLE = "utc,x_itrf_m,y_itrf_m,z_itrf_m"

_FRAMES = {
    **dict.fromkeys(("itrf", "ecef", "ecf", "wgs84", "earthfixed"), "ITRF"),
    **dict.fromkeys(("gcrf", "icrf"), "GCRF"),
    **dict.fromkeys(("eme2000", "j2000", "mj2000eq", "earthmj2000eq"), "EME2000"),
}
_UNITS = {"m": 1.0, "km": 1e3, "mps": 1.0, "kmps": 1e3}
_GROUPS = (("x", "y", "z"), ("vx", "vy", "vz"), ("r", "s", "w"), ("vr", "vs", "vw"))
_WORDS = {
    "axis": {
        **{axis: axis for group in _GROUPS for axis in group},
        **{f"{before}{axis}": axis for before in "pr" for axis in _GROUPS[0]},
    },
    "frame": _FRAMES,
    "unit": {unit: unit for unit in _UNITS},
    "of": {"sigma": "", "position": "", "pos": "", "velocity": "v", "vel": "v"},
    "scale": {UNIX: UNIX} | {f"{scale}{end}": scale for scale in SCALES for end in ("", "g", "gregorian")},
    "time": dict.fromkeys(("t", "time", "epoch", "date", "datetime", "timestamp"), ""),
}
"""Meanings of words in the name of a column, by subject."""

_MEANINGS = {word: (about, says) for about, words in _WORDS.items() for word, says in words.items()}
_PER_SECOND = re.compile(r"(k?m)[/_]s(?:ec)?(?![a-z0-9])")
_UNIX_NAME = re.compile(r"\b(?:unix|posix)[_ ]?(?:time|timestamp)?(?:[_ ]\(?s\)?)?$")
_UNIX_TIME = re.compile(r"(\d{9,10})(\.\d*)?", re.ASCII)
_OF_OBJECT = re.compile(r"(\w+)\.(?=\w)")  # an object's name before that of a column
_BEGIN = 65_536  # bytes in which a file has its first line
_LEAST_METRES = 1e6  # from which on positions are in m: an orbit's are 6e3 to 6e5 km
_DATE = r"(?P<year>\d{4})[-/](?P<month>\d\d)[-/](?P<day>\d\d)[T ]"
_MONTHS = ("jan", "feb", "mar", "apr", "may", "jun", "jul", "aug", "sep", "oct", "nov", "dec")
_NAMED_MONTH = rf"(?P<day>\d\d?) (?P<month>{'|'.join(_MONTHS)}) (?P<year>\d{{4}}) "
_CLOCK = r"(?P<clock>\d\d:\d\d:\d\d(?:\.\d+)?)(?P<zone>Z|\+00:00)?"
_TIMES = [re.compile(date + _CLOCK, re.ASCII | re.IGNORECASE) for date in (_DATE, _NAMED_MONTH)]

_log = logging.getLogger(__name__)


def matches(content: bytes) -> bool:
    """Return whether the first line of a file has columns."""
    _, first = next(_without_comments(content[:_BEGIN].decode("utf-8", errors="replace")), (0, ""))
    return first.count(",") >= len(_GROUPS[0]) or _names_columns(first)


def _names_columns(line: str) -> bool:
    meanings = [_meaning(name) for name in re.split(_separator(line), line.strip())]
    return len(meanings) > len(_GROUPS[0]) and any({"scale", "time"} & one.keys() for one in meanings)


def read(path: FilePath, content: bytes, *, epoch: str, satellite: str | None = None) -> list[Arc]:
    """Read the points of a CSV with their standard deviations, an arc.

    Raises InputError for a requested satellite, and, naming the line, for columns of which no points
    can be made, a cell that is no number or no time, and times that do not ascend.
    """
    if satellite not in (None, EVERY):
        raise InputError(f"{path}: expected no name of an object, as a CSV has none, got {satellite}")
    (number, names), *rows = _lines(path, content)
    columns = _Columns(path, number, [name.strip().lower() for name in names])
    if not rows:
        raise InputError(f"{path}: expected points below its first line, got none")
    for line, cells in rows:
        if len(cells) != len(names):
            raise line_error(path, line, f"{len(names)} cells, as in its first line", f"{len(cells)}")
    lines, table = np.array([line for line, _ in rows]), np.array([cells for _, cells in rows])
    t = _times(path, table[:, columns.time], lines, columns, epoch)
    check_ascending(path, t, lines)
    unnamed = columns.unnamed_unit(table, lines)
    positions, velocities, *deviations = (columns.values(table, lines, group, unnamed) for group in _GROUPS)
    sigmas = np.concatenate(deviations, axis=1)
    wrong = np.flatnonzero((sigmas <= 0.0).any(axis=1))
    if wrong.size:
        got = f"{np.nanmin(sigmas[wrong[0]]):g}"
        raise line_error(path, int(lines[wrong[0]]), "standard deviations above 0", got)
    frame, scale = columns.frame, columns.calendar_scale
    return [Arc(path, "", frame, frame, scale, t, positions, velocities, lines, sigmas=sigmas)]


def _lines(path: FilePath, content: bytes) -> list[tuple[int, list[str]]]:
    try:
        text = content.decode()
    except UnicodeDecodeError as reason:
        raise InputError(f"{path}: expected CSV in UTF-8 text, got none ({reason})") from None
    lines = list(_without_comments(text))
    if not lines:
        raise InputError(f"{path}: expected a line of columns, such as {EXAMPLE}, got an empty file")
    separator = _separator(lines[0][1])
    return [(number, _cells(path, number, line, separator)) for number, line in lines]


def _without_comments(text: str) -> Iterator[tuple[int, str]]:
    """Yield the numbered lines that are no comments, with a last one above them that names the columns."""
    comment, begun = (0, ""), False
    for number, line in enumerate(text.splitlines(), start=1):
        if line.startswith("#"):
            comment = number, line.lstrip("# \t")
        elif line.strip():
            if not begun and line.lstrip()[0].isdigit() and _names_columns(comment[1]):
                yield comment
            begun = True
            yield number, line


def _cells(path: FilePath, number: int, line: str, separator: str) -> list[str]:
    if "\0" in line:
        raise line_error(path, number, "text", "bytes that are none")
    if len(separator) > 1:
        cells = re.split(separator, line.strip())
        return [cell.replace(",", ".") for cell in cells]
    try:
        cells = next(csv.reader([line], strict=True, delimiter=separator))
    except csv.Error as reason:
        raise line_error(path, number, "cells of CSV", str(reason)) from None
    return cells if separator == "," else [cell.replace(",", ".") for cell in cells]


def _separator(first: str) -> str:
    """Return what is between the cells of a file by its first line: a character, or a pattern of blanks."""
    blanks = r"\s\s+" if len(re.split(r"\s\s+", first.strip())) > len(_GROUPS[0]) else r"\s+"
    return next((one for one in "\t;," if one in first), blanks)


def _meaning(name: str) -> dict[str, str]:
    """Return what the words of a column's name say, by what they are about; nothing for an unknown one."""
    name, meaning = _PER_SECOND.sub(r"\1ps", name.strip().lower()), dict[str, str]()
    name = _UNIX_NAME.sub(UNIX, name)
    if (of_object := _OF_OBJECT.match(name)) and of_object[1] not in _MEANINGS:
        name = name[of_object.end() :]
    for word in re.findall(r"[^\W_]+", re.sub(r"itrf\d+", "itrf", name)):
        about, says = _MEANINGS.get(word, ("", ""))
        if not about or about in meaning:
            return {}
        meaning[about] = says
    if "axis" in meaning:
        meaning["axis"] = meaning.get("of", "") + meaning["axis"].removeprefix(meaning.get("of", ""))
    return meaning


class _Columns:
    """The columns of a CSV: their places by axis, with their units."""

    def __init__(self, path: FilePath, number: int, names: Sequence[str]) -> None:
        """Take the names in the first line, which has a number. Raises InputError for others than known."""
        self.path, self.number = path, number
        self._places: dict[str, tuple[int, str]] = {}  # '' without a unit
        times, frames = [], set()
        for place, name in enumerate(names):
            meaning = _meaning(name)
            if names.count(name) > 1 and name != PASSED_OVER:
                raise self._wrong(f"one column {name}", f"{names.count(name)}")
            if "axis" in meaning:
                self._add(name, meaning, place)
                frames |= {meaning.get("frame", "none")} if meaning["axis"][-1] in "xyz" else set()
            elif meaning.keys() & {"scale", "time"}:
                times.append((place, meaning.get("scale", "")))
            elif name != PASSED_OVER:
                frames_read = "itrf (or ecef), gcrf (icrf) or eme2000 (j2000)"
                raise self._wrong(f"columns such as {EXAMPLE}, in {frames_read}, - for others", name)
        if len(times) != 1:
            raise self._wrong(
                f"one column of times, {', '.join(SCALES[:-1])} or {SCALES[-1]}", f"{len(times)}"
            )
        self.time, self.scale = times[0]
        self._check_groups()
        if len(frames) != 1 or frames == {"none"}:
            expected = "one frame in the names of all of a state, such as x_itrf_m or x_gcrf_km"
            raise self._wrong(expected, " and ".join(sorted(frames)))
        self.frame = frames.pop()

    @property
    def calendar_scale(self) -> str:
        """The time system of the dates that the times stand for."""
        return "UTC" if self.scale in ("", UNIX) else self.scale.upper()

    def _add(self, name: str, meaning: dict[str, str], place: int) -> None:
        axis, unit = meaning["axis"], meaning.get("unit", "")
        is_sigma = axis.removeprefix("v") in "rsw"
        if is_sigma != name.startswith("sigma") or meaning.keys() & {"scale", "time"}:
            raise self._wrong(f"columns such as {EXAMPLE}", name)
        if unit.endswith("ps") != axis.startswith("v") and (unit or is_sigma):
            expected = "mps or kmps for a velocity, m or km for a length"
            raise self._wrong(f"{expected} in {name}", unit)
        if axis in self._places:
            raise self._wrong(f"one column of {axis}", "two")
        self._places[axis] = place, unit

    def _check_groups(self) -> None:
        """Raise InputError where positions are not whole, or other columns that belong together are not."""
        for group in _GROUPS:
            there = [axis for axis in group if axis in self._places]
            if len(there) not in (0, len(group)) or (group is _GROUPS[0] and not there):
                raise self._wrong(f"columns of {', '.join(group)}", ", ".join(there) or "none of them")
        if "vr" in self._places and "vx" not in self._places:
            raise self._wrong("velocities with their standard deviations", "none")

    def unnamed_unit(self, table: np.ndarray, lines: np.ndarray) -> float:
        """Return what a length without a unit is in m: one of the positions, if need be by their radius."""
        named = {self._places[axis][1] for axis in _GROUPS[0]}
        if "" not in named:
            return min(_UNITS[unit] for unit in named)
        if named != {""}:
            raise self._wrong("units of all of x, y and z, or of none", ", ".join(sorted(named)))
        radius = float(np.median(np.linalg.norm(self.values(table, lines, _GROUPS[0], 1.0), axis=1)))
        unit = "m" if radius >= _LEAST_METRES else "km"
        message = "%s: lengths are taken as %s: no column names a unit, and positions are %.5g long"
        _log.warning(message, self.path, unit, radius)
        return _UNITS[unit]

    def values(
        self, table: np.ndarray, lines: np.ndarray, group: Sequence[str], unnamed: float
    ) -> np.ndarray:
        """Return the numbers (n, 3) of a group of axes in SI; NaN where the CSV has no such columns.

        unnamed: what a unit that is not named is in SI
        """
        if group[0] not in self._places:
            return np.full((len(table), len(group)), np.nan)
        places, units = zip(*(self._places[axis] for axis in group), strict=True)
        factors = [_UNITS.get(unit, unnamed) for unit in units]
        return numbers(self.path, table[:, list(places)], lines) * np.array(factors)

    def _wrong(self, expected: str, got: str) -> InputError:
        return line_error(self.path, self.number, expected, got)


def _times(path: FilePath, texts: np.ndarray, lines: np.ndarray, columns: _Columns, epoch: str) -> np.ndarray:
    fields = _unix_fields if columns.scale == UNIX else _calendar_fields
    calendar = []
    for text, line in zip(texts, lines, strict=True):
        try:
            calendar.append(fields(text.strip(), columns.scale))
        except ValueError as expected:
            raise line_error(path, int(line), str(expected), str(text)) from None
    fields_of_all = np.array(calendar, dtype=float)
    return times(path, lines, texts, fields_of_all, epoch=epoch, scale=columns.calendar_scale)


def _calendar_fields(text: str, scale: str) -> list[str]:
    """Return year to second of a date. Raises ValueError that says what was expected."""
    match = next(filter(None, (one.fullmatch(text) for one in _TIMES)), None)
    if match is None:
        raise ValueError("a time such as 2019-09-03T00:00:00.000")
    if not (scale or match["zone"]):
        raise ValueError(f"{', '.join(SCALES)} in the name of the column of times, or times that end in Z")
    month = match["month"].lower()
    number = str(_MONTHS.index(month) + 1) if month in _MONTHS else month
    return [match["year"], number, match["day"], *match["clock"].split(":")]


def _unix_fields(text: str, _: str) -> list[str]:
    """Return year to second of a Unix time. Raises ValueError that says what was expected."""
    if not (match := _UNIX_TIME.fullmatch(text)):
        raise ValueError("Unix seconds such as 1567468800.0")
    *fields, second = datetime.fromtimestamp(int(match[1]), UTC).strftime("%Y %m %d %H %M %S").split()
    return [*fields, second + (match[2] or "")]
