"""Reader of orbits in SP3-c and SP3-d, the format of the services of IGS, ILRS and IDS.

Positions are in km, velocities in dm/s, both in a realisation of the ITRF. Columns count from 0 here.
Source: Hilla 2010, The Extended Standard Product 3 Orbit Format (SP3-c); Hilla 2016, the same for SP3-d.
"""

import logging
import re
from dataclasses import dataclass
from itertools import takewhile

import numpy as np

from opml.base.errors import InputError
from opml.base.files import FilePath
from opml.interop.orbit_arcs import Arc, check_ascending, choose_satellites, line_error, numbers, times

_SCALES = ("GPS", "UTC", "TAI", "GAL", "QZS")  # time systems for reading
_WIDTH = 80  # of a line
_FIRST = re.compile(rb"#[cd][PV]\d{4}.{24} ( *\d+) ")
_TERRESTRIAL = re.compile(r"ITR|IG[SbR]|SLR|WGS|ECF|DPOD", re.IGNORECASE)
_FIELDS = ((3, 7), (8, 10), (11, 13), (14, 16), (17, 19), (20, 31))  # year to second of an epoch
_AXES = ((4, 18), (18, 32), (32, 46))
_KILOMETRE, _DECIMETRE = 1e3, 1e-1
_STEPS_BEND = 0.2  # part by which a step from point to point may be shorter than the speed says
_MANOEUVRE, _PREDICTED = 78, 79  # columns of flags of a position
_ABSENT = 999999.0  # numbers from here on mark an absent vector, as three zeros do


_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class _Header:
    epochs: int
    realisation: str
    scale: str
    satellites: list[str]


def read(path: FilePath, content: bytes, *, epoch: str, satellite: str | None = None) -> list[Arc]:
    """Read the arc of a satellite in an SP3 file.

    satellite: as in `choose_satellites`, an id such as L47

    Positions marked as bad, absent or predicted are left out, those predicted are counted in the log. A mark
    of a manoeuvre is one halfway from the epoch before. Raises InputError, naming the line, for a malformed
    or truncated file, another frame and another time system.
    """
    lines = content.splitlines()
    header = _header(path, lines)
    rows = np.array(lines, dtype=f"S{_WIDTH}")
    _check_kinds(path, rows)
    t, epoch_rows = _epochs(path, rows, header, epoch)
    chosen = choose_satellites(path, [[name] for name in header.satellites], satellite)
    return [_arc(path, rows, header, header.satellites[k], t, epoch_rows) for k in chosen]


def _arc(
    path: FilePath, rows: np.ndarray, header: _Header, name: str, t: np.ndarray, epoch_rows: np.ndarray
) -> Arc:
    positions, position_lines = _vectors(path, rows, f"P{name}", epoch_rows)
    velocities, _ = _vectors(path, rows, f"V{name}", epoch_rows)
    known = np.isfinite(positions[:, 0])
    predicted = known & (_flags(rows, position_lines, _PREDICTED) == b"P")
    if predicted.any():
        _log.warning("%s: predicted positions left out: %d", path, predicted.sum())
        known &= ~predicted
    marked = (position_lines > 0) & (_flags(rows, position_lines, _MANOEUVRE) == b"M")
    if not known.any():
        message = (
            f"{path}: expected a position of {name}, got none: those at 0 or beyond 999999 km are absent, "
            "and predicted ones do not count"
        )
        raise InputError(message)
    return Arc(
        path=path,
        satellite=name,
        frame="ITRF",
        realisation=header.realisation,
        scale=header.scale,
        t=t[known],
        positions=positions[known] * _KILOMETRE,
        velocities=velocities[known] * _unit_of_velocities(path, t, positions, velocities),
        lines=position_lines[known],
        burns=(0.5 * (t + np.append(t[:1], t[:-1])))[marked].tolist(),
    )


def _unit_of_velocities(
    path: FilePath, t: np.ndarray, positions: np.ndarray, velocities: np.ndarray
) -> float:
    """Return the format's unit [m/s], or metres where positions show that a file's velocities have them."""
    moved = np.linalg.norm(np.diff(positions, axis=0), axis=1) * _KILOMETRE / np.diff(t)
    unit = moved / np.linalg.norm(velocities[1:], axis=1)
    known = unit[np.isfinite(unit)]
    if not (len(known) and abs(np.median(known) - 1.0) < _STEPS_BEND):
        return _DECIMETRE
    _log.warning("%s: velocities are taken for m/s, as positions show, not for dm/s", path)
    return 1.0


