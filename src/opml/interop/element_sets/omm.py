"""Orbit mean-elements messages (OMM), one or many in a text: KVN, XML, JSON or CSV; written as KVN.

CSV and JSON may leave out the keys whose values are the same in all sets, as CelesTrak's do.
Source: CCSDS 502.0-B-2, section 4; CelesTrak, GP data formats; Space-Track, class gp_history.
"""

import csv
import io
import json
import math
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import zip_longest
from typing import Any, NamedTuple

from sgp4 import omm
from sgp4.api import Satrec

from opml.base.errors import InputError
from opml.base.files import FilePath
from opml.interop import ccsds, ndm_xml
from opml.interop.element_sets.element_set import (
    PER_DAY,
    ElementSet,
    check_orbit,
    elements_epoch,
    seconds_since,
)
from opml.interop.element_sets.tle import EPHEMERIS_TYPES, FOR_TESTS, LARGEST_NUMBER
from opml.interop.object_ids import ObjectId
from opml.interop.orbit_arcs import excerpt, line_error

_NUMBERS = (
    "MEAN_MOTION",
    "ECCENTRICITY",
    "INCLINATION",
    "RA_OF_ASC_NODE",
    "ARG_OF_PERICENTER",
    "MEAN_ANOMALY",
    "BSTAR",
)
_DERIVATIVES = ("MEAN_MOTION_DOT", "MEAN_MOTION_DDOT")
_UNUSED = {
    **dict.fromkeys(_DERIVATIVES, "0"),
    "CLASSIFICATION_TYPE": "U",
    "OBJECT_ID": "",
    "EPHEMERIS_TYPE": "0",
    "ELEMENT_SET_NO": "0",
    "REV_AT_EPOCH": "0",
}
"""What sgp4 asks for and SGP4 does not need."""

_VERSION = "CCSDS_OMM_VERS"
_REQUIRED = {
    _VERSION: ("1.0", "2.0", "3.0"),
    "MEAN_ELEMENT_THEORY": ("SGP4", "SGP/SGP4"),
    "REF_FRAME": ("TEME",),
    "TIME_SYSTEM": ("UTC",),
    "CENTER_NAME": ("EARTH",),
    "EPHEMERIS_TYPE": EPHEMERIS_TYPES,
}
_UNITS = {
    "MEAN_MOTION": "rev/day",
    **dict.fromkeys(("INCLINATION", "RA_OF_ASC_NODE", "ARG_OF_PERICENTER", "MEAN_ANOMALY"), "deg"),
    "BSTAR": "1/er",
    "MEAN_MOTION_DOT": "rev/day**2",
    "MEAN_MOTION_DDOT": "rev/day**3",
}
_LONGEST = 10_000  # bytes of a line of columns
_MOST_DIGITS = 9  # of a catalogue number
_FIRST_YEAR, _LAST_YEAR = "1957", "2099"
_PAIR = re.compile(r"([A-Z][A-Z0-9_]*)\s*=(.*)", re.ASCII)
_VALUE = re.compile(r"[^\s\[\],]")


class Pair(NamedTuple):
    """A value by its key, with its line; None for what is not there."""

    line: int
    key: str | None
    value: str | None


class Record(NamedTuple):
    """A set as written in a text, with the line where it begins."""

    line: int
    pairs: list[Pair]


def element_set(path: FilePath, record: Record) -> ElementSet:
    """Return the set of a record. Raises InputError, naming line and key, for a damaged one."""
    values = _Values(path, record)
    for key, allowed in _REQUIRED.items():
        values.check_choice(key, allowed)
    for key in _NUMBERS:
        values.check(key, _is_finite, "a finite number")
    values.check_degrees()
    for key in _DERIVATIVES:
        values.check(key, _is_finite, "a finite number", "0")
    for key in ("ELEMENT_SET_NO", "REV_AT_EPOCH", "NORAD_CAT_ID"):
        values.check(key, _is_whole, f"a whole number of at most {_MOST_DIGITS} digits", "0")
    number = int(values.known.get("NORAD_CAT_ID", "0"))
    identity = {
        "EPOCH": values.time("EPOCH"),
        "NORAD_CAT_ID": str(number if number <= LARGEST_NUMBER else 0),
        "CLASSIFICATION_TYPE": values.known.get("CLASSIFICATION_TYPE", "U"),
    }
    numbers = {key: values.known[key] for key in (*_NUMBERS, *_DERIVATIVES) if key in values.known}
    made = satellite(numbers | identity)
    check_orbit(path, record.line, made)
    created = values.time("CREATION_DATE") if "CREATION_DATE" in values.known else ""
    name, designator = (values.known.get(key, "") for key in ("OBJECT_NAME", "OBJECT_ID"))
    return ElementSet(path, record.line, number, created, made, name, designator)


