"""Orbits in SP3-c and SP3-d, the format of the services of IGS, ILRS and IDS.

Positions are in km, velocities in dm/s, both in a realisation of the ITRF. Columns count from 0 here.
Source: Hilla 2010, The Extended Standard Product 3 Orbit Format (SP3-c); Hilla 2016, the same for SP3-d.
"""

import re
from dataclasses import dataclass

import numpy as np

from opml.base.errors import InputError
from opml.base.files import FilePath
from opml.interop.orbit_arcs import Arc, NoSuchTime, ascending, chosen, elapsed, numbers, wrong

SCALES = ("GPS", "UTC", "TAI", "GAL", "QZS")
"""Time systems that are read."""

_WIDTH = 80  # of a line
_FIRST = re.compile(rb"#[cd][PV]\d{4}.{24} ( *\d+) ")
_TERRESTRIAL = re.compile(r"ITR|IG[SbR]|SLR|WGS|ECF|DPOD", re.IGNORECASE)
_FIELDS = ((3, 7), (8, 10), (11, 13), (14, 16), (17, 19), (20, 31))  # year to second of an epoch
_AXES = ((4, 18), (18, 32), (32, 46))
_KILOMETRE, _DECIMETRE = 1e3, 1e-1
_ABSENT = 999999.0  # and more; so are three zeros


@dataclass(frozen=True)
class _Header:
    epochs: int
    realisation: str
    scale: str
    satellites: list[str]


def is_one(content: bytes) -> bool:
    """Whether a file looks like SP3, of any version."""
    return re.match(rb"#[a-z][PV]\d{4}", content) is not None


def read(path: FilePath, content: bytes, *, epoch: str, satellite: str | None = None) -> list[Arc]:
    """Read one satellite of an SP3 file: one arc, with times from the UTC text `epoch`.

    satellite: its id, such as L47; None is the only one there is. Positions that are marked as bad or absent
    are left out. Raises InputError, naming the line, for what is malformed, cut, or in another frame or time
    system.
    """
    lines = content.splitlines()
    header = _header(path, lines)
    index = chosen(path, [[name] for name in header.satellites], satellite)
    rows = np.array(lines, dtype=f"S{_WIDTH}")
    _check_kinds(path, rows)
    t, epochs = _epochs(path, rows, header, epoch)
    return [_arc(path, rows, header, header.satellites[index], t, epochs)]


def _header(path: FilePath, lines: list[bytes]) -> _Header:
    first = _FIRST.match(lines[0].ljust(_WIDTH))
    if first is None:
        raise wrong(path, 1, "the first line of SP3-c or SP3-d", lines[0])
    realisation = lines[0][46:51].decode("latin-1").strip()
    if not _TERRESTRIAL.match(realisation):
        raise wrong(path, 1, "a realisation of the ITRF, such as IGS14", realisation)
    number, line = next(
        ((n, line) for n, line in enumerate(lines, 1) if line.startswith(b"%c")), (len(lines), b"")
    )
    scale = line[9:12].decode("latin-1")
    if scale not in SCALES:
        raise wrong(path, number, f"a line %c with time system {' or '.join(SCALES)}", line)
    return _Header(int(first[1]), realisation, scale, _satellites(path, lines))


def _satellites(path: FilePath, lines: list[bytes]) -> list[str]:
    """Ids of the satellites, in the lines that begin with +."""
    listed = [line.decode("latin-1") for line in lines if re.match(rb"\+ ", line)]
    ids = [line[k : k + 3] for line in listed for k in range(9, 60, 3)]
    count = listed[0][1:6].strip() if listed else ""
    names = [name for name in ids if name.strip() not in ("", "0")]
    if not (count.isdecimal() and 0 < int(count) == len(names)):
        raise InputError(f"{path}: expected the ids of {count or 'its'} satellites, got {len(names)}")
    return names


