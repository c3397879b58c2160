"""Gravity fields of the Earth from ICGEM files, with their time-variable terms.

Format: Barthelmes & Förste 2011, 'The ICGEM-format' (GFZ Potsdam), and its version 2.0 with intervals.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from datetime import date
from importlib.resources import files
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd

from opml.base import epochs
from opml.base.constants import DAY, JULIAN_YEAR
from opml.base.errors import InputError
from opml.base.files import read_text

MAX_DEGREE = 10_000  # nearly twice the degree of any published field; a header with a larger one is damaged

_REQUIRED = ("product_type", "modelname", "earth_gravity_constant", "radius", "max_degree")
_YEARS_PER_DAY = DAY / JULIAN_YEAR
_JD_OF_ORDINAL_ZERO = 1721424.5


class Variation(NamedTuple):
    """A row of a file, whose contribution to C and S of degree n and order m depends on time.

    kind: ICGEM's key: gfct (the value itself), trnd (per Julian year since `reference`), acos and asin (of
        the angle since `reference`)
    reference, start, end: TT Julian dates; the row counts from `start` up to `end`
    """

    kind: str
    n: int
    m: int
    c: float
    s: float
    reference: float
    start: float = -np.inf
    end: float = np.inf
    period: float = np.nan  # [Julian years]

    def weight(self, jd: float) -> float:
        """Return the factor of c and s at a TT Julian date."""
        if not self.start <= jd < self.end:
            return 0.0
        years = (jd - self.reference) * _YEARS_PER_DAY
        match self.kind:
            case "gfct":
                return 1.0
            case "trnd":
                return years
        angle = 2.0 * np.pi * years / self.period
        return float(np.cos(angle) if self.kind == "acos" else np.sin(angle))


TIDE_FREE, ZERO_TIDE = "tide_free", "zero_tide"
"""Tide systems, as ICGEM files name them: without the Earth's permanent deformation, and with it."""

_RowReader = Callable[[list[str], dict[tuple[int, int], float]], Variation]
"""A reader of the fields of a row, with the reference dates of the degrees and orders read so far."""


@dataclass(frozen=True, eq=False)
class GravityField:
    """Fully normalised spherical harmonics of the Earth's gravity.

    c, s: constant part (degree + 1, order + 1), entry [n, m], zero above the diagonal, read-only
    """

    name: str
    gm: float  # [m3/s2]
    radius: float  # [m]
    tide_system: str
    c: np.ndarray
    s: np.ndarray
    variations: tuple[Variation, ...] = ()  # time-variable part

    def __post_init__(self) -> None:
        self.c.setflags(write=False)
        self.s.setflags(write=False)

    @property
    def max_degree(self) -> int:
        """Highest degree n."""
        return len(self.c) - 1

    @property
    def max_order(self) -> int:
        """Highest order m."""
        return int(self.c.shape[1]) - 1

    def freeze(self, epoch: str) -> "GravityField":
        """Return the field at a UTC epoch, its variations added to c and s.

        Raises InputError on a malformed epoch, and one outside all intervals of a coefficient.
        """
        if not self.variations:
            return self
        jd = float(sum(epochs.tt(epoch, 0.0)))
        c, s = self.c.copy(), self.s.copy()
        covered = np.zeros(c.shape, dtype=bool)
        for row in self.variations:
            weight = row.weight(jd)
            c[row.n, row.m] += weight * row.c
            s[row.n, row.m] += weight * row.s
            covered[row.n, row.m] |= row.kind == "gfct" and weight == 1.0
        for row in self.variations:
            if not covered[row.n, row.m]:
                where = f"{self.name}: degree {row.n}, order {row.m}"
                raise InputError(f"{where}: expected a row gfct for {epoch}, got none")
        return replace(self, c=c, s=s, variations=())

    def truncate(self, degree: int, order: int) -> "GravityField":
        """Return the field up to a degree and order. Raises InputError where it does not reach them."""
        if not 0 <= degree <= self.max_degree:
            raise InputError(f"{self.name}: degree: expected 0 to {self.max_degree}, got {degree}")
        if not 0 <= order <= min(degree, self.max_order):
            raise InputError(f"{self.name}: order: expected 0 to {min(degree, self.max_order)}, got {order}")
        kept = tuple(row for row in self.variations if row.n <= degree and row.m <= order)
        square = np.s_[: degree + 1, : order + 1]
        return replace(self, c=self.c[square].copy(), s=self.s[square].copy(), variations=kept)


