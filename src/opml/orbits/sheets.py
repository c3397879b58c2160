"""Stations and RSOs, read and checked from the two sheets or from rows in the settings.

Cells are read as text, so that no name turns into a number.
"""

import csv
import math
import re
from collections.abc import Callable, Collection, Container, Iterable, Mapping
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

from opml import naming
from opml.base.constants import WGS84_A
from opml.base.errors import InputError
from opml.base.files import read_text

NAME = re.compile(r"[a-z][a-z0-9]{0,59}")  # names in sheets; files have several in theirs

NAME_WANTED = "up to 60 lower-case letters and digits, a letter first"


LOWEST_PERIGEE = 120e3  # lower limit of the atmosphere model [m] (DTM2000: from 120 km up)


@dataclass(frozen=True)
class Station:
    """A radar or telescope: place on WGS84, field of view and standard deviations of its noise.

    SI units, radians. A station measures what it has a standard deviation of. max_sun_elevation: of a
    telescope, which sees an RSO in the Sun's light while the Sun is lower than that. troposphere, refraction:
    1 where ranges are as the air delays them, and elevations as it bends them, until they are read.
    """

    name: str
    latitude: float
    longitude: float
    altitude: float
    max_range: float
    min_elevation: float
    max_elevation: float
    sigma_range: float | None = None
    sigma_azimuth: float | None = None
    sigma_elevation: float | None = None
    sigma_range_rate: float | None = None
    sigma_right_ascension: float | None = None
    sigma_declination: float | None = None
    max_sun_elevation: float | None = None
    troposphere: float | None = None
    refraction: float | None = None

    @property
    def row(self) -> dict[str, Any]:
        """The station's values, without those that it lacks."""
        return {name: value for name, value in asdict(self).items() if value is not None}

    @property
    def is_radar(self) -> bool:
        """Whether the station measures azimuth, elevation and range."""
        return None not in (self.sigma_azimuth, self.sigma_elevation, self.sigma_range)


@dataclass(frozen=True)
class Rso:
    """A resident space object: osculating elements in GCRF at the epoch and its body; SI units, radians."""

    name: str
    a: float
    e: float
    i: float
    argp: float
    raan: float
    mean_anomaly: float
    area_to_mass: float
    cd: float
    cr: float


@dataclass(frozen=True)
class _Field:
    """A sheet's column: the attribute it fills, its range in the sheet's unit, and the conversion to SI."""

    attribute: str
    low: float
    high: float
    to_si: Callable[[float], float] = float
    above_low: bool = False
    too_high: str = ""  # what may be the cause of a number above the range

    def parse(self, text: str, where: str) -> float:
        """Return the value in SI units. Raises InputError with where it stands and what was expected."""
        try:
            value = float(text)
        except (TypeError, ValueError):
            value = math.nan
        inside = self.low < value if self.above_low else self.low <= value
        if not (inside and value <= self.high and math.isfinite(value)):
            hint = f": {self.too_high}" if value > self.high and self.too_high else ""
            raise InputError(f"{where}: expected {self._range()}, got {text!r}{hint}")
        return self.to_si(value)

    def _range(self) -> str:
        low = f"above {self.low:g}" if self.above_low else f"of at least {self.low:g}"
        return f"a number {low}" if self.high == math.inf else f"a number {low} and at most {self.high:g}"


def _kilo(value: float) -> float:
    return value * 1e3


_STATION_FIELDS = {
    "latitude_deg": _Field("latitude", -90, 90, math.radians),
    "longitude_deg": _Field("longitude", -180, 360, math.radians),
    "altitude_m": _Field("altitude", -500, 10_000),
    "max_range_km": _Field("max_range", 0, math.inf, _kilo, above_low=True),
    "min_elevation_deg": _Field("min_elevation", 0, 90, math.radians),
    "max_elevation_deg": _Field("max_elevation", 0, 90, math.radians),
}
_SIGMA_FIELDS = {
    "sigma_range_m": _Field("sigma_range", 0, math.inf, above_low=True),
    "sigma_azimuth_deg": _Field("sigma_azimuth", 0, 90, math.radians, above_low=True),
    "sigma_elevation_deg": _Field("sigma_elevation", 0, 90, math.radians, above_low=True),
    "sigma_range_rate_mps": _Field("sigma_range_rate", 0, math.inf, above_low=True),
    "sigma_right_ascension_deg": _Field("sigma_right_ascension", 0, 90, math.radians, above_low=True),
    "sigma_declination_deg": _Field("sigma_declination", 0, 90, math.radians, above_low=True),
}
_OPTIONAL_FIELDS = {
    **_SIGMA_FIELDS,
    "max_sun_elevation_deg": _Field("max_sun_elevation", -90, 90, math.radians),
    "troposphere": _Field("troposphere", 0, 1),
    "refraction": _Field("refraction", 0, 1),
}
_RSO_FIELDS = {
    "a_km": _Field("a", WGS84_A / 1e3, 300_000, _kilo, too_high="metres in place of kilometres?"),
    "e": _Field("e", 0, 0.99),
    "i_deg": _Field("i", 0, 180, math.radians),
    "argp_deg": _Field("argp", -360, 360, math.radians),
    "raan_deg": _Field("raan", -360, 360, math.radians),
    "mean_anomaly_deg": _Field("mean_anomaly", -360, 360, math.radians),
    "area_to_mass_m2pkg": _Field("area_to_mass", 0, math.inf),
    "cd": _Field("cd", 0, math.inf),
    "cr": _Field("cr", 0, math.inf),
}