def _check_kinds(path: FilePath, rows: np.ndarray) -> None:
    """Raise InputError for a line that is none of SP3's, or does not stand where it belongs."""
    kinds = _column(rows, 0, 1)
    head = np.isin(kinds, [b"#", b"+", b"%", b"/"])
    body = np.isin(kinds, [b"*", b"P", b"V", b"E", b""])
    start = int(np.argmin(head)) if not head.all() else len(rows)
    misplaced = np.flatnonzero(~np.append(head[:start], body[start:]))
    if misplaced.size:
        raise wrong(path, int(misplaced[0]) + 1, "an epoch, position or velocity", rows[misplaced[0]])


def _epochs(path: FilePath, rows: np.ndarray, header: _Header, epoch: str) -> tuple[np.ndarray, np.ndarray]:
    """Times (n,) [s] of the epochs, and their rows (n,)."""
    at = np.flatnonzero(_column(rows, 0, 1) == b"*")
    if len(at) != header.epochs:
        raise InputError(f"{path}: expected {header.epochs} epochs, as its first line says, got {len(at)}")
    if not at.size:
        raise InputError(f"{path}: expected an epoch, got none")
    texts = np.stack([_column(rows[at], *field) for field in _FIELDS], axis=1)
    try:
        t = elapsed(epoch, numbers(path, texts, at + 1), header.scale)
    except NoSuchTime as time:
        raise wrong(path, int(at[time.index]) + 1, "a time that exists", rows[at[time.index]]) from None
    ascending(path, t, at + 1)
    return t, at


def _arc(
    path: FilePath, rows: np.ndarray, header: _Header, satellite: str, t: np.ndarray, epochs: np.ndarray
) -> Arc:
    positions, lines = _vectors(path, rows, b"P" + satellite.encode("latin-1"), epochs)
    velocities, _ = _vectors(path, rows, b"V" + satellite.encode("latin-1"), epochs)
    known = np.isfinite(positions[:, 0])
    if not known.any():
        raise InputError(f"{path}: expected a position of {satellite}, got none")
    return Arc(
        path=path,
        satellite=satellite,
        frame="ITRF",
        realisation=header.realisation,
        scale=header.scale,
        t=t[known],
        positions=positions[known] * _KILOMETRE,
        velocities=velocities[known] * _DECIMETRE,
        lines=lines[known],
    )


def _vectors(
    path: FilePath, rows: np.ndarray, mark: bytes, epochs: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Positions or velocities (epochs, 3) of a satellite, not finite where absent, and their lines."""
    at = np.flatnonzero(_column(rows, 0, 4) == mark)
    of_epoch = np.searchsorted(epochs, at) - 1
    astray = np.flatnonzero(np.diff(of_epoch, prepend=-1) <= 0)
    if astray.size:
        raise wrong(path, int(at[astray[0]]) + 1, "an epoch before this line", rows[at[astray[0]]])
    cut = np.flatnonzero(~np.char.isdigit(_column(rows[at], _AXES[-1][1] - 1, _AXES[-1][1])))
    if cut.size:
        raise wrong(path, int(at[cut[0]]) + 1, f"digits up to column {_AXES[-1][1]}", rows[at[cut[0]]])
    values = numbers(path, np.stack([_column(rows[at], *axis) for axis in _AXES], axis=1), at + 1)
    values[np.any(np.abs(values) >= _ABSENT, axis=1) | np.all(values == 0.0, axis=1)] = np.nan
    vectors, lines = np.full((len(epochs), 3), np.nan), np.zeros(len(epochs), int)
    vectors[of_epoch], lines[of_epoch] = values, at + 1
    return vectors, lines


def _column(rows: np.ndarray, start: int, end: int) -> np.ndarray:
    """Texts (n,) of some columns of lines (n,)."""
    letters = rows.view("S1").reshape(len(rows), _WIDTH)[:, start:end]
    return np.ascontiguousarray(letters).view(f"S{end - start}")[:, 0]