def table(field: GravityField, epoch: str) -> pd.DataFrame:
    """Return the table `gravity_field` at a UTC epoch: columns n, m (int64), c, s (fully normalised)."""
    frozen = field.freeze(epoch)
    n, m = np.tril_indices(frozen.max_degree + 1, m=frozen.max_order + 1)
    return pd.DataFrame({"n": n, "m": m, "c": frozen.c[n, m], "s": frozen.s[n, m]})


def metadata(field: GravityField) -> dict[str, str | float]:
    """Return name, gm [m3/s2], radius [m] and tide system of a field, for the table's file metadata."""
    return {"name": field.name, "gm": field.gm, "radius": field.radius, "tide_system": field.tide_system}


def check_tide_system(tide_system: str) -> None:
    """Raise InputError for a field that the tides of the solid Earth cannot be added to."""
    if tide_system not in (TIDE_FREE, ZERO_TIDE):
        expected = f"expected a gravity field that is {TIDE_FREE} or {ZERO_TIDE}"
        raise InputError(f"solid_tides: {expected}, got tide_system {tide_system}")


def resolve(name_or_path: str | Path) -> Path:
    """Return the path of the ICGEM file in a setting: EGM2008, in the package to degree 70, or a path."""
    if str(name_or_path) == "EGM2008":
        return Path(str(files("opml") / "data" / "egm2008_70.gfc"))
    return Path(name_or_path)


def read_icgem(path: str | Path) -> GravityField:
    """Read the gravity field of an ICGEM file, format 1.0 or 2.0.

    Raises InputError, naming file and key or row, for a missing or truncated file, a header without a
    required key, a field that is not fully normalised, and a malformed row.
    """
    # Headers hold people's names in whatever encoding; the figures are ASCII.
    lines = read_text(path, "an ICGEM file", encoding="latin-1").splitlines()
    header, head_length = _read_header(path, lines)
    text = header["max_degree"]
    if not (text.isascii() and text.isdigit() and int(text) <= MAX_DEGREE):
        raise InputError(f"{path}: max_degree: expected a whole number up to {MAX_DEGREE}, got {text!r}")
    degree = int(text)
    c, s = np.zeros((degree + 1, degree + 1)), np.zeros((degree + 1, degree + 1))
    c[0, 0] = 1.0
    present = np.zeros((degree + 1, degree + 1), dtype=bool)
    variations = []
    read_row = _row_with_interval if header.get("format", "").startswith("icgem2") else _row_with_reference
    for row in _rows(path, lines, head_length, degree, read_row):
        if row.kind == "gfc":
            c[row.n, row.m], s[row.n, row.m] = row.c, row.s
        else:
            variations.append(row)
        if row.kind in ("gfc", "gfct"):
            present[row.n, row.m] = True
    _check_complete(path, present)
    return GravityField(
        name=header["modelname"],
        gm=_header_number(path, header, "earth_gravity_constant"),
        radius=_header_number(path, header, "radius"),
        tide_system=header.get("tide_system", "unknown"),
        c=c,
        s=s,
        variations=tuple(variations),
    )


def _rows(
    path: str | Path, lines: list[str], head_length: int, degree: int, read_row: _RowReader
) -> Iterator[Variation]:
    references: dict[tuple[int, int], float] = {}
    for number, line in enumerate(lines[head_length:], start=head_length + 1):
        fields = line.split()
        if not fields:
            continue
        try:
            row = read_row(fields, references)
        except (ValueError, IndexError, KeyError):
            where, text = f"{path}: line {number}", " ".join(fields)
            raise InputError(f"{where}: expected a row of coefficients, got {text!r}") from None
        if not 0 <= row.m <= row.n <= degree:
            raise InputError(
                f"{path}: line {number}: expected 0 <= order <= degree <= {degree}, "
                f"got degree {row.n}, order {row.m}"
            )
        yield row


