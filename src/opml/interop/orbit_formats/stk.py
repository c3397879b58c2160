"""Reader of ephemerides of Ansys STK (.e): positions, velocities and covariances about the Earth.

Times count from the ScenarioEpoch in UTC, lengths are in metres where DistanceUnit names no others, and
covariances are in the axes of the states. Source: Ansys STK, Ephemeris file format (*.e).
"""

import re
from collections.abc import Collection
from datetime import datetime
from pathlib import Path

import numpy as np

from opml.base import epochs
from opml.base.errors import InputError
from opml.base.files import FilePath
from opml.interop.object_ids import ObjectId
from opml.interop.orbit_arcs import Arc, check_ascending, choose_satellites, line_error, numbers
from opml.tables import lower_triangles

_UNITS = {"meters": 1.0, "meter": 1.0, "kilometers": 1e3, "kilometer": 1e3}
_FRAMES = {"j2000": "EME2000", "icrf": "GCRF", "fixed": "ITRF"}
_STATES = {"ephemeristimepos": 4, "ephemeristimeposvel": 7, "ephemeristimeposvelacc": 10}
_COVARIANCES = {"covariancetimepos": 7, "covariancetimeposvel": 22}
_PLAIN = {"centralbody": ("earth",), "timeformat": ("epsec",)}
"""Values that keys may have where they are given."""

_SECTION = re.compile(r"(?:ephemeris|covariance)\w+|end", re.IGNORECASE)
_Row = tuple[int, list[str]]  # line and words


def read(path: FilePath, content: bytes, *, epoch: str, satellite: str | None = None) -> list[Arc]:
    """Read the arc of an ephemeris; satellite: as in `choose_satellites`, the file's name without suffixes.

    Raises InputError, naming the line, for a malformed file, another central body, frame or unit, and times
    that do not ascend.
    """
    keys, tables = _parts(path, content.decode("latin-1"))
    for key, allowed in _PLAIN.items():
        _choice(path, keys, key, allowed, allowed[0])
    unit = _UNITS[_choice(path, keys, "distanceunit", _UNITS, "meters")]
    frame = _FRAMES[_choice(path, keys, "coordinatesystem", _FRAMES, "")]
    begin = epochs.seconds_between(epoch, _scenario_epoch(path, keys))
    name = Path(path).name.partition(".")[0]
    choose_satellites(path, [[name]], satellite)
    lines, states = _table(path, tables, _STATES)
    if not len(states):
        raise InputError(f"{path}: expected EphemerisTimePosVel with states, got none")
    covariance_lines, known = _table(path, tables, _COVARIANCES)
    velocities = unit * states[:, 4:7] if states.shape[1] > 4 else np.full((len(states), 3), np.nan)
    t = begin + states[:, 0]
    check_ascending(path, t, lines)
    check_ascending(path, known[:, 0], covariance_lines)
    is_whole = known.shape[1] == _COVARIANCES["covariancetimeposvel"] and frame != "ITRF"
    return [
        Arc(
            path=path,
            satellite=name,
            frame=frame,
            realisation=frame,
            scale="UTC",
            t=t,
            positions=unit * states[:, 1:4],
            velocities=velocities,
            lines=lines,
            identity=ObjectId(name),
            covariance_t=begin + known[:, 0] if is_whole else np.empty(0),
            covariances=lower_triangles(unit**2 * known[:, 1:]) if is_whole else np.empty((0, 6, 6)),
        )
    ]


def _parts(path: FilePath, text: str) -> tuple[dict[str, _Row], dict[str, list[_Row]]]:
    """Return the keys of a file with their values, and the rows of its tables, all by small letters."""
    keys: dict[str, _Row] = {}
    tables: dict[str, list[_Row]] = {}
    rows: list[_Row] | None = None
    for number, line in enumerate(text.splitlines(), start=1):
        words = line.partition("#")[0].split()
        if not words:
            continue
        if _SECTION.fullmatch(words[0]) and len(words) < 3:
            rows = tables.setdefault(words[0].lower(), [])
        elif words[0][0].isalpha() or rows is None:
            keys[words[0].lower()] = number, words[1:]
        else:
            rows.append((number, words))
    if "end" not in tables:
        raise InputError(f"{path}: expected END Ephemeris, got the end of the file")
    return keys, tables


def _choice(path: FilePath, keys: dict[str, _Row], key: str, allowed: Collection[str], usual: str) -> str:
    number, words = keys.get(key, (1, [usual]))
    value = " ".join(words)
    if value.lower() not in allowed:
        raise line_error(path, number, f"{key} {' or '.join(allowed)}", value)
    return value.lower()


def _scenario_epoch(path: FilePath, keys: dict[str, _Row]) -> str:
    number, words = keys.get("scenarioepoch", (1, []))
    try:
        day = datetime.strptime(" ".join(words[:3]), "%d %b %Y").date().isoformat()
        text = f"{day}T{' '.join(words[3:])}"
        epochs.parse(text)
    except (ValueError, InputError):
        raise line_error(path, number, "ScenarioEpoch 1 Jan 2020 00:00:00.000", " ".join(words)) from None
    return text


def _table(
    path: FilePath, tables: dict[str, list[_Row]], widths: dict[str, int]
) -> tuple[np.ndarray, np.ndarray]:
    """Return lines (n,) and numbers (n, k) of the table of a kind, none where it is not there."""
    kind = next((name for name in widths if tables.get(name)), "")
    if not kind:
        return np.empty(0, int), np.empty((0, 1))
    for number, words in tables[kind]:
        if len(words) != widths[kind]:
            raise line_error(path, number, f"{widths[kind]} numbers of {kind}", " ".join(words))
    lines = np.array([number for number, _ in tables[kind]])
    return lines, numbers(path, np.array([words for _, words in tables[kind]]), lines)
