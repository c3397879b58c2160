"""Element sets written back with another mean motion and B*: TLEs, or OMMs in JSON, CSV, XML or KVN.

Names, numbers, epochs and all that is not changed stay as the file has them. A message whose set is changed
says so, with this package as its author and the date of the newest set; what follows from the elements is
made anew or left out. Formats: CelesTrak, GP data formats; CCSDS 502.0-B-2, section 4.
"""

import csv
import io
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from xml.sax.saxutils import escape

from sgp4 import exporter
from sgp4.api import Satrec

from opml import __version__
from opml.base.errors import InputError
from opml.base.files import FilePath, suffix_of, write_text
from opml.interop import ccsds
from opml.interop.element_sets import mean_elements, omm, tle
from opml.interop.element_sets.element_set import PER_DAY, seconds_since
from opml.interop.element_sets.mean_elements import Piece
from opml.interop.orbit_arcs import contents

_ANY = "2000-01-01T12:00:00"
Fields = Mapping[str, str]  # an OMM: values by their keys

_HEADER = ("CCSDS_OMM_VERS", "COMMENT", "CREATION_DATE", "ORIGINATOR")
_METADATA = (
    *("OBJECT_NAME", "OBJECT_ID", "CENTER_NAME", "REF_FRAME", "REF_FRAME_EPOCH", "TIME_SYSTEM"),
    "MEAN_ELEMENT_THEORY",
)
_ELEMENTS = (
    *("EPOCH", "SEMI_MAJOR_AXIS", "MEAN_MOTION", "ECCENTRICITY", "INCLINATION", "RA_OF_ASC_NODE"),
    *("ARG_OF_PERICENTER", "MEAN_ANOMALY", "GM"),
)
_OF_TLES = (
    *("EPHEMERIS_TYPE", "CLASSIFICATION_TYPE", "NORAD_CAT_ID", "ELEMENT_SET_NO", "REV_AT_EPOCH", "BSTAR"),
    *("MEAN_MOTION_DOT", "MEAN_MOTION_DDOT"),
)
_TEXTS = {*_HEADER, *_METADATA, "EPOCH", "CLASSIFICATION_TYPE"}
_STANDARD = {
    "CENTER_NAME": "EARTH",
    "REF_FRAME": "TEME",
    "TIME_SYSTEM": "UTC",
    "MEAN_ELEMENT_THEORY": "SGP4",
    "CLASSIFICATION_TYPE": "U",
    "EPHEMERIS_TYPE": "0",
}
_DERIVED = (
    *("SEMIMAJOR_AXIS", "SEMI_MAJOR_AXIS", "PERIOD", "APOAPSIS", "PERIAPSIS"),
    *("GM", "RMS", "FILE", "GP_ID"),
)
"""Keys that tell of the published elements alone."""

_LINES = ("TLE_LINE1", "TLE_LINE2")


@dataclass(frozen=True)
class Better:
    """A set of a file, by path, place and line as `ElementSet` has them, and what it gets."""

    path: str
    place: int
    line: int
    motion: float  # mean motion [rad/min]
    bstar: float  # B* [1/(6378.135 km)]


def write(path: FilePath, sets: Sequence[Better]) -> int:
    """Write sets in the format of the path's suffix, whole or not at all; return how many it cannot hold.

    Raises InputError for another suffix, and where a file has changed since it was read.
    """
    write_sets = WRITERS[suffix_of(path, WRITERS)]
    wanted: dict[str, list[Better]] = {}
    for one in sets:
        wanted.setdefault(one.path, []).append(one)
    there = {file: _pieces(file, group) for file, group in wanted.items()}
    header = _header(sets, there)
    written = [_better(there[one.path][one.place], one, header) for one in sets]
    text, missing = write_sets(written, header)
    write_text(path, text)
    return missing


@dataclass(frozen=True)
class _Tle:
    """A TLE with its name, which may be empty, and what an OMM of it says beside its elements."""

    name: str
    first: str
    second: str
    said: Fields


def _pieces(path: FilePath, sets: Sequence[Better]) -> dict[int, Piece]:
    """Return the sets of a file by their places."""
    wanted = {one.place: one.line for one in sets}
    pieces = enumerate(mean_elements.pieces(path, contents(path)))
    there = {place: piece for place, piece in pieces if place in wanted}
    for place, line in wanted.items():
        if place not in there or _line(there[place]) != line:
            raise InputError(f"{path}: line {line}: expected the set that was read there, got another")
    return there


def _line(piece: Piece) -> int:
    """Return the line of a piece, of a TLE its line 1."""
    return piece.line if isinstance(piece, omm.Record) else piece[-2:][0][0]


def _header(sets: Sequence[Better], there: Mapping[str, Mapping[int, Piece]]) -> Fields:
    """Return author and date of messages: when the newest of the sets was made, else its epoch."""
    read = [mean_elements.element_set(one.path, one.place, there[one.path][one.place]) for one in sets]
    latest = seconds_since(_ANY, [one.satellite for one in read]).max()
    date = max(ccsds.creation_date(_ANY, latest), *(one.created for one in read), "")
    return {"CREATION_DATE": date, "ORIGINATOR": f"OPML {__version__}"}


