"""Reader of stations' coordinates, velocities and eccentricities in SINEX.

Source: IERS, Solution (Software/technique) INdependent EXchange format, version 2.02.
"""

import re
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import numpy as np
import pandas as pd

from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.base.files import FilePath
from opml.interop.orbit_arcs import contents, line_error, numbers

_COORDINATES = {"STAX": "x", "STAY": "y", "STAZ": "z", "VELX": "vx", "VELY": "vy", "VELZ": "vz"}
_UNITS = {"x": "m", "y": "m", "z": "m", "vx": "m/y", "vy": "m/y", "vz": "m/y"}
_TIME = re.compile(r"(\d\d):(\d{3}):(\d{5})", re.ASCII)
_AXES, _WIDTH = 45, 9  # first column of an eccentricity, and columns of each axis
_LONGEST_YEAR = 366  # days
_CENTURY = 50  # years of two digits up to this one are of this century, later ones of the last

_YEAR = 365.25 * 86400.0
_Row = tuple[int, list[str], str]  # line, words and text


def read_coordinates(path: FilePath) -> pd.DataFrame:
    """Read the solutions of stations: a row for each point of a station and span of time.

    Columns: station, its code; point, of its site; begin and end of the span, and reference, dates to the
    second (NaT where open); x, y, z [m] at the reference in ITRF; vx, vy, vz [m/s]. Raises InputError, naming
    file and line, for a malformed file or a solution that lacks a coordinate.
    """
    spans = {
        tuple(words[:3]): (_date(path, line, words[4]), _date(path, line, words[5]))
        for line, words, _ in _block(path, "SOLUTION/EPOCHS", 7)
    }
    solutions: dict[tuple[str, ...], dict[str, Any]] = {}
    for line, words, _ in _block(path, "SOLUTION/ESTIMATE", 9):
        if words[1] not in _COORDINATES:
            continue
        name, key = _COORDINATES[words[1]], tuple(words[2:5])
        if words[6] != _UNITS[name]:
            raise line_error(path, line, f"{words[1]} in {_UNITS[name]}", words[6])
        begin, end = spans.get(key, (pd.NaT, pd.NaT))
        row = solutions.setdefault(key, {"station": words[2], "point": words[3], "begin": begin, "end": end})
        row["reference"] = _date(path, line, words[5])
        value = float(numbers(path, np.array([[words[8]]]), np.array([line]))[0, 0])
        row[name] = value / _YEAR if name.startswith("v") else value
    return _table(path, solutions.values(), ["station", "point", "begin", "end", "reference", *_UNITS])


def read_eccentricities(path: FilePath) -> pd.DataFrame:
    """Read how far instruments stand off from their stations' marks: a row for each of them and span.

    Columns: station and system, whose codes together name an instrument; begin and end, as in
    `read_coordinates`; up, north, east [m]. Raises InputError, naming file and line, for a malformed file and
    eccentricities on other axes.
    """
    rows = []
    for line, words, text in _block(path, "SITE/ECCENTRICITY", 9):
        if words[6] != "UNE":
            raise line_error(path, line, "eccentricities UNE", words[6])
        # Columns of fixed widths, in which numbers touch.
        axes = [text[column : column + _WIDTH] for column in range(_AXES, _AXES + 3 * _WIDTH, _WIDTH)]
        away = numbers(path, np.array([axes]), np.array([line]))[0]
        begin, end = (_date(path, line, word) for word in words[4:6])
        row = {"station": words[0], "system": words[-1][4:], "begin": begin, "end": end}
        rows.append(row | dict(zip(("up", "north", "east"), away.tolist(), strict=True)))
    return _table(path, rows, ["station", "system", "begin", "end", "up", "north", "east"])


def _table(path: FilePath, rows: Iterable[Mapping[str, Any]], columns: list[str]) -> pd.DataFrame:
    table = pd.DataFrame(list(rows), columns=columns)
    numeric = table.drop(columns=["begin", "end"])
    if table.empty or numeric.isna().any(axis=None):
        lacking = "" if table.empty else f", of {table['station'][numeric.isna().any(axis=1)].iloc[0]}"
        raise InputError(f"{path}: expected stations with all of {', '.join(columns)}, got none{lacking}")
    return table


def _block(path: FilePath, name: str, fewest: int) -> Iterator[_Row]:
    """Yield lines and words of a block of a file, remarks left out.

    Raises InputError for a file that is no SINEX or lacks the block, and for lines with too few words.
    """
    texts = contents(path).decode("latin-1").splitlines()
    if not texts or not texts[0].startswith("%=SNX"):
        raise line_error(path, 1, "%=SNX", texts[0] if texts else "")
    stripped = [text.strip() for text in texts]
    if f"+{name}" not in stripped or f"-{name}" not in stripped:
        raise InputError(f"{path}: expected a block +{name} to -{name}, got none")
    first, last = stripped.index(f"+{name}"), stripped.index(f"-{name}")
    for line, text in enumerate(texts[first + 1 : last], first + 2):
        words = text.split()
        if text.startswith("*") or not words:
            continue
        if len(words) < fewest:
            raise line_error(path, line, f"{fewest} words or more in {name}", text)
        yield line, words, text


def _date(path: FilePath, line: int, text: str) -> pd.Timestamp:
    """Return the date of a text, NaT for an open one."""
    match = _TIME.fullmatch(text)
    if match is None:
        raise line_error(path, line, "a time YY:DDD:SSSSS", text)
    year, day, second = map(int, match.groups())
    if (year, day, second) == (0, 0, 0):
        return pd.NaT
    if day > _LONGEST_YEAR or second > DAY:
        raise line_error(path, line, "a day of the year and a second of the day", text)
    first = pd.Timestamp(year + (2000 if year <= _CENTURY else 1900), 1, 1)
    return first + pd.Timedelta(days=day - 1, seconds=second)
