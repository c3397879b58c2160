"""Gravity fields of the Earth from ICGEM files, with their time-variable terms.

Format: Barthelmes & Förste 2011, 'The ICGEM-format' (GFZ Potsdam), version 1.0.
"""

from collections.abc import Iterator
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
    reference: TT Julian date
    """

    kind: str
    n: int
    m: int
    c: float
    s: float
    reference: float
    period: float = np.nan  # [Julian years]

    def weight(self, jd: float) -> float:
        """Return the factor of c and s at a TT Julian date."""
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
        """Return the field at a UTC epoch, its variations added; raise InputError on a malformed epoch."""
        if not self.variations:
            return self
        jd = float(sum(epochs.tt(epoch, 0.0)))
        c, s = self.c.copy(), self.s.copy()
        for row in self.variations:
            weight = row.weight(jd)
            c[row.n, row.m] += weight * row.c
            s[row.n, row.m] += weight * row.s
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
    """Read the gravity field of an ICGEM file, format 1.0.

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
    for row in _rows(path, lines, head_length, degree):
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


def _rows(path: str | Path, lines: list[str], head_length: int, degree: int) -> Iterator[Variation]:
    references: dict[tuple[int, int], float] = {}
    for number, line in enumerate(lines[head_length:], start=head_length + 1):
        fields = line.split()
        if not fields:
            continue
        try:
            row = _row(fields, references)
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
    if (version := header.get("format", "icgem1.0")) != "icgem1.0":
        raise InputError(f"{path}: format: expected icgem1.0, got {version}")
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


def _row(fields: list[str], references: dict[tuple[int, int], float]) -> Variation:
    """Return a row: gfct ends in the reference day for all its rows, acos and asin in a period.

    The reference is the day's noon, as in Orekit; the format leaves the hour open. Midnight would change the
    acceleration of an ISS by up to 2e-10 m/s2.
    """
    kind, degree, order, *numbers = fields
    n, m, c, s = int(degree), int(order), _number(numbers[0]), _number(numbers[1])
    match kind:
        case "gfc":
            return Variation(kind, n, m, c, s, reference=np.nan)
        case "gfct":
            references[n, m] = _julian_date(numbers[-1]) + 0.5
            return Variation(kind, n, m, c, s, references[n, m])
        case "trnd" | "dot":
            return Variation("trnd", n, m, c, s, references[n, m])
        case "acos" | "asin":
            return Variation(kind, n, m, c, s, references[n, m], _period(numbers[-1]))
    raise ValueError(kind)


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
    """Return the Julian date of 'yyyymmdd'."""
    if len(text) != 8:
        raise ValueError(text)
    return date(int(text[:4]), int(text[4:6]), int(text[6:])).toordinal() + _JD_OF_ORDINAL_ZERO


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
