"""Orbit mean-elements messages (OMM), one or many in a text: KVN, XML, JSON or CSV; written as KVN.

CSV and JSON may leave out the keys whose values are the same in all sets, as CelesTrak's do.
Source: CCSDS 502.0-B-2, section 4; CelesTrak, GP data formats; Space-Track, class gp_history.
"""

import csv
import io
import json
import math
import re
from collections.abc import Iterator, Mapping
from itertools import zip_longest
from typing import NamedTuple

from sgp4 import omm
from sgp4.api import Satrec

from opml.base.errors import InputError
from opml.base.files import FilePath
from opml.interop import ccsds
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
_VALUE = re.compile(r"[^\s\[\],]")


Pair = tuple[int, str | None, str | None]  # line, key and value; None for what is not there


class Record(NamedTuple):
    """A set as written in a text, with the line where it begins."""

    line: int
    pairs: list[Pair]


def element_set(path: FilePath, record: Record) -> ElementSet:
    """Return the set of a record. Raises InputError, naming line and key, for a damaged one."""
    values = _values(path, record)
    known = values.texts
    for key, allowed in _REQUIRED.items():
        text = known.get(key, allowed[0]).upper()
        if (str(int(text)) if _is_whole(text) else text) not in allowed:
            raise _error(values, key, " or ".join(allowed))
    for key in (*_NUMBERS, *_DERIVATIVES):
        if not _is_finite(known.get(key, "0" if key in _DERIVATIVES else "")):
            raise _error(values, key, "a finite number")
    # Angles within a circle of radians are those of one orbit in a million.
    if all(0.0 < float(known[key]) <= 2.0 * math.pi for key, unit in _UNITS.items() if unit == "deg"):
        raise _error(values, "INCLINATION", "degrees, and not all four angles between 0 and 6.3")
    for key in ("ELEMENT_SET_NO", "REV_AT_EPOCH", "NORAD_CAT_ID"):
        if not _is_whole(known.get(key, "0")):
            raise _error(values, key, f"a whole number of at most {_MOST_DIGITS} digits")
    number = int(known.get("NORAD_CAT_ID", "0"))
    identity = {
        "EPOCH": _time(values, "EPOCH"),
        "NORAD_CAT_ID": str(number if number <= LARGEST_NUMBER else 0),
        "CLASSIFICATION_TYPE": known.get("CLASSIFICATION_TYPE", "U"),
    }
    numbers = {key: known[key] for key in (*_NUMBERS, *_DERIVATIVES) if key in known}
    elements = satellite(numbers | identity)
    check_orbit(path, record.line, elements)
    created = _time(values, "CREATION_DATE") if "CREATION_DATE" in known else ""
    name, designator = (known.get(key, "") for key in ("OBJECT_NAME", "OBJECT_ID"))
    return ElementSet(path, record.line, number, created, elements, name, designator)


def satellite(values: Mapping[str, str]) -> Satrec:
    """Return what SGP4 propagates of a message's values, with all that a TLE has beside its orbit."""
    elements, fields = Satrec(), {**_UNUSED, **values}
    kind = fields["CLASSIFICATION_TYPE"][:1]
    angles = {key: fields[key] for key, unit in _UNITS.items() if unit == "deg"}
    turned = {key: repr(float(text) % 360.0) for key, text in angles.items() if float(text) < 0.0}
    omm.initialize(elements, {**fields, **turned, "CLASSIFICATION_TYPE": kind})
    elements.classification = kind  # which sgp4 forgets
    elements.intldesg = ObjectId.of("", fields["OBJECT_ID"]).launch  # of UNKNOWN it would make KNOWN
    return elements


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


def _values(path: FilePath, record: Record) -> ccsds.KeyValues:
    """Return the values of a record. Raises InputError where one lacks a key, or a key one or has two."""
    values = ccsds.KeyValues(path, record.line)
    for line, key, value in record.pairs:
        if key is None:
            raise line_error(path, line, "a key for each value", value or "")
        if value is None:
            raise line_error(path, line, f"a value for {key}", "none")
        values.add(line, key, value)
    return values


def _error(values: ccsds.KeyValues, key: str, expected: str) -> InputError:
    got = excerpt(values.text(key, ""))
    return InputError(f"{values.path}: line {values.line(key)}: {key}: expected {expected}, got {got}")


def _time(values: ccsds.KeyValues, key: str) -> str:
    """Return the time of a key as UTC text, to the microsecond. Raises InputError where it is none."""
    text = time_text(values.texts, key)
    if text is None or not _FIRST_YEAR <= text[:4] <= _LAST_YEAR:
        years = f"a time from {_FIRST_YEAR} to {_LAST_YEAR}, in no leap second"
        raise _error(values, key, f"{years}, like 2016-09-28T12:09:45")
    return text


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
    for number, line in ccsds.lines_of(path, text):
        key, value = ccsds.pair(line) or (None, line)
        pair = number, key, _without_unit(key, value) if key else value
        if record is None or key == _VERSION:
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
    while match := _VALUE.search(text, end):
        at = match.start()
        line += text.count("\n", end, at)
        value, end = decoder.raw_decode(text, at)
        # An object is a tuple of its members. Space-Track may wrap sets with metadata of the request.
        data = dict(value).get("data") if isinstance(value, tuple) else None
        for each in data if isinstance(data, list) else [value]:
            members = each if isinstance(each, tuple) else [(None, each)]
            texts = ((key, "" if member is None else str(member)) for key, member in members)
            yield Record(line, [(line, key, _in_one_line(member)) for key, member in texts])
        line += text.count("\n", at, end)


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
                yield Record(reader.line_num, [(reader.line_num, key, cell) for key, cell in pairs])
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
