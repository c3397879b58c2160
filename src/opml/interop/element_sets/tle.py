"""Two-line elements: the sets of a text, each with or without a name above it (3LE), and lines to write.

Source: Vallado, Crawford, Hujsak & Kelso 2006, Revisiting Spacetrack Report #3 (AIAA 2006-6753), appendix B;
Space-Track, Alpha-5: a letter other than I and O is the first two digits of a number from 100000 to 339999.
"""

import logging
import re
from calendar import isleap
from collections.abc import Iterator, Sequence
from datetime import date, timedelta
from itertools import zip_longest

import numpy as np
from sgp4 import exporter
from sgp4.alpha5 import from_alpha5, to_alpha5
from sgp4.api import Satrec

from opml.base.errors import InputError
from opml.base.files import FilePath
from opml.interop import ccsds
from opml.interop.element_sets.element_set import PER_DAY, ElementSet, check_orbit
from opml.interop.object_ids import ObjectId
from opml.interop.orbit_arcs import line_error

Line = tuple[int, str]  # number and text of a line
LARGEST_NUMBER = 339_999  # largest catalogue number of a TLE, Z9999 there
FOR_TESTS = 99999  # catalogue number of an object of which none is known

EPHEMERIS_TYPES = ("0", "2", "3")
"""Types of elements that SGP4 propagates, 0 in what is published; 4 are those of SGP4-XP, another theory."""

_FIRST_DAY, _JULIAN_1957, _YEARS = date(1957, 1, 1), 2435839.5, 100
_DAY_PARTS = 10**8  # of a day that an epoch resolves
_FIRST_YEAR = 57  # two digits of the first year of a TLE, 1957; smaller ones are of this century
_COLUMNS = 69  # of a line
_LONGEST_NAME = 68  # letters of a name: a text as long as a line of a TLE is a damaged one

_WORTH = bytes(int(chr(k)) if chr(k) in "0123456789" else chr(k) == "-" for k in range(256))
"""What each byte counts in a checksum: digits their value, minus signs one."""


_log = logging.getLogger(__name__)


def _right(width: int) -> str:
    """Return the pattern of a field of digits, blanks before them."""
    return "(?:" + "|".join(f"{' ' * k}" + rf"\d{{{width - k}}}" for k in range(width + 1)) + ")"


_NUMBER = rf"(?:[A-HJ-NP-Z]\d{{4}}|(?! {{5}}){_right(5)})"
_LINE = re.compile(rb"^[12] [ A-Z\d][ \d]{3}\d[ A-Z]", re.MULTILINE)
_BEGIN = re.compile(rb"\s*(?:[^\n]{1,%d}\n)?" % (_LONGEST_NAME + 1) + _LINE.pattern, re.MULTILINE)
_EXPONENT = r"[ +-]\d{5}[+-]\d"
_ANGLE = rf"{_right(3)}\.\d{{4}}"
_PATTERNS = {
    "1": re.compile(
        rf"1 {_NUMBER}[ A-Z] [ -~]{{8}} \d\d{_right(3)}\.\d{{8}} [ +-]\.\d{{8}} "
        rf"{_EXPONENT} {_EXPONENT} [ \d] {_right(4)}\d",
        re.ASCII,
    ),
    "2": re.compile(
        rf"2 {_NUMBER} {_ANGLE} {_ANGLE} (?! {{7}}){_right(7)} {_ANGLE} {_ANGLE} "
        rf"{_right(2)}\.\d{{8}}{_right(5)}\d",
        re.ASCII,
    ),
}


def matches(content: bytes) -> bool:
    """Return whether the first line of a file, or one below a name, begins as those of a TLE do."""
    return _BEGIN.match(content) is not None


def has_lines(content: bytes) -> bool:
    """Return whether any line of a file begins as those of a TLE do."""
    return _LINE.search(content) is not None


def pieces(path: FilePath, text: str) -> Iterator[list[Line]]:
    """Yield the lines of each set: from its name or line 1 up to its line 2, or to where the next begins.

    Between a line 2 alone and the next line 1 alone, lines 2 may be written before lines 1: each line there
    is a piece of its own.
    """
    doubtful: list[list[Line]] = []
    for piece in _cut(path, text):
        kinds = "".join(line[0] for _, line in piece[-2:])
        if kinds.endswith("1"):
            yield from ([line] for pair in doubtful for line in pair)
            doubtful = []
            yield piece
        elif doubtful or (kinds.endswith("2") and kinds != "12"):
            doubtful.append(piece)
        else:
            yield piece
    yield from doubtful