def satellite(values: Mapping[str, str]) -> Satrec:
    """Return what SGP4 propagates of a message's values, with all that a TLE has beside its orbit."""
    made, fields = Satrec(), {**_UNUSED, **values}
    kind = fields["CLASSIFICATION_TYPE"][:1]
    angles = {key: fields[key] for key, unit in _UNITS.items() if unit == "deg"}
    turned = {key: repr(float(text) % 360.0) for key, text in angles.items() if float(text) < 0.0}
    omm.initialize(made, {**fields, **turned, "CLASSIFICATION_TYPE": kind})
    made.classification = kind  # which sgp4 forgets
    made.intldesg = ObjectId.of("", fields["OBJECT_ID"]).launch  # of UNKNOWN it would make KNOWN
    return made


def write(path: FilePath, satellite: Satrec, *, identity: ObjectId, epoch: str, comment: str) -> None:
    """Write mean elements as an OMM in KVN, whole or not at all.

    identity: of the object, by its name in the run
    """
    version, *header = ccsds.header(_VERSION, epoch, float(seconds_since(epoch, [satellite])[0]))
    pairs = {
        "OBJECT_NAME": identity.name,
        "OBJECT_ID": identity.designator or identity.name,
        "CENTER_NAME": "EARTH",
        "REF_FRAME": "TEME",
        "TIME_SYSTEM": "UTC",
        "MEAN_ELEMENT_THEORY": "SGP4",
        "EPOCH": elements_epoch(satellite),
        "MEAN_MOTION": ccsds.number_text(satellite.no_kozai * PER_DAY, 0),
        "ECCENTRICITY": ccsds.number_text(satellite.ecco, 0),
        "INCLINATION": ccsds.degrees_text(satellite.inclo),
        "RA_OF_ASC_NODE": ccsds.degrees_text(satellite.nodeo),
        "ARG_OF_PERICENTER": ccsds.degrees_text(satellite.argpo),
        "MEAN_ANOMALY": ccsds.degrees_text(satellite.mo),
        "EPHEMERIS_TYPE": 0,
        "CLASSIFICATION_TYPE": "U",
        "NORAD_CAT_ID": identity.number or FOR_TESTS,
        "ELEMENT_SET_NO": 0,
        "REV_AT_EPOCH": 0,
        "BSTAR": ccsds.number_text(satellite.bstar, 0),
        "MEAN_MOTION_DOT": 0,
        "MEAN_MOTION_DDOT": 0,
    }
    lines = (f"{key} = {value}" for key, value in pairs.items())
    ccsds.write(path, [version, f"COMMENT {comment}", *header, "", *lines])


class _Values:
    """The values of a record by their keys."""

    def __init__(self, path: FilePath, record: Record) -> None:
        """Raise InputError where a key or a value is missing, or a key is there twice."""
        self._path, self._line = path, record.line
        self._lines: dict[str, int] = {}
        self.known: dict[str, str] = {}
        for line, key, value in record.pairs:
            if key is None:
                raise line_error(path, line, "a key for each value", value or "")
            if value is None:
                raise line_error(path, line, f"a value for {key}", "none")
            if key in self._lines:
                raise line_error(path, line, f"{key} once", "it twice")
            self._lines[key] = line
            if value:
                self.known[key] = value

    def check(
        self, key: str, is_valid: Callable[[str], bool], expected: str, default: str | None = None
    ) -> None:
        """Raise InputError where the value of a key is not valid; one without a default must be there."""
        text = self.known.get(key, default)
        if text is None or not is_valid(text):
            raise self._error(key, expected)

    def check_choice(self, key: str, allowed: Sequence[str]) -> None:
        """Raise InputError where the value of a key is there, but not allowed."""
        text = self.known.get(key, allowed[0]).upper()
        if (str(int(text)) if _is_whole(text) else text) not in allowed:
            raise self._error(key, " or ".join(allowed))

    def check_degrees(self) -> None:
        """Raise InputError where all angles are within a circle of radians, as one in a million orbits is."""
        angles = [float(self.known[key]) for key, unit in _UNITS.items() if unit == "deg"]
        if all(0.0 < angle <= 2.0 * math.pi for angle in angles):
            raise self._error("INCLINATION", "degrees, and not all four angles between 0 and 6.3")

    def time(self, key: str) -> str:
        """Return the time of a key as UTC text, to the microsecond. Raises InputError where it is none."""
        text = time_text(self.known, key)
        if text is None or not _FIRST_YEAR <= text[:4] <= _LAST_YEAR:
            years = f"a time from {_FIRST_YEAR} to {_LAST_YEAR}, in no leap second"
            raise self._error(key, f"{years}, like 2016-09-28T12:09:45")
        return text

    def _error(self, key: str, expected: str) -> InputError:
        line = self._lines.get(key, self._line)
        got = excerpt(self.known.get(key, ""))
        return InputError(f"{self._path}: line {line}: {key}: expected {expected}, got {got}")


