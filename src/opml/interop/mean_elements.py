"""Reader of RSOs from mean elements flown by SGP4: a TLE, or an OMM in KVN, JSON, XML or CSV.

    opml rso iss.tle --name mine --epoch 2016-09-28T12:09:45 \\
        --area-to-mass 0.05 --cd 2.2 --cr 1.25 >> config/rsos.tsv

adds an RSO to the sheet. SGP4's states are in TEME, which turns with the mean equinox. The rotation to GCRF
goes through the Earth's rotation: Greenwich mean sidereal time of 1982 against the Earth rotation angle about
the CIP of IAU 2006/2000A. UT1 enters both angles and cancels, so UTC will do and no bulletin is needed.
Source: Vallado, Crawford, Hujsak & Kelso 2006, Revisiting Spacetrack Report #3 (AIAA 2006-6753), appendix C;
IERS Conventions 2010, section 5.4; CCSDS 502.0-B-2, section 4 (OMM).
"""

import csv
import json
import logging
import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields
from pathlib import Path
from typing import Any, NamedTuple
from xml.etree.ElementTree import ParseError

import erfa
import numpy as np
from numpy.typing import ArrayLike
from sgp4 import omm
from sgp4.api import SGP4_ERRORS, Satrec

from opml.base import epochs
from opml.base.constants import DAY, EARTH_GM
from opml.base.errors import InputError
from opml.base.files import FilePath
from opml.interop import ccsds
from opml.orbits import sheets
from opml.orbits.elements import coe_from_cartesian, mean_from_true_anomaly
from opml.orbits.sheets import Rso

WARN_DAYS = 7.0
"""Days from the elements' epoch beyond which SGP4 flies them with a warning.

A satellite departs from the orbit of its TLE by 1 to 3 km per day (documentation of the package sgp4), in a
week by more than the median error of the paper case's predictions, 5 km.
"""

MOST_DAYS = 30.0
"""Days from the elements' epoch beyond which they are refused: drag has moved a low orbit too far by then."""

_log = logging.getLogger(__name__)

_NUMBERS = (
    "MEAN_MOTION",
    "ECCENTRICITY",
    "INCLINATION",
    "RA_OF_ASC_NODE",
    "ARG_OF_PERICENTER",
    "MEAN_ANOMALY",
    "BSTAR",
)
# SGP4 does not need these, and messages may leave them out.
_OPTIONAL = {
    "MEAN_MOTION_DOT": "0",
    "MEAN_MOTION_DDOT": "0",
    "CLASSIFICATION_TYPE": "U",
    "OBJECT_ID": "",
    "EPHEMERIS_TYPE": "0",
    "ELEMENT_SET_NO": "0",
    "REV_AT_EPOCH": "0",
    "NORAD_CAT_ID": "0",
}
_REQUIRED = {"MEAN_ELEMENT_THEORY": ("SGP4", "SGP/SGP4"), "REF_FRAME": ("TEME",), "TIME_SYSTEM": ("UTC",)}
_LARGEST_NUMBER = 339_999
"""Largest catalogue number of a TLE, Z9999 there; those of an OMM have up to nine digits."""

_OMM_VERSION = "CCSDS_OMM_VERS"


def read(path: FilePath) -> Satrec:
    """Read the mean elements of a file: a TLE (with or without a name), or an OMM.

    Raises InputError, naming file and line or key, for a malformed file and one with several sets.
    """
    try:
        text = Path(path).read_text(encoding="utf-8-sig")
    except FileNotFoundError:
        raise InputError(f"{path}: no such file") from None
    except (OSError, ValueError) as reason:
        raise InputError(f"{path}: expected a TLE or an OMM in UTF-8 text ({reason})") from None
    match text.lstrip()[:1]:
        case "{" | "[":
            satellite = _from_omm(path, _json(path, text))
        case "<":
            satellite = _from_omm(path, _xml(path))
        case _ if text.lstrip().startswith(_OMM_VERSION):
            satellite = _from_omm(path, _kvn(path))
        case _ if len(set(_cells(text)) & {*_NUMBERS}) > 1:
            satellite = _from_omm(path, _csv(path, text))
        case _:
            satellite = _from_tle(path, text)
    if satellite.error:
        raise InputError(f"{path}: expected elements that SGP4 can fly, got {SGP4_ERRORS[satellite.error]}")
    return satellite