def _cut(path: FilePath, text: str) -> Iterator[list[Line]]:
    """Yield lines up to a line 2, or to where another set begins."""
    piece: list[Line] = []
    has_first = False
    for number, line in enumerate(text.splitlines(), start=1):
        line = _without_additions(path, number, line)
        if not line or line.startswith("#"):
            continue
        kind = _kind(line)
        if has_first and kind != "2":
            yield piece
            piece, has_first = [], False
        piece.append((number, line))
        has_first |= kind == "1"
        if kind == "2":
            yield piece
            piece, has_first = [], False
    if piece:
        yield piece


def _without_additions(path: FilePath, number: int, line: str) -> str:
    """Return a line without what some programs add to its 69 columns, with the checksum that some omit.

    These are times to propagate to, as in the verification of SGP4, and a backslash.
    """
    line = line.rstrip().removesuffix("\\").rstrip()
    if not line.startswith(("1 ", "2 ")) or len(line) < _COLUMNS - 1:
        return line
    if len(line) > _COLUMNS and line[_COLUMNS].isspace() and _PATTERNS[line[0]].fullmatch(line[:_COLUMNS]):
        return line[:_COLUMNS]
    if len(line) == _COLUMNS - 1 and _PATTERNS[line[0]].fullmatch(f"{line}0"):
        _log.warning("%s: line %d: no checksum, taken as it is", path, number)
        return _summed(line)
    return line


def element_set(path: FilePath, piece: Sequence[Line]) -> ElementSet:
    """Return the set of a piece. Raises InputError, naming the line, for a damaged one."""
    named = _kind(piece[0][1]) == "0" and len(piece[0][1]) <= _LONGEST_NAME
    for kind, line in zip_longest("12", piece[named:]):
        _check_line(path, piece[-1][0], line, kind or "1")
    (number, first), (second_number, second) = piece[named:]
    if first[2:7] != second[2:7]:
        raise line_error(path, second_number, f"catalogue number {first[2:7]}", second[2:7])
    if (kind := first[62].replace(" ", "0")) not in EPHEMERIS_TYPES:
        raise line_error(path, number, f"the ephemeris type {' or '.join(EPHEMERIS_TYPES)}", kind)
    year = int(first[18:20]) + (1900 if int(first[18:20]) >= _FIRST_YEAR else 2000)
    days = 366 if isleap(year) else 365
    if not 1.0 <= float(first[20:32]) < days + 1:
        raise line_error(path, number, f"a day from 1 to {days} of {year}", first[20:32])
    satellite = Satrec.twoline2rv(first, second)
    check_orbit(path, second_number, satellite)
    name = piece[0][1].removeprefix("0 ").strip() if named else ""
    catalogued, designator = from_alpha5(first[2:7].strip()), first[9:17].strip()
    return ElementSet(path, number, catalogued, "", satellite, name, designator)


def lines(satellite: Satrec, number: int, launch: str = "") -> tuple[str, str]:
    """Return the two lines of a set under a catalogue number.

    launch: international designator as TLEs have it, 98067A

    Raises InputError for a number, an epoch or elements beyond those of TLEs.
    """
    name = _number_text(number)
    angles = np.rad2deg([satellite.nodeo, satellite.argpo, satellite.mo])
    node, perigee, anomaly = (f"{round(angle, 4) % 360.0:8.4f}" for angle in angles)
    motion = f"{satellite.no_kozai * PER_DAY:11.8f}"
    return _whole(
        f"1 {name}U {launch:8} {_epoch_text(satellite)}  .00000000  00000+0 "
        f"{_exponent_text(satellite.bstar)} 0    0",
        f"2 {name} {np.rad2deg(satellite.inclo):8.4f} {node} {round(1e7 * satellite.ecco):07d} "
        f"{perigee} {anomaly} {motion}    0",
    )


