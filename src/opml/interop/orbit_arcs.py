"""Common parts of the readers of orbits: arcs, files plain or gzipped, numbers and times."""

import codecs
import zlib
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path
from typing import Self

import erfa
import numpy as np

from opml.base import epochs
from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.base.files import FilePath, unpacked
from opml.interop.object_ids import UNKNOWN, ObjectId
from opml.orbits.density_error import DensityErrors

EVERY = "*"  # in the place of a name: all satellites of a file
MOST_APART = 300.0  # longest time between two nodes for interpolation [s]

BEHIND_TAI = {"TAI": 0.0, "TT": -32.184, "GPS": 19.0, "GAL": 19.0, "QZS": 19.0}
"""Seconds by which the clocks of a time system are behind TAI; UTC's leap seconds come from ERFA."""

_MOST_SHOWN = 100  # characters of a line in an error

_ANY = "2000-01-01T00:00:00"
_NO_SUCH_TIME = (erfa.ErfaError, erfa.ErfaWarning, ValueError)


@dataclass(frozen=True)
class Arc:
    """Nodes of an orbit, from a file or one of its segments."""

    path: FilePath
    satellite: str
    frame: str  # ITRF, GCRF, EME2000, TEME or TOD
    realisation: str  # name of the frame in the file
    scale: str  # time system of the file
    t: np.ndarray  # (n,) [s since the run's epoch], ascending
    positions: np.ndarray  # (n, 3) [m]
    velocities: np.ndarray  # (n, 3) [m/s], not finite where absent
    lines: np.ndarray  # (n,) line numbers of the nodes
    identity: ObjectId = UNKNOWN  # what else than the name identifies the satellite
    burns: Sequence[float] = ()  # when the file has it manoeuvre [s since the run's epoch]
    sigmas: np.ndarray | None = None  # (n, 6) of the nodes in RSW [m, m/s], NaN where the file has none
    covariance_t: np.ndarray = field(default_factory=lambda: np.empty(0))  # (m,) [s since the run's epoch]
    covariances: np.ndarray = field(default_factory=lambda: np.empty((0, 6, 6)))  # (m, 6, 6) [m, m/s]
    covariance_frame: str | np.ndarray = "GCRF"  # their axes, of all or each: GCRF, or RSW, TNW of the states
    density: DensityErrors | None = None  # the part of the covariances that other objects share
    known: float | None = None  # when the file was made [s since the run's epoch]; None: it does not say

    @property
    def owner(self) -> ObjectId:
        """The object, by the satellite's name where nothing else identifies it."""
        return replace(self.identity, name=self.identity.name or self.satellite)

    def part(self, rows: np.ndarray) -> Self:
        """Return the arc of some rows (n,) alone."""
        names = ("t", "positions", "velocities", "lines", *(() if self.sigmas is None else ("sigmas",)))
        columns = {name: getattr(self, name)[rows] for name in names}
        return replace(self, **columns)


def contents(path: FilePath) -> bytes:
    """Return the bytes of a file, plain or gzipped. Raises InputError where it cannot be read."""
    try:
        source = Path(path)
        content = _of_pipe(source) if source.is_fifo() else source.read_bytes()
        return unpacked(content).removeprefix(codecs.BOM_UTF8)
    except FileNotFoundError:
        raise InputError(f"{path}: no such file") from None
    except (EOFError, OSError, zlib.error) as reason:
        raise InputError(f"{path}: expected a file that is whole, got {reason}") from None


@lru_cache(maxsize=64)
def _of_pipe(path: Path) -> bytes:
    """Return the bytes of a pipe, which can be read once."""
    return path.read_bytes()


def line_error(path: FilePath, line: int, expected: str, got: str | bytes) -> InputError:
    """Return the error of a line, counted from 1."""
    text = got.decode("latin-1") if isinstance(got, bytes) else got
    return InputError(f"{path}: line {line}: expected {expected}, got {excerpt(text)}")