def elements_epoch(satellite: Satrec) -> str:
    """Return the epoch of mean elements as UTC text, to the microsecond."""
    year, month, day, clock = erfa.d2dtf("UTC", 6, satellite.jdsatepoch, satellite.jdsatepochF)
    h, m, s, f = (int(clock[name]) for name in "hmsf")
    return f"{int(year):04d}-{int(month):02d}-{int(day):02d}T{h:02d}:{m:02d}:{s:02d}.{f:06d}"


def state(satellite: Satrec, *, epoch: str) -> np.ndarray:
    """Return the osculating GCRF state (6,) [m, m/s] at a UTC text, by SGP4.

    Raises InputError where SGP4 fails (decayed, elements out of range).
    """
    day, fraction = (float(part) for part in epochs.utc(epoch, 0.0))
    error, position, velocity = satellite.sgp4(day, fraction)
    if error:
        raise InputError(f"mean elements: expected an orbit at {epoch}, got {SGP4_ERRORS[error]}")
    turn = teme_to_gcrf(epoch)
    return 1e3 * np.concatenate([turn @ position, turn @ velocity])


def teme_to_gcrf(epoch: str, t: ArrayLike = 0.0) -> np.ndarray:
    """Return rotations (..., 3, 3) of TEME to GCRF at times t (...) [s] since a UTC text.

    At 7e-12 rad/s they move no velocity.
    """
    utc, tt = epochs.utc(epoch, t), epochs.tt(epoch, t)
    to_cirs = erfa.rz(erfa.gmst82(*utc) - erfa.era00(*utc), np.eye(3))
    return np.asarray(np.swapaxes(erfa.c2ixys(*erfa.xys06a(*tt)), -1, -2) @ to_cirs)


class Body(NamedTuple):
    """The part of an RSO that mean elements lack."""

    area_to_mass: float  # [m2/kg]
    cd: float
    cr: float


def rso(satellite: Satrec, *, name: str, epoch: str, body: Body) -> Rso:
    """Return the RSO of mean elements at the UTC text `epoch`, with osculating elements by SGP4.

    B* is not used: it is fitted together with SGP4's own atmosphere. Warns through `logging` where the epoch
    is more than WARN_DAYS from that of the mean elements. Raises InputError where it is more than MOST_DAYS
    away, and where SGP4 fails.
    """
    check_age(satellite, epoch)
    a, e, i, argp, raan, nu = coe_from_cartesian(state(satellite, epoch=epoch), EARTH_GM).tolist()
    mean_anomaly = float(mean_from_true_anomaly(nu, e))
    return Rso(name, a, e, i, argp, raan, mean_anomaly, **body._asdict())


def check_age(satellite: Satrec, epoch: str) -> None:
    """Raise InputError, or warn, where the UTC text `epoch` is too far from that of the mean elements."""
    start = elements_epoch(satellite)
    days = abs(epochs.seconds_between(start, epoch)) / DAY
    if days > MOST_DAYS:
        raise InputError(
            f"mean elements: expected an epoch at most {MOST_DAYS:g} days from theirs, {start}, "
            f"got {epoch}, {days:.1f} days away"
        )
    if days > WARN_DAYS:
        _log.warning(
            "mean elements: SGP4 carries them %.1f days, from their epoch %s to %s; "
            "it errs by kilometres per day",
            days,
            start,
            epoch,
        )


