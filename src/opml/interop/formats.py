"""The formats of files in one list: how each begins, and what reads it. A reader is a file, and a line here.

A reader of an orbit takes path, content, epoch and satellite (of `choose_satellites`) and returns arcs; that
of element sets takes path and content and yields a piece for each set.
"""

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

from opml.base.errors import InputError, OtherContentError
from opml.base.files import FilePath
from opml.interop import fixes_csv, oem
from opml.interop.element_sets import omm, tle
from opml.interop.orbit_arcs import contents, excerpt
from opml.interop.orbit_formats import cpf, itc, sp3, stk
from opml.tables import is_table

ORBIT, TRACKS, ELEMENTS = "an orbit", "tracks", "element sets"
CONJUNCTION, TABLE = "a conjunction", "a table of opml"
_OTHER = "a file that is not read here"
_BESIDE = "a file that belongs beside element sets"
_SHOWN = 400  # bytes of an unknown file, in whose first line an error shows what it is


@dataclass(frozen=True)
class Format:
    """A format: what its files hold, how bytes of one are recognised, and its reader.

    read: None where no other format holds the same, so that callers have its module
    """

    name: str
    kind: str
    matches: Callable[[bytes], bool]
    read: Callable[..., Any] | None = None


def _begins(pattern: bytes) -> Callable[[bytes], bool]:
    # The blanks are given back to no pattern: files of many would take minutes.
    begin = re.compile(rb"\s*+" + pattern, re.IGNORECASE)
    return lambda content: begin.match(content) is not None


def _message(name: bytes) -> Callable[[bytes], bool]:
    """Return what recognises a CCSDS message in KVN or XML, of any version."""
    in_xml = rb"(?=<)(?s:.*?)<(?:\w+:)?" + name + rb"\b"
    return _begins(rb"(?:(?:COMMENT\b.*\s*)*CCSDS_" + name + rb"_VERS\s*=|" + in_xml + rb")")


def _of_text(read: Callable[[FilePath, str], Iterator[Any]]) -> Callable[[FilePath, bytes], Iterator[Any]]:
    """Return the reader of a file's bytes that a reader of text makes."""
    return lambda path, content: read(path, _text(path, content))


def _text(path: FilePath, content: bytes) -> str:
    try:
        text = content.decode()
    except UnicodeDecodeError as reason:
        raise InputError(f"{path}: expected text in UTF-8 ({reason})") from None
    if "\0" in text:
        raise InputError(f"{path}: expected text in UTF-8, got bytes that are none")
    return text


def _is_other_json(content: bytes) -> bool:
    return re.match(rb"\[?\s*\{", content) is not None and b"MEAN_MOTION" not in content


FORMATS = (
    Format("a list of objects (SATCAT)", _BESIDE, _begins(rb"[^\n]{,2000}\b(?:OPS_STATUS_CODE|SATNAME)\b")),
    Format("a list of objects (SATCAT)", _BESIDE, _begins(rb"\d{4}-\d{3}[A-Z ]{3}\s+\d{5}\s")),
    Format("space weather", _BESIDE, _begins(rb"DATE,BSRN,|DATATYPE CssiSpaceWeather")),
    Format("Earth orientation", _BESIDE, _begins(rb"DATE,MJD,")),
    Format("Space-Track: a login that failed", _OTHER, _begins(rb"\{\s*\"Login\"\s*:\s*\"Failed")),
    Format("Space-Track: an error", _OTHER, _begins(rb"\[?\s*+\{\s*\"error\"\s*:")),
    Format("TLE", ELEMENTS, tle.matches, _of_text(tle.pieces)),
    Format("JSON without MEAN_MOTION", _OTHER, _is_other_json),
    Format("OMM", ELEMENTS, _begins(rb"[\[{]"), _of_text(omm.read_json)),
    Format("OMM", ELEMENTS, _message(b"OMM"), _of_text(omm.read_messages)),
    Format("OMM", ELEMENTS, omm.is_csv, _of_text(omm.read_csv)),
    Format("OEM", ORBIT, _message(b"OEM"), oem.read),
    Format("SP3", ORBIT, _begins(rb"#[a-z][PV]\d{4}"), sp3.read),
    Format("CPF", ORBIT, _begins(rb"H1\s+CPF\b"), cpf.read),
    Format("modified ITC", ORBIT, _begins(rb"created:\s*\d{4}-"), itc.read),
    Format("STK", ORBIT, _begins(rb"stk\.v\."), stk.read),
    Format("TDM", TRACKS, _message(b"TDM")),
    Format("CDM", CONJUNCTION, _message(b"CDM")),
    Format("Parquet", TABLE, is_table),
    Format("laser ranges (CRD), which a study reads: opml docs tracks", _OTHER, _begins(rb"H1\s+CRD\b")),
    Format("a web page", _OTHER, _begins(rb"(?:<\?xml[^>]*>\s*)?<(?:!DOCTYPE\s+)?html\b")),
    Format("CelesTrak: not updated", _OTHER, _begins(rb"GP data has not updated")),
    Format("CelesTrak: no such object", _OTHER, _begins(rb"No (?:Sup)?GP data found")),
    Format("CelesTrak: an invalid query", _OTHER, _begins(rb"Invalid query")),
    Format("an archive, not gzip", _OTHER, _begins(rb"PK\x03\x04|BZh|\xfd7zXZ|\x1f\x9d|7z\xbc\xaf")),
    Format("CSV of points", ORBIT, fixes_csv.matches, fixes_csv.read),
    Format("TLE", ELEMENTS, tle.has_lines, _of_text(tle.pieces)),
)
"""All formats; the first that matches a file is its own."""


def names(kind: str) -> str:
    """Return the formats of a kind, in words."""
    return ", ".join(dict.fromkeys(one.name for one in FORMATS if one.kind == kind))


def filled_in(text: str) -> str:
    """Return a text whose {elements}, {orbit} and {tracks} are the names of these formats."""
    return text.format(elements=names(ELEMENTS), orbit=names(ORBIT), tracks=names(TRACKS))


def of(path: FilePath, content: bytes, *kinds: str) -> Format:
    """Return the format of a file's content. Raises InputError where it is of none of some kinds."""
    known = next((one for one in FORMATS if one.matches(content)), None)
    if known is not None and known.kind in kinds:
        return known
    expected = " or ".join(f"{kind} ({names(kind)})" for kind in kinds)
    error = OtherContentError if known and known.kind == _BESIDE else InputError
    raise error(f"{path}: expected {expected}, got {known.name if known else _shown(content)}")


def kind_of(path: FilePath, *kinds: str) -> str:
    """Return which of some kinds a file is, a folder one of element sets. Raises InputError as `of`."""
    return ELEMENTS if Path(path).is_dir() else of(path, contents(path), *kinds).kind


def read(path: FilePath, content: bytes, kind: str, **options: Any) -> Any:
    """Read a file of a kind by its format's reader. Raises InputError as `of` and the reader do."""
    return cast("Callable[..., Any]", of(path, content, kind).read)(path, content, **options)


def _shown(content: bytes) -> str:
    """Return what an unknown file is, in words."""
    try:
        begin = content[:_SHOWN].decode("utf-8", "strict" if len(content) <= _SHOWN else "ignore").strip()
    except UnicodeDecodeError:
        begin = "\0"
    if "\0" in begin:
        return "bytes that are no text in UTF-8"
    return excerpt(repr(begin.splitlines()[0])) if begin else "an empty file"