def _read_header(path: str | Path, lines: list[str]) -> tuple[dict[str, str], int]:
    """Return the header's values by key, and its number of lines; text before 'begin_of_head' is comment."""
    keys = [line.split(maxsplit=1)[0] if line.strip() else "" for line in lines]
    if "end_of_head" not in keys:
        raise InputError(f"{path}: header: expected a line end_of_head, got none")
    end = keys.index("end_of_head")
    begin = keys.index("begin_of_head") + 1 if "begin_of_head" in keys[:end] else 0
    pairs = [line.split() for line in lines[begin:end]]
    header = {pair[0]: pair[1] for pair in pairs if len(pair) > 1}

    for key in _REQUIRED:
        if key not in header:
            raise InputError(f"{path}: header: expected the key {key}, got none")
    if header["product_type"] != "gravity_field":
        raise InputError(f"{path}: product_type: expected gravity_field, got {header['product_type']}")
    if header.get("norm", "fully_normalized") != "fully_normalized":
        raise InputError(f"{path}: norm: expected fully_normalized, got {header['norm']}")
    return header, end + 1


def _header_number(path: str | Path, header: dict[str, str], key: str) -> float:
    try:
        value = _number(header[key])
    except ValueError:
        value = np.nan
    if not value > 0.0:
        raise InputError(f"{path}: {key}: expected a positive number, got {header[key]!r}")
    return value


def _row_with_reference(fields: list[str], references: dict[tuple[int, int], float]) -> Variation:
    """Return a row of format 1.0: gfct ends in the reference day for all its rows, acos and asin in a period.

    The reference is the day's noon, as in Orekit; the format leaves the hour open. Midnight would change the
    acceleration of an ISS by up to 2e-10 m/s2.
    """
    kind, n, m, c, s, rest = _split_row(fields)
    match kind:
        case "gfc":
            return Variation(kind, n, m, c, s, reference=np.nan)
        case "gfct":
            references[n, m] = _julian_date(rest[-1]) + 0.5
            return Variation(kind, n, m, c, s, references[n, m])
        case "trnd" | "dot":
            return Variation("trnd", n, m, c, s, references[n, m])
        case "acos" | "asin":
            return Variation(kind, n, m, c, s, references[n, m], period=_period(rest[-1]))
    raise ValueError(kind)


def _row_with_interval(fields: list[str], _: dict[tuple[int, int], float]) -> Variation:
    """Return a row of format 2.0: all kinds but gfc end in an interval, acos and asin in a period, too."""
    kind, n, m, c, s, rest = _split_row(fields)
    match kind:
        case "gfc":
            return Variation(kind, n, m, c, s, reference=np.nan)
        case "gfct" | "trnd":
            start, end = map(_julian_date, rest[-2:])
            return Variation(kind, n, m, c, s, start, start, end)
        case "acos" | "asin":
            start, end = map(_julian_date, rest[-3:-1])
            return Variation(kind, n, m, c, s, start, start, end, _period(rest[-1]))
    raise ValueError(kind)


def _split_row(fields: list[str]) -> tuple[str, int, int, float, float, list[str]]:
    kind, n, m, c, s, *rest = fields
    return kind, int(n), int(m), _number(c), _number(s), rest


def _number(text: str) -> float:
    """Return a finite number, Fortran's exponent letter D included. Raises ValueError for any other text."""
    value = float(text.upper().replace("D", "E"))
    if not np.isfinite(value):
        raise ValueError(text)
    return value


def _period(text: str) -> float:
    period = _number(text)
    if period <= 0.0:
        raise ValueError(text)
    return period


def _julian_date(text: str) -> float:
    """Return the Julian date of 'yyyymmdd' or 'yyyymmdd.hhmm'."""
    day, _, clock = text.partition(".")
    clock = (clock + "0000")[:4]
    if len(day) != 8:
        raise ValueError(text)
    days = date(int(day[:4]), int(day[4:6]), int(day[6:])).toordinal()
    return days + _JD_OF_ORDINAL_ZERO + int(clock[:2]) / 24.0 + int(clock[2:]) / 1440.0


def _check_complete(path: str | Path, present: np.ndarray) -> None:
    """Raise InputError where a row is missing.

    Degrees 0 and 1, and orders above the highest one in the file, are optional.
    """
    order = np.flatnonzero(present.any(axis=0)).max(initial=0)
    expected = np.tril(np.ones_like(present))
    expected[:2] = False
    expected[:, order + 1 :] = False
    missing = np.argwhere(expected & ~present)
    if missing.size:
        n, m = missing[0]
        raise InputError(
            f"{path}: expected coefficients up to max_degree {len(present) - 1}, "
            f"got none of degree {n}, order {m}"
        )