def sheet_row(rso: Rso) -> str:
    """Return the RSO's line for the sheet of RSOs, in the sheet's units and order of columns."""
    to_sheet: Mapping[str, Callable[[float], float]] = {"a": lambda value: value / 1e3} | dict.fromkeys(
        ("i", "argp", "raan", "mean_anomaly"), math.degrees
    )
    values = [(field.name, getattr(rso, field.name)) for field in fields(rso)[1:]]
    return "\t".join([rso.name, *(repr(to_sheet.get(name, float)(value)) for name, value in values)])


def _from_tle(path: FilePath, text: str) -> Satrec:
    lines = [(n, line.rstrip()) for n, line in enumerate(text.splitlines(), start=1) if line.strip()]
    if len(lines) == 3:
        lines = lines[1:]
    if len(lines) != 2:
        raise InputError(f"{path}: expected one TLE of two lines, or an OMM, got {len(lines)} lines")
    for k, (number, line) in enumerate(lines, start=1):
        _check_tle_line(path, number, line, _TLE_LINES[k - 1], str(k))
    (_, first), (number, second) = lines
    if first[2:7] != second[2:7]:
        raise InputError(f"{path}: line {number}: expected catalogue number {first[2:7]}, got {second[2:7]}")
    try:
        return Satrec.twoline2rv(first, second)
    except ValueError as reason:
        raise InputError(f"{path}: line {number}: expected a TLE, got {reason}") from None


_EXPONENT = r"[ +-][ \d]{5}[+-]\d"
_TLE_LINES = (
    re.compile(
        rf"1 [ \dA-Z][ \d]{{4}}[ A-Z] .{{8}} \d\d[ \d]{{3}}\.\d{{8}} [ +-]\.\d{{8}} "
        rf"{_EXPONENT} {_EXPONENT} [ \d] [ \d]{{4}}\d",
        re.ASCII,
    ),
    re.compile(
        r"2 [ \dA-Z][ \d]{4} [ \d]{3}\.\d{4} [ \d]{3}\.\d{4} [ \d]{7} [ \d]{3}\.\d{4} [ \d]{3}\.\d{4} "
        r"[ \d]{2}\.\d{8}[ \d]{5}\d",
        re.ASCII,
    ),
)


def _check_tle_line(path: FilePath, number: int, line: str, pattern: re.Pattern[str], kind: str) -> None:
    if not pattern.fullmatch(line):
        raise InputError(f"{path}: line {number}: expected line {kind} of a TLE, got {line!r}")
    total = sum(int(c) if c.isdigit() else c == "-" for c in line[:68]) % 10
    if total != int(line[68]):
        raise InputError(f"{path}: line {number}: expected the checksum {total}, got {line[68]}")


def _json(path: FilePath, text: str) -> dict[str, str]:
    try:
        values = json.loads(text)
    except ValueError as reason:
        number = getattr(reason, "lineno", 1)
        raise InputError(f"{path}: line {number}: expected an OMM in JSON, got {reason}") from None
    return _single_set(path, values if isinstance(values, list) else [values])


def _xml(path: FilePath) -> dict[str, str]:
    try:
        return _single_set(path, list(omm.parse_xml(path)))
    except ParseError as reason:
        raise InputError(f"{path}: line {reason.position[0]}: expected an OMM in XML, got {reason}") from None
    except (AttributeError, TypeError):
        raise InputError(
            f"{path}: expected metadata, meanElements and tleParameters of an OMM, not all of which are there"
        ) from None


def _cells(text: str) -> list[str]:
    """Return the cells of the first line of a text, as CSV."""
    return next(csv.reader(text.lstrip().splitlines()[:1]), [])


def _csv(path: FilePath, text: str) -> dict[str, str]:
    columns = _cells(text)
    if twice := [name for name in columns if columns.count(name) > 1]:
        raise InputError(f"{path}: {twice[0]}: expected one such column, got several")
    rows = list(omm.parse_csv(text.lstrip().splitlines()))
    for row in rows:
        if None in row or None in row.values():
            raise InputError(f"{path}: expected a cell for each column of the first line, got more or fewer")
    return _single_set(path, rows)