_NOTHING = "-"  # cell of a sheet for what a row has not

_ELEMENTS = ("a_km", "e", "i_deg", "argp_deg", "raan_deg", "mean_anomaly_deg")


def read_stations(path: str | Path) -> dict[str, Station]:
    """Read the sheet of stations, in its order. Raises InputError, naming file, row and column."""
    return stations_from_rows(_rows(path, _STATION_FIELDS, _OPTIONAL_FIELDS), sheet=path)


def read_rsos(path: str | Path) -> dict[str, Rso]:
    """Read the sheet of RSOs, in its order. Raises InputError, naming file, row and column."""
    return rsos_from_rows(_rows(path, _RSO_FIELDS), sheet=path)


def parse_stations(text: str, sheet: Mapping[str, Station]) -> list[Station]:
    """Return the stations that a set's canonical text names. Raises InputError for any other text."""
    return [sheet[name] for name in naming.station_names(text, sheet)]


def parse_rso(text: str, sheet: Mapping[str, Rso]) -> Rso:
    """Return the RSO that a canonical text names, with its inclination and offset of the axis.

    Raises InputError for any other text, an impossible inclination and a perigee too low.
    """
    base, inclination, offset = naming.rso_parts(text, sheet)
    rso = sheet[base]
    if inclination:
        rso = replace(rso, i=_RSO_FIELDS["i_deg"].parse(inclination, f"RSO '{text}': inclination"))
    if offset:
        rso = replace(rso, a=rso.a + _kilo(float(offset)))
        _check_perigee(rso, f"RSO '{text}'")
    return replace(rso, name=text)


def name_at_inclination(text: str, degrees: float, sheet: Mapping[str, Rso]) -> str:
    """Return the name of an RSO at an inclination; that of the sheet adds nothing to the name."""
    base, _, offset = naming.rso_parts(text, sheet)
    inclination = "" if math.radians(degrees) == sheet[base].i else naming.number(degrees)
    return naming.rso_name(base, inclination, offset)


def name_at_offset(text: str, km: float, sheet: Mapping[str, Rso]) -> str:
    """Return the name of an RSO with `km` added to its semi-major axis in the sheet."""
    base, inclination, _ = naming.rso_parts(text, sheet)
    sign = "-" if km < 0 else "+"
    return naming.rso_name(base, inclination, f"{sign}{naming.number(abs(km))}" if km else "")


def _check_station(station: Station, where: str) -> None:
    if not any(field.attribute in station.row for field in _SIGMA_FIELDS.values()):
        raise InputError(f"{where}expected one of {', '.join(_SIGMA_FIELDS)} at least, got none")
    if not station.min_elevation < station.max_elevation:
        low, high = math.degrees(station.min_elevation), math.degrees(station.max_elevation)
        raise InputError(
            f"{where}min_elevation_deg: expected less than max_elevation_deg, got {low:g} and {high:g}"
        )


def _check_perigee(rso: Rso, where: str) -> None:
    altitude = rso.a * (1 - rso.e) - WGS84_A
    if altitude < LOWEST_PERIGEE:
        lowest = f"{LOWEST_PERIGEE / 1e3:g} km"
        raise InputError(f"{where}: expected a perigee at least {lowest} high, got {altitude / 1e3:.1f} km")