def _better(piece: Piece, better: Better, header: Fields) -> _Tle | Fields:
    satellite = mean_elements.element_set(better.path, better.place, piece).satellite
    is_same = (better.motion, better.bstar) == (satellite.no_kozai, satellite.bstar)
    change = partial(tle.with_drag, motion=better.motion, bstar=better.bstar)
    said = {} if is_same else {"COMMENT": f"MEAN_MOTION and BSTAR improved by OPML {__version__}", **header}
    if not isinstance(piece, omm.Record):
        *name, (_, first), (_, second) = piece
        lines = (first, second) if is_same else change(first, second)
        return _Tle(name[0][1].removeprefix("0 ") if name else "", *lines, said)
    fields = {key: value for _, key, value in piece.pairs if key and value}
    if is_same:
        return fields
    if all(key in fields for key in _LINES):
        fields |= zip(_LINES, change(*(fields[key] for key in _LINES)), strict=True)
    numbers = {"MEAN_MOTION": f"{better.motion * PER_DAY:.10f}", "BSTAR": f"{better.bstar:.10g}"}
    return {key: value for key, value in fields.items() if key not in _DERIVED} | numbers | said


def _fields(one: _Tle | Fields) -> Fields:
    if not isinstance(one, _Tle):
        return one
    # sgp4 exports no set without an international designator.
    designator = one.first[9:17].strip()
    first = one.first if designator else f"{one.first[:9]}57001A  {one.first[17:]}"
    exported = exporter.export_omm(Satrec.twoline2rv(first, one.second), one.name or "UNKNOWN")
    fields = {
        key: (f"{value:.10g}" if isinstance(value, float) else str(value)) for key, value in exported.items()
    }
    return {**fields, **({} if designator else {"OBJECT_ID": "UNKNOWN"}), **one.said}


def _as_tle(sets: Sequence[_Tle | Fields], _: Fields) -> tuple[str, int]:
    lines: list[str] = []
    missing = 0
    for one in sets:
        try:
            name, first, second = (one.name, one.first, one.second) if isinstance(one, _Tle) else _lines(one)
        except InputError:
            missing += 1
            continue
        lines += [*([tle.name_line(name)] if name else []), first, second]
    return "".join(f"{line}\n" for line in lines), missing


def _lines(one: Fields) -> tuple[str, str, str]:
    """Return name and lines of a TLE of a message. Raises InputError for numbers beyond those of TLEs."""
    epoch = omm.time_text(one, "EPOCH") or ""
    satellite = omm.satellite({**one, "EPOCH": epoch, "NORAD_CAT_ID": "0"})
    return one.get("OBJECT_NAME", ""), *tle.exported(satellite, int(one.get("NORAD_CAT_ID", "0")))


def _as_json(sets: Sequence[_Tle | Fields], _: Fields) -> tuple[str, int]:
    objects = ",\n".join(
        "{"
        + ",".join(f"{json.dumps(key)}:{_json_value(key, value)}" for key, value in _fields(one).items())
        + "}"
        for one in sets
    )
    return f"[{objects}]\n", 0


def _json_value(key: str, value: str) -> str:
    if key in _TEXTS or key not in (*_ELEMENTS, *_OF_TLES):
        return json.dumps(value)
    return repr(float(value)) if any(mark in value.lower() for mark in ".e") else str(int(value))


def _as_csv(sets: Sequence[_Tle | Fields], _: Fields) -> tuple[str, int]:
    rows = [_fields(one) for one in sets]
    text = io.StringIO()
    writer = csv.DictWriter(
        text, list(dict.fromkeys(key for row in rows for key in row)), lineterminator="\n"
    )
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue(), 0


def _as_kvn(sets: Sequence[_Tle | Fields], header: Fields) -> tuple[str, int]:
    keys = (*_HEADER, *_METADATA, *_ELEMENTS, *_OF_TLES)
    whole = [{"CCSDS_OMM_VERS": "2.0", **_STANDARD, **header, **_fields(one)} for one in sets]
    texts = ["".join(f"{key} = {one[key]}\n" for key in keys if key in one) for one in whole]
    return "\n".join(texts).replace("COMMENT = ", "COMMENT "), 0


def _as_xml(sets: Sequence[_Tle | Fields], header: Fields) -> tuple[str, int]:
    messages = "".join(map(_xml_message, ({**_STANDARD, **header, **_fields(one)} for one in sets)))
    return f'<?xml version="1.0" encoding="UTF-8"?>\n<ndm>\n{messages}</ndm>\n', 0


def _xml_message(one: Fields) -> str:
    def part(keys: Sequence[str]) -> str:
        return "".join(f"<{key}>{escape(one[key])}</{key}>" for key in keys if key in one)

    return (
        '<omm id="CCSDS_OMM_VERS" version="2.0">'
        f"<header>{part(_HEADER[1:])}</header>"
        f"<body><segment><metadata>{part(_METADATA)}</metadata>"
        f"<data><meanElements>{part(_ELEMENTS)}</meanElements>"
        f"<tleParameters>{part(_OF_TLES)}</tleParameters></data></segment></body></omm>\n"
    )


WRITERS: Mapping[str, Callable[[Sequence[_Tle | Fields], Fields], tuple[str, int]]] = {
    **dict.fromkeys((".tle", ".txt", ".3le"), _as_tle),
    ".json": _as_json,
    ".csv": _as_csv,
    ".xml": _as_xml,
    **dict.fromkeys((".kvn", ".omm"), _as_kvn),
}
"""Writers by the suffix of the file, of sets and the header of messages."""