def _kvn(path: FilePath) -> dict[str, str]:
    message = ccsds.Message(path, version_key=_OMM_VERSION, versions=("1.0", "2.0", "3.0"))
    values: dict[str, str] = {}
    while message.peek():
        number, key, value = message.pair()
        if key in values:
            raise message.error(f"{key} once", "it twice", number)
        values[key] = value.split("[")[0].rstrip()
    return values


def _single_set(path: FilePath, sets: Sequence[Any]) -> dict[str, str]:
    if len(sets) != 1 or not isinstance(sets[0], dict):
        raise InputError(f"{path}: expected the mean elements of one RSO, got {len(sets)}")
    return {str(key): "" if value is None else str(value).strip() for key, value in sets[0].items()}


def _from_omm(path: FilePath, values: Mapping[str, str]) -> Satrec:
    for key, allowed in _REQUIRED.items():
        if values.get(key, allowed[0]).upper() not in allowed:
            raise InputError(f"{path}: {key}: expected {' or '.join(allowed)}, got {values[key]}")
    elements = _OPTIONAL | {key: value for key, value in values.items() if value}
    for key in (*_NUMBERS, "MEAN_MOTION_DOT", "MEAN_MOTION_DDOT"):
        _check_value(path, elements, key, _is_finite, "a finite number")
    for key in ("EPHEMERIS_TYPE", "ELEMENT_SET_NO", "REV_AT_EPOCH", "NORAD_CAT_ID"):
        _check_value(path, elements, key, _is_whole, "a whole number")
    epoch = _omm_epoch(path, elements)
    satellite = Satrec()
    try:
        omm.initialize(satellite, elements | {"EPOCH": epoch, "NORAD_CAT_ID": _number(elements)})
    except ValueError as reason:
        raise InputError(f"{path}: expected elements that SGP4 can take, got {reason}") from None
    return satellite


def _number(elements: Mapping[str, str]) -> str:
    """Return the catalogue number as sgp4 takes it, 0 for one beyond TLEs: no orbit depends on it."""
    number = elements["NORAD_CAT_ID"]
    return number if int(number) <= _LARGEST_NUMBER else "0"


def _omm_epoch(path: FilePath, elements: Mapping[str, str]) -> str:
    """Return the epoch as sgp4 reads it, with six decimals and no Z. Raises InputError for no epoch."""
    epoch = elements.get("EPOCH", "").removesuffix("Z")
    try:
        epochs.parse(epoch)
    except InputError as reason:
        raise InputError(f"{path}: EPOCH: {reason}") from None
    return ccsds.utc_texts(epoch, np.zeros(1))[0]


def _check_value(
    path: FilePath, elements: Mapping[str, str], key: str, is_valid: Callable[[str], bool], expected: str
) -> None:
    text = elements.get(key, "nothing")
    if not is_valid(text):
        raise InputError(f"{path}: {key}: expected {expected}, got {text}")


def _is_finite(text: str) -> bool:
    try:
        return math.isfinite(float(text))
    except ValueError:
        return False


def _is_whole(text: str) -> bool:
    try:
        return int(text) >= 0
    except ValueError:
        return False


def line_of_sheet(path: FilePath, name: str, epoch: str, body: Body) -> str:
    """Return the line of the sheet of RSOs for a file of mean elements.

    name: in the sheet
    epoch: of the run, UTC text

    Raises InputError as `read` and `rso` do, and for a name or a body that the sheet would refuse.
    """
    sheets.check_body(name, dict(zip(("area_to_mass_m2pkg", "cd", "cr"), body, strict=True)))
    return sheet_row(rso(read(path), name=name, epoch=epoch, body=body))