def name_line(name: str) -> str:
    """Return the line of a name above its set, that is read as one."""
    text = name[: _LONGEST_NAME - 2]
    return f"0 {text}" if _kind(text) != "0" or text.startswith("#") else text


def exported(satellite: Satrec, number: int) -> tuple[str, str]:
    """Return the two lines of a set with all that a TLE has beside its orbit, as sgp4 writes them.

    sgp4 takes letters that catalogues leave out, epochs beyond the year's end and exponents of two digits.
    Raises InputError as `lines` does.
    """
    name, (first, second) = _number_text(number), exporter.export_tle(satellite)
    bstar = _exponent_text(satellite.bstar)
    return _whole(
        f"1 {name}{first[7:18]}{_epoch_text(satellite)}{first[32:53]}{bstar} {first[-7:-1]}",
        f"2 {name}{second[7:-1]}",
    )


def _whole(first: str, second: str) -> tuple[str, str]:
    """Return two lines with checksums. Raises InputError for numbers that their columns cannot hold."""
    lines = _summed(first), _summed(second)
    for kind, line in zip("12", lines, strict=True):
        if not _PATTERNS[kind].fullmatch(line):
            raise InputError(f"TLE: expected numbers that its columns hold, got {line!r}")
    return lines


def _number_text(number: int) -> str:
    if not 0 < number <= LARGEST_NUMBER:
        raise InputError(f"number: expected one of a TLE, 1 to {LARGEST_NUMBER}, got {number}")
    return str(to_alpha5(number))


def _epoch_text(satellite: Satrec) -> str:
    """Return year and day of an epoch; rounded to the year's end, it is the first moment of the next."""
    parts = round((satellite.jdsatepoch - _JULIAN_1957) * _DAY_PARTS + satellite.jdsatepochF * _DAY_PARTS)
    days, part = divmod(parts, _DAY_PARTS)
    day = _FIRST_DAY + timedelta(days=days)
    if not 0 <= day.year - _FIRST_DAY.year < _YEARS:
        raise InputError(f"epoch: expected one of a TLE, from 1957 to 2056, got {day}")
    return f"{day:%y%j}.{part:08d}"


def with_drag(first: str, second: str, *, motion: float, bstar: float) -> tuple[str, str]:
    """Return the two lines of a set with another mean motion [rad/min] and B*."""
    return _whole(
        f"{first[:53]}{_exponent_text(bstar)}{first[61:68]}",
        f"{second[:52]}{motion * PER_DAY:11.8f}{second[63:68]}",
    )


def write(path: FilePath, satellite: Satrec, identity: ObjectId) -> None:
    """Write a set of an object as a TLE, whole or not at all.

    Raises InputError for a number beyond those of TLEs.
    """
    ccsds.write(path, lines(satellite, identity.number or FOR_TESTS, identity.launch))


def _summed(line: str) -> str:
    return f"{line}{_checksum(line)}"


def _exponent_text(value: float) -> str:
    """Return a number as a mantissa of five digits after the point and an exponent of one."""
    mantissa, exponent = f"{abs(value):.4e}".split("e")
    power = int(exponent) + 1
    if power < -9:
        return " 00000+0"
    return f"{'-' if value < 0.0 else ' '}{mantissa.replace('.', '')}{power:+d}"


def _kind(line: str) -> str:
    """Return "1" or "2" for these lines of a TLE, "0" for a name, which may begin with 1, or for another."""
    is_line = re.match(rf"[12] {_NUMBER}", line) or (len(line) > _LONGEST_NAME and line[:2] in ("1 ", "2 "))
    return line[0] if is_line else "0"


def _check_line(path: FilePath, last: int, line: Line | None, kind: str) -> None:
    if line is None:
        raise line_error(path, last, f"line {kind} of a TLE after this line", "none")
    number, text = line
    if not _PATTERNS[kind].fullmatch(text):
        error = line_error(path, number, f"line {kind} of a TLE", repr(text))
        raise error if len(text) == _COLUMNS else InputError(f"{error}: {len(text)} columns, not {_COLUMNS}")
    if _checksum(text) != int(text[68]):
        raise line_error(path, number, f"the checksum {_checksum(text)}", text[68])


def _checksum(line: str) -> int:
    return sum(line[:68].encode("ascii").translate(_WORTH)) % 10