def _header(path: FilePath, lines: list[bytes]) -> _Header:
    first = _FIRST.match(lines[0].ljust(_WIDTH))
    if first is None:
        raise line_error(path, 1, "the first line of SP3-c or SP3-d", lines[0])
    realisation = lines[0][46:51].decode("latin-1").strip()
    if not _TERRESTRIAL.match(realisation):
        raise line_error(path, 1, "a realisation of the ITRF, such as IGS14", realisation)
    number, line = next(
        ((n, line) for n, line in enumerate(lines, 1) if line.startswith(b"%c")), (len(lines), b"")
    )
    scale = line[9:12].decode("latin-1")
    if scale not in _SCALES:
        raise line_error(path, number, f"a line %c with time system {' or '.join(_SCALES)}", line)
    return _Header(int(first[1]), realisation, scale, _satellites(path, lines))


def _satellites(path: FilePath, lines: list[bytes]) -> list[str]:
    head = takewhile(lambda line: not line.startswith(b"*"), lines)
    listed = [line.decode("latin-1") for line in head if line.startswith(b"+ ")]
    ids = [line[k : k + 3] for line in listed for k in range(9, 60, 3)]
    count = listed[0][1:6].strip() if listed else ""
    names = [name for name in ids if name.strip() not in ("", "0")]
    if not (count.isdecimal() and 0 < int(count) == len(names)):
        raise InputError(f"{path}: expected the ids of {count or 'its'} satellites, got {len(names)}")
    return names


def _check_kinds(path: FilePath, rows: np.ndarray) -> None:
    kinds = _column(rows, 0, 1)
    head = np.isin(kinds, [b"#", b"+", b"%", b"/"])
    body = np.isin(kinds, [b"*", b"P", b"V", b"E", b""])
    start = int(np.argmin(head)) if not head.all() else len(rows)
    misplaced = np.flatnonzero(~np.append(head[:start], body[start:]))
    if misplaced.size:
        raise _row_error(path, rows, int(misplaced[0]), "an epoch, position or velocity")


def _epochs(path: FilePath, rows: np.ndarray, header: _Header, epoch: str) -> tuple[np.ndarray, np.ndarray]:
    index = np.flatnonzero(_column(rows, 0, 1) == b"*")
    if len(index) != header.epochs:
        raise InputError(f"{path}: expected {header.epochs} epochs, as its first line says, got {len(index)}")
    if not index.size:
        raise InputError(f"{path}: expected an epoch, got none")
    texts = np.stack([_column(rows[index], *field) for field in _FIELDS], axis=1)
    calendar = numbers(path, texts, index + 1)
    t = times(path, index + 1, rows[index], calendar, epoch=epoch, scale=header.scale)
    check_ascending(path, t, index + 1)
    return t, index


def _vectors(
    path: FilePath, rows: np.ndarray, mark: str, epoch_rows: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the vectors (epochs, 3) of rows with a mark, not finite where absent, and their lines (epochs,).

    mark: P for positions or V for velocities, then the satellite's id
    epoch_rows: (epochs,) indices of the epochs' rows
    """
    index = np.flatnonzero(_column(rows, 0, 4) == mark.encode("latin-1"))
    epoch = np.searchsorted(epoch_rows, index) - 1
    astray = np.flatnonzero(np.diff(epoch, prepend=-1) <= 0)
    if astray.size:
        raise _row_error(path, rows, int(index[astray[0]]), "an epoch before this line")
    cut = np.flatnonzero(~np.char.isdigit(_column(rows[index], _AXES[-1][1] - 1, _AXES[-1][1])))
    if cut.size:
        raise _row_error(path, rows, int(index[cut[0]]), f"digits up to column {_AXES[-1][1]}")
    values = numbers(path, np.stack([_column(rows[index], *axis) for axis in _AXES], axis=1), index + 1)
    values[np.any(np.abs(values) >= _ABSENT, axis=1) | np.all(values == 0.0, axis=1)] = np.nan
    vectors, lines = np.full((len(epoch_rows), 3), np.nan), np.zeros(len(epoch_rows), int)
    vectors[epoch], lines[epoch] = values, index + 1
    return vectors, lines


def _flags(rows: np.ndarray, lines: np.ndarray, column: int) -> np.ndarray:
    """Return the flags (n,) in a column of the rows at lines (n,), counted from 1."""
    return _column(rows[lines - 1], column, column + 1)


def _row_error(path: FilePath, rows: np.ndarray, index: int, expected: str) -> InputError:
    return line_error(path, index + 1, expected, rows[index])


def _column(rows: np.ndarray, start: int, end: int) -> np.ndarray:
    """Return the texts (n,) in columns `start` to `end` of rows (n,)."""
    letters = rows.view("S1").reshape(len(rows), _WIDTH)[:, start:end]
    return np.ascontiguousarray(letters).view(f"S{end - start}")[:, 0]