def time_text(values: Mapping[str, str], key: str) -> str | None:
    """Return the time of a key as UTC text, to the microsecond, None where it is none.

    Lists of Space-Track's older class `tle` have a blank for the T, and microseconds under another key.
    """
    parts = [values[name] for name in (key, f"{key}_MICROSECONDS") if name in values]
    return ccsds.utc_text(".".join(part.rjust(6, "0") for part in parts).replace(" ", "T"))


def read_messages(path: FilePath, text: str) -> Iterator[Record]:
    """Yield the sets of messages in KVN or XML; a line without a key is an error of its set.

    Raises InputError, naming the line, for broken XML.
    """
    record = None
    for number, line in ndm_xml.lines(path, text):
        line = line.strip()
        if not line or re.match(r"COMMENT\b", line):
            continue
        match = _PAIR.fullmatch(line)
        pair = (
            Pair(number, match[1], _without_unit(match[1], match[2])) if match else Pair(number, None, line)
        )
        if record is None or pair.key == _VERSION:
            if record is not None:
                yield record
            record = Record(number, [])
        record.pairs.append(pair)
    if record is not None:
        yield record


def _without_unit(key: str, text: str) -> str:
    """Return the value before a unit that its key has; with another unit it is no number."""
    value, _, unit = text.partition("[")
    is_known = unit.strip().removesuffix("]").strip().lower() in ("", _UNITS.get(key))
    return (value if is_known else text).strip()


def read_json(path: FilePath, text: str) -> Iterator[Record]:
    """Yield the members of a list, or a single object, each decoded at its place, for its line.

    Raises InputError, naming the line, for what is no JSON.
    """
    decoder = json.JSONDecoder(object_pairs_hook=tuple, parse_int=str, parse_float=str, parse_constant=str)
    try:
        json.loads(text)
    except (RecursionError, ValueError) as reason:
        raise line_error(path, getattr(reason, "lineno", 1), "OMMs in JSON", str(reason)) from None
    line, end = 1, 0
    while (at := _after_separators(text, end)) < len(text):
        line += text.count("\n", end, at)
        value, end = decoder.raw_decode(text, at)
        for one in _wrapped(value):
            yield Record(line, _pairs(line, one))
        line += text.count("\n", at, end)


def _after_separators(text: str, start: int) -> int:
    """Return where the next value of a text begins that is valid JSON; its length where there is none."""
    match = _VALUE.search(text, start)
    return match.start() if match else len(text)


def _wrapped(value: Any) -> list[Any]:
    """Return the sets that Space-Track wraps together with metadata of the request; else the value alone.

    An object is a tuple of its members, those of the same key among them.
    """
    data = dict(value).get("data") if isinstance(value, tuple) else None
    return data if isinstance(data, list) else [value]


def _pairs(line: int, value: Any) -> list[Pair]:
    if not isinstance(value, tuple):
        return [Pair(line, None, str(value))]
    return [Pair(line, key, "" if member is None else _in_one_line(str(member))) for key, member in value]


def _in_one_line(text: str) -> str:
    return " ".join(text.splitlines()).strip()


def is_csv(content: bytes) -> bool:
    """Return whether the first line of a file has columns of mean elements."""
    first = content.lstrip()[:_LONGEST].decode("latin-1").partition("\n")[0]
    return len({*re.findall(r"\w+", first)} & {*_NUMBERS}) > 1


def read_csv(path: FilePath, text: str) -> Iterator[Record]:
    """Yield the rows of a table. Raises InputError, naming the line, for broken CSV or a missing column."""
    reader = csv.reader(io.StringIO(text, newline=""), strict=True)
    columns: list[str] = []
    try:
        for row in reader:
            cells = list(map(_in_one_line, row))
            if not any(cells) or cells == columns:  # lists that are joined repeat their columns
                continue
            if columns:
                pairs = zip_longest(columns, cells)
                yield Record(reader.line_num, [Pair(reader.line_num, key, cell) for key, cell in pairs])
            else:
                columns = cells
                for name in ("EPOCH", *_NUMBERS):
                    if name not in columns:
                        raise line_error(path, reader.line_num, f"a column {name}", "none")
                for name in columns:
                    if columns.count(name) > 1:
                        raise line_error(path, reader.line_num, f"one column {name}", "several")
    except csv.Error as reason:
        raise line_error(path, reader.line_num, "CSV", str(reason)) from None


def _is_finite(text: str) -> bool:
    try:
        return math.isfinite(float(text))
    except ValueError:
        return False


def _is_whole(text: str) -> bool:
    digits = text.removeprefix("+")
    return digits.isascii() and digits.isdigit() and len(digits) <= _MOST_DIGITS
