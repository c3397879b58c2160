"""What the readers of orbits share: the arcs they return, files plain or gzipped, numbers and times."""

import gzip
import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import erfa
import numpy as np

from opml.base import epochs
from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.base.files import FilePath

MOST_APART = 300.0
"""Longest time between two nodes that an orbit is interpolated between [s]."""

BEHIND_TAI = {"TAI": 0.0, "TT": -32.184, "GPS": 19.0, "GAL": 19.0, "QZS": 19.0}
"""Seconds by which the clocks of a time system are behind TAI; UTC's leap seconds are ERFA's."""

_GZIPPED = b"\x1f\x8b"
_NO_SUCH_TIME = (erfa.ErfaError, erfa.ErfaWarning, ValueError)


@dataclass(frozen=True)
class Arc:
    """Nodes of one orbit, as a file or one of its segments has them.

    frame: ITRF, GCRF or EME2000; realisation: how the file calls it; scale: the file's time system; t (n,)
    [s since the run's epoch], ascending; positions (n, 3) [m]; velocities (n, 3) [m/s], not finite where
    there are none; lines (n,): where the nodes stand in the file.
    """

    path: FilePath
    satellite: str
    frame: str
    realisation: str
    scale: str
    t: np.ndarray
    positions: np.ndarray
    velocities: np.ndarray
    lines: np.ndarray


class NoSuchTime(ValueError):
    """A calendar time that does not exist."""

    def __init__(self, index: int) -> None:
        super().__init__(f"time {index}")
        self.index = index
        """Number of the time among those that were given."""


def contents(path: FilePath) -> bytes:
    """Return what a file holds, unpacked if it is gzipped. Raises InputError where it cannot be read."""
    try:
        held = Path(path).read_bytes()
        return gzip.decompress(held) if held.startswith(_GZIPPED) else held
    except FileNotFoundError:
        raise InputError(f"{path}: no such file") from None
    except (EOFError, OSError, zlib.error) as reason:
        raise InputError(f"{path}: expected a file that is whole, got {reason}") from None


def wrong(path: FilePath, line: int, expected: str, got: str | bytes) -> InputError:
    """Return the error of a line, counted from 1."""
    text = got.decode("latin-1") if isinstance(got, bytes) else got
    shown = " ".join("".join(c if c.isprintable() else "?" for c in text).split())
    return InputError(f"{path}: line {line}: expected {expected}, got {shown or 'nothing'}")


def numbers(path: FilePath, texts: np.ndarray, lines: np.ndarray) -> np.ndarray:
    """Numbers (n, k) of texts (n, k) in lines (n,). Raises InputError for what is no finite number."""
    try:
        values = texts.astype(float)
    except ValueError:
        values = np.array([[_number(text) for text in row] for row in texts])
    bad = np.argwhere(~np.isfinite(values))
    if bad.size:
        row, column = bad[0]
        raise wrong(path, int(lines[row]), "a finite number", texts[row, column])
    return values


def ascending(path: FilePath, t: np.ndarray, lines: np.ndarray) -> None:
    """Raise InputError where a time (n,) [s] is not later than the one before."""
    back = np.flatnonzero(np.diff(t) <= 0.0)
    if back.size:
        raise wrong(path, int(lines[back[0] + 1]), "a later epoch than before", "none")


def elapsed(epoch: str, calendar: np.ndarray, scale: str) -> np.ndarray:
    """Times (n,) [s since the UTC text `epoch`] of year, month, day, hour, minute, second (n, 6).

    scale: UTC or a key of BEHIND_TAI. Raises NoSuchTime.
    """
    try:
        return _elapsed(epoch, calendar, scale)
    except _NO_SUCH_TIME:
        for index in range(len(calendar)):
            try:
                _elapsed("2000-01-01T00:00:00", calendar[index : index + 1], scale)
            except _NO_SUCH_TIME:
                raise NoSuchTime(index) from None
        raise


def _elapsed(epoch: str, calendar: np.ndarray, scale: str) -> np.ndarray:
    fields = calendar[:, :5].astype(int)
    with epochs.strict_erfa():
        day, part = erfa.dtf2d("UTC" if scale == "UTC" else "TAI", *fields.T, calendar[:, 5])
        if scale == "UTC":
            day, part = erfa.utctai(day, part)
        else:
            part = part + BEHIND_TAI[scale] / DAY
    first, first_part = epochs.tai(epoch, 0.0)
    # Two-part dates hold about 1e-11 s; the sum over a run holds 1e-9 s, and what was printed comes back.
    t: np.ndarray = np.round((day - first) * DAY + (part - first_part) * DAY, 8)
    return t


def chosen(path: FilePath, found: Sequence[Sequence[str]], wanted: str | None) -> int:
    """Which of the satellites of a file, each known by one or more names, is wanted.

    Raises InputError where there are several to choose from, or none of that name.
    """
    names = ", ".join(known[0] for known in found)
    if wanted is None:
        if len(found) != 1:
            raise InputError(f"{path}: expected the name of one of its satellites, {names}, got none")
        return 0
    for k, known in enumerate(found):
        if wanted.upper() in (name.upper() for name in known):
            return k
    raise InputError(f"{path}: expected satellite {wanted}, got {names}")


def _number(text: bytes | str) -> float:
    try:
        return float(text)
    except ValueError:
        return np.nan