def excerpt(text: str) -> str:
    """Return a text as it stands, in one line that is not too long."""
    shown = "".join(c if c.isprintable() else "?" for c in text.strip())
    return f"{shown[:_MOST_SHOWN]}..." if len(shown) > _MOST_SHOWN else shown or "nothing"


def numbers(path: FilePath, texts: np.ndarray, lines: np.ndarray) -> np.ndarray:
    """Return the numbers (n, k) of texts (n, k) in lines (n,). Raises InputError for no finite number."""
    try:
        values = texts.astype(float)
    except ValueError:
        values = np.array([[_number(text) for text in row] for row in texts])
    bad = np.argwhere(~np.isfinite(values))
    if bad.size:
        row, column = bad[0]
        raise line_error(path, int(lines[row]), "a finite number", texts[row, column])
    return values


def check_ascending(path: FilePath, t: np.ndarray, lines: np.ndarray) -> None:
    """Raise InputError where a time (n,) [s] is not later than the time before it."""
    back = np.flatnonzero(np.diff(t) <= 0.0)
    if back.size:
        gap = t[back[0]] - t[back[0] + 1]
        got = f"one {gap:g} s earlier" if gap else "the same"
        raise line_error(path, int(lines[back[0] + 1]), "a later epoch than before", got)


def times(
    path: FilePath,
    lines: Sequence[int] | np.ndarray,
    texts: Sequence[str | bytes] | np.ndarray,
    calendar: np.ndarray,
    *,
    epoch: str,
    scale: str,
) -> np.ndarray:
    """Return the times (n,) of a file [s since `epoch`].

    lines, texts: (n,) where they stand, for errors
    calendar: (n, 6) their year, month, day, hour, minute, second
    scale: time system of `calendar`, UTC or a key of BEHIND_TAI

    Raises InputError, naming the line, for a time that does not exist.
    """
    try:
        return _seconds_since(epoch, calendar, scale)
    except _NO_SUCH_TIME:
        for line, text, fields in zip(lines, texts, calendar, strict=True):
            try:
                _seconds_since(_ANY, fields[None], scale)
            except _NO_SUCH_TIME:
                raise line_error(path, int(line), "a time that exists", text) from None
        raise


def _seconds_since(epoch: str, calendar: np.ndarray, scale: str) -> np.ndarray:
    fields = calendar[:, :5].astype(int)
    with epochs.strict_erfa():
        day, part = erfa.dtf2d("UTC" if scale == "UTC" else "TAI", *fields.T, calendar[:, 5])
        if scale == "UTC":
            day, part = erfa.utctai(day, part)
        else:
            part = part + BEHIND_TAI[scale] / DAY
    first, first_part = epochs.tai(epoch, 0.0)
    # Two-part dates resolve about 1e-11 s, their sum over a run 1e-9 s, so that printed times come back.
    return np.asarray(np.round((day - first) * DAY + (part - first_part) * DAY, 8))


def choose_satellites(path: FilePath, satellites: Sequence[Sequence[str]], wanted: str | None) -> list[int]:
    """Return the indices of the wanted satellites of a file, each given by its names.

    wanted: a name of one of them; None: the file has only one satellite; EVERY: all of them

    Raises InputError where no satellite has the name, or several have it, or are there without a name.
    """
    chosen = [
        k
        for k, names in enumerate(satellites)
        if wanted in (None, EVERY)
        or wanted.upper() in map(str.upper, names)
        or ObjectId.of(*names).is_called(wanted)
    ]
    if len(chosen) == 1 or wanted == EVERY:
        return chosen
    if not chosen:
        first_names = ", ".join(names[0] for names in satellites)
        raise InputError(f"{path}: expected satellite {wanted}, got {first_names}")
    expected = "the name of one of its satellites" if wanted is None else f"one satellite {wanted}"
    got = ", ".join(str(ObjectId.of(*satellites[k])) for k in chosen)
    raise InputError(f"{path}: expected {expected}, got {got}")


def _number(text: bytes | str) -> float:
    try:
        return float(text)
    except ValueError:
        return np.nan
