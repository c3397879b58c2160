"""Reader of orbits in the ILRS's consolidated prediction format (CPF), versions 1 and 2.

Positions are in m in the ITRF, times in UTC. Velocities, in m/s, are rare.
Source: Ricklefs 2006, Consolidated Laser Ranging Prediction Format, version 1.01; the same, version 2, 2018.
"""

import re
from collections.abc import Sequence

import numpy as np

from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.base.files import FilePath
from opml.interop.object_ids import ObjectId
from opml.interop.orbit_arcs import Arc, check_ascending, choose_satellites, line_error, numbers, times

_NAME = {"1": 9, "2": 10}  # word of the first line with the satellite's name, by version
_IDS = slice(1, 4)  # words of the second line: COSPAR, SIC and NORAD number
_FRAME = 19  # word of the second line from which on these are 0; the last two may be missing
_ZEROS = (
    "reference frame 0, the ITRF",
    "rotation angles 0, of no body that turns",
    "0 for the centre of mass, not the reflectors'",
)
_MJD_ZERO = np.datetime64("1858-11-17")
_PASSED_OVER = re.compile(r"00|30|40|50|60|70|H[3459]")
_Row = tuple[int, list[str]]  # line and words


def read(path: FilePath, content: bytes, *, epoch: str, satellite: str | None = None) -> list[Arc]:
    """Read the arc of a CPF file.

    satellite: name, COSPAR, SIC or NORAD number; None: any satellite

    Raises InputError, naming the line, for a malformed or truncated file, another satellite and another
    frame.
    """
    rows = [(n, line.split()) for n, line in enumerate(content.decode("latin-1").splitlines(), 1)]
    rows = [(n, words) for n, words in rows if words]
    name, number = _satellite(path, rows, satellite)
    positions, velocities = _records(path, rows[2:])
    lines = np.array([number for number, _ in positions])
    t = _times(path, positions, lines, epoch)
    return [
        Arc(
            path=path,
            satellite=name,
            frame="ITRF",
            realisation="ITRF",
            scale="UTC",
            t=t,
            positions=numbers(path, np.array([words[5:8] for _, words in positions]), lines),
            velocities=_velocities(path, velocities),
            lines=lines,
            identity=ObjectId.of(name, number),
        )
    ]


def _satellite(path: FilePath, rows: Sequence[_Row], wanted: str | None) -> tuple[str, str]:
    number, first = rows[0]
    version = first[2].lstrip("0") if len(first) > 2 else ""
    if version not in _NAME or len(first) <= _NAME[version]:
        raise line_error(path, number, "H1 CPF of version 1 or 2, with the satellite's name", " ".join(first))
    number, second = rows[1] if len(rows) > 1 else (number + 1, [""])
    if len(second) <= _FRAME or second[0].upper() != "H2":
        raise line_error(path, number, "H2 with ids, times and reference frame", " ".join(second))
    for word, zero in zip(second[_FRAME:], _ZEROS, strict=False):
        if word != "0":
            raise line_error(path, number, zero, word)
    name = first[_NAME[version]]
    ids = second[_IDS]
    choose_satellites(path, [[name, *ids]], wanted)
    return name, ids[-1]


def _records(path: FilePath, rows: Sequence[_Row]) -> tuple[list[_Row], list[_Row | None]]:
    """Return the records of positions, and that of the velocity at each, if there is one."""
    positions: list[_Row] = []
    velocities: list[_Row | None] = []
    for number, words in rows:
        match words[0].upper():
            case "10" if len(words) == 8:
                positions.append((number, words))
                velocities.append(None)
            case "20" if len(words) == 5 and positions and velocities[-1] is None:
                velocities[-1] = number, words
            case "99" if number == rows[-1][0] and positions:
                return positions, velocities
            case kind if _PASSED_OVER.fullmatch(kind) is None:
                raise line_error(path, number, "a record 10 or 20, or 99 at the end", " ".join(words))
    raise InputError(f"{path}: expected positions and a line 99 at the end, got neither")


def _times(path: FilePath, positions: Sequence[_Row], lines: np.ndarray, epoch: str) -> np.ndarray:
    for number, (_, flag, _, _, leap, *_) in positions:
        if (flag, leap) != ("0", "0"):
            raise line_error(path, number, "direction flag 0 and leap second flag 0", f"{flag} and {leap}")
    day, second = numbers(path, np.array([words[2:4] for _, words in positions]), lines).T
    strange = np.flatnonzero(
        (day % 1.0 != 0.0) | (day < 4e4) | (day > 9e4) | (second < 0.0) | (second >= DAY)
    )
    if strange.size:
        number, words = positions[strange[0]]
        expected = "a modified Julian date and second of the day"
        raise line_error(path, number, expected, " ".join(words[2:4]))
    date = (_MJD_ZERO + day.astype(int)).astype("M8[D]")
    year, month = date.astype("M8[Y]"), date.astype("M8[M]")
    calendar = [year.astype(int) + 1970, (month - year).astype(int) + 1, (date - month).astype(int) + 1]
    clock = [second // 3600.0, second % 3600.0 // 60.0, second % 60.0]
    texts = [" ".join(words[2:4]) for _, words in positions]
    t = times(path, lines, texts, np.stack([*calendar, *clock], axis=1), epoch=epoch, scale="UTC")
    check_ascending(path, t, lines)
    return t


def _velocities(path: FilePath, rows: Sequence[_Row | None]) -> np.ndarray:
    """Return the velocities (n, 3) [m/s], not finite where absent."""
    velocities = np.full((len(rows), 3), np.nan)
    records = [(k, row) for k, row in enumerate(rows) if row is not None]
    if records:
        lines = np.array([number for _, (number, _) in records])
        texts = np.array([words[2:5] for _, (_, words) in records])
        velocities[[k for k, _ in records]] = numbers(path, texts, lines)
    return velocities