def _rows(
    path: str | Path, fields: Iterable[str], optional: Collection[str] = ()
) -> dict[str, dict[str, str]]:
    """Read a tab-separated sheet with a column `name`; lines that start with # are comments.

    optional: columns that may be missing, and cells that may hold nothing
    """
    (_, header), *lines = _lines(path)
    expected = ["name", *fields]
    odd = _odd(header, expected, optional) or sorted(name for name in header if header.count(name) > 1)
    if odd:
        raise InputError(
            f"{path}: header: expected the columns {', '.join(expected)} between tabs; "
            f"look at {', '.join(name or 'the one without a name' for name in odd)}"
        )
    rows: dict[str, dict[str, str]] = {}
    numbers: dict[str, int] = {}
    for number, cells in lines:
        if len(cells) != len(header):
            raise InputError(f"{path}: {cells[0]}: expected {len(header)} cells, got {len(cells)}")
        row = dict(zip(header, cells, strict=True))
        name = row.pop("name")
        _check_name(f"{path}: line {number}: name", name, numbers)
        numbers[name] = number
        rows[name] = {key: cell for key, cell in row.items() if not (key in optional and cell == _NOTHING)}
    if not rows:
        raise InputError(f"{path}: expected at least one row, got none")
    return rows


def _odd(found: Iterable[str], expected: Iterable[str], optional: Iterable[str]) -> list[str]:
    """Return the names that are missing, and those that nothing is read from."""
    found, expected = set(found), set(expected)
    return sorted((expected - found) | (found - expected - set(optional)))


def _check_name(where: str, name: str, numbers: Mapping[str, int]) -> None:
    if not NAME.fullmatch(name):
        raise InputError(f"{where}: expected {NAME_WANTED}, got {name!r}")
    if name in numbers:
        raise InputError(
            f"{where}: expected no name twice, got {name!r}, which is in line {numbers[name]} too"
        )


def _lines(path: str | Path) -> list[tuple[int, list[str]]]:
    """Return the numbers and cells of a sheet's lines; of an empty sheet one empty line."""
    text = read_text(path, "a sheet in UTF-8 text", encoding="utf-8-sig")
    lines = [
        (number, _cells(f"{path}: line {number}", line))
        for number, line in enumerate(text.splitlines(), start=1)
        if line.strip() and not line.startswith("#")
    ]
    return lines or [(1, [])]


def _cells(where: str, line: str) -> list[str]:
    try:
        return [cell.strip() for cell in next(csv.reader([line], delimiter="\t"))]
    except csv.Error as error:
        raise InputError(f"{where}: expected cells between tabs ({error})") from None


def stations_from_rows(
    rows: Mapping[str, Mapping[str, object]], *, sheet: str | Path = ""
) -> dict[str, Station]:
    """Return stations from mappings of the columns of a sheet. Raises InputError, naming the column."""
    stations = {}
    for name, row in rows.items():
        where = f"{sheet}: {name}: " if sheet else ""
        stations[name] = Station(name=name, **_parsed(row, where, _STATION_FIELDS, _OPTIONAL_FIELDS))
        _check_station(stations[name], where)
    return stations


def rsos_from_rows(
    rows: Mapping[str, Mapping[str, object]], *, from_files: Container[str] = (), sheet: str | Path = ""
) -> dict[str, Rso]:
    """Return RSOs from mappings of the columns of a sheet. Raises InputError, naming the column.

    rows: values by column, by the RSO's name
    from_files: names of RSOs whose orbit is in a file; their rows may lack the elements, which are NaN then
    """
    rsos = {}
    for name, row in rows.items():
        fields, where = _RSO_FIELDS, f"{sheet}: {name}: " if sheet else ""
        if name in from_files and not set(row) & set(_ELEMENTS):
            fields = {key: field for key, field in _RSO_FIELDS.items() if key not in _ELEMENTS}
        elements = dict.fromkeys((field.attribute for field in _RSO_FIELDS.values()), math.nan)
        rsos[name] = Rso(name=name, **(elements | _parsed(row, where, fields)))
        if fields is _RSO_FIELDS:
            _check_perigee(rsos[name], f"{where}a_km")
    return rsos


def check_body(name: str, body: Mapping[str, object]) -> None:
    """Raise InputError for a name, or a body's numbers, that no line of the sheet of RSOs may have."""
    _check_name("name", name, {})
    rsos_from_rows({name: body}, from_files=(name,))


def _parsed(
    row: Mapping[str, object],
    where: str,
    fields: Mapping[str, _Field],
    optional: Mapping[str, _Field] = MappingProxyType({}),
) -> dict[str, float]:
    """Return a row of a sheet's columns in SI units; those in `optional` may be missing."""
    if odd := _odd(row, fields, optional):
        raise InputError(f"{where}expected the keys {', '.join(fields)}; look at {', '.join(odd)}")
    return {
        field.attribute: field.parse(str(row[key]), f"{where}{key}")
        for key, field in {**fields, **optional}.items()
        if key in row
    }
