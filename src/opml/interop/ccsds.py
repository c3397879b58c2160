"""Lines, times, numbers and frames of CCSDS messages in key-value notation (KVN).

Numbers keep every bit: writing moves the decimal point of a double's shortest text to the message's unit, and
reading moves it back. Times are written to the microsecond.
Source: CCSDS 502.0-B-2 (orbit data messages), 503.0-B-2 (tracking data message).
"""

import math
import os
import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from datetime import UTC, date, datetime, timedelta
from decimal import Context, Decimal
from types import MappingProxyType
from typing import Self

import erfa
import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from opml import __version__
from opml.base import epochs
from opml.base.errors import InputError
from opml.base.files import FilePath, replacing
from opml.interop import ndm_xml, orbit_arcs
from opml.interop.orbit_arcs import line_error

_TIME = re.compile(r"(\d{4})-(?:(\d\d)-(\d\d)|(\d{3}))T(\d\d):(\d\d):(\d\d(?:\.\d*)?)Z?", re.ASCII)
_NUMBER = re.compile(r"([+-]?(?:\d+\.?\d*|\.\d+))(?:[eE]([+-]?\d{1,4}))?", re.ASCII)
_PAIR = re.compile(r"([A-Z][A-Z0-9_]*)\s*=\s*(.*)", re.ASCII)

_ROUNDED = 1.01  # what digits that were cut off may make of a correlation of 1
_FINE, _DOUBLE = Context(prec=40), Context(prec=17)
_DEGREE = Decimal("0.01745329251994329576923690768488612713443")  # one degree in radians
SCALES = ("UTC", "TAI", "TT", "GPS")  # time systems for reading; messages are written in UTC

_BIAS = np.asarray(erfa.bp06(2451545.0, 0.0)[0]).T
FRAMES = {"GCRF": np.eye(3), "ICRF": np.eye(3), "EME2000": _BIAS, "J2000": _BIAS}
"""Rotations of the frames for reading to GCRF; EME2000 differs by the bias (IERS Conventions 2010, 5.6)."""

DENSITY_COMMENT, DENSITY_KEY = "DCP Density Forecast Uncertainty", "DENSITY_FORECAST_UNCERTAINTY"
"""The standard deviation of the density forecast, in comments and as the key of CDM 2.0."""


def lines_of(
    path: FilePath, text: str, in_comments: Mapping[str, str] = MappingProxyType({})
) -> list[ndm_xml.NumberedLine]:
    """Return the numbered lines of messages in KVN or XML, without empty ones and comments.

    in_comments: keys whose values comments have, by the names that they have there

    Raises InputError, naming the line, for broken XML.
    """
    lines = [(n, _of_comment(line.strip(), in_comments)) for n, line in ndm_xml.lines(path, text)]
    return [(n, line) for n, line in lines if line and not re.match(r"COMMENT\b", line)]


def _of_comment(line: str, keys: Mapping[str, str]) -> str:
    """Return the pair that a comment makes of one of `keys`, any other line as it is."""
    name, _, value = line.removeprefix("COMMENT").partition("=")
    return f"{keys[name.strip()]} = {value.strip()}" if name.strip() in keys and value.strip() else line


def pair(line: str) -> tuple[str, str] | None:
    """Return key and value of a line, the latter may be empty; None for another line."""
    match = _PAIR.fullmatch(line)
    return match and (match[1], match[2].rstrip())


class Message:
    """A message, read line by line without empty lines and comments."""

    def __init__(
        self,
        path: FilePath,
        *,
        version_key: str,
        versions: Collection[str],
        in_comments: Mapping[str, str] = MappingProxyType({}),
    ) -> None:
        """Open a message and pass its first line.

        version_key: key of the first line
        versions: values that the first line may have
        in_comments: keys whose values comments have, by the names that they have there

        Raises InputError where the file is missing, no text, or of another kind or version.
        """
        self.path, self._version_key, self._versions = path, version_key, versions
        try:
            text = orbit_arcs.contents(path).decode("utf-8-sig")
        except UnicodeDecodeError as reason:
            raise InputError(f"{path}: expected a message in UTF-8 text ({reason})") from None
        self._lines = lines_of(path, text, in_comments)
        self._next = 0
        self._begin()

    def _begin(self) -> None:
        """Pass the first line of a message. Raises InputError for any other line."""
        key, version = pair(self.peek()) or ("", "")
        if key != self._version_key or version not in self._versions:
            raise self.error(f"{self._version_key} = {' or '.join(self._versions)}", self.peek())
        self.take()

    @property
    def is_over(self) -> bool:
        """Whether no line of the message is left; another message may follow in the file."""
        return not self.peek() or self.peek().startswith(self._version_key)

    def each(self) -> Iterator[Self]:
        """Yield the message itself for each that the file has in a row, to be read then."""
        yield self
        while self.peek():
            self._begin()
            yield self

    def segments(self) -> Iterator["KeyValues"]:
        """Yield the header of each segment, to be read then, of all messages that the file has in a row."""
        for message in self.each():
            header = message.header()
            yield header
            while not self.is_over:
                yield header

    def peek(self) -> str:
        """Return the next line, '' at the end."""
        return self._lines[self._next][1] if self._next < len(self._lines) else ""

    @property
    def number(self) -> int:
        """Number of the next line in the file; at the end, of the last line."""
        return self._lines[min(self._next, len(self._lines) - 1)][0] if self._lines else 1

    def take(self) -> tuple[int, str]:
        """Return number and text of the next line and pass it. Raises InputError at the end."""
        if self._next == len(self._lines):
            raise self.error("more lines", "the end of the file")
        self._next += 1
        return self._lines[self._next - 1]

    def expect(self, text: str) -> None:
        """Pass a line that must be `text`. Raises InputError for any other line."""
        if self.peek() != text:
            raise self.error(text, self.peek())
        self.take()

    def header(self) -> "KeyValues":
        """Return the pairs before the first segment. Raises InputError for a line that is no pair."""
        return self.pairs("META_START", "")

    def metadata(self) -> "KeyValues":
        """Return the pairs of a block of metadata and pass it. Raises InputError for anything else."""
        self.expect("META_START")
        values = self.pairs("META_STOP")
        self.take()
        return values

    def pair(self) -> tuple[int, str, str]:
        """Return number, key and value of a line and pass it. Raises InputError for any other line."""
        key, value = pair(self.peek()) or ("", "")
        if not value:
            raise self.error("KEY = value", self.peek())
        return self.take()[0], key, value

    def pairs(self, *ends: str) -> "KeyValues":
        """Return the pairs before a line of `ends`. Raises InputError for a repeated key."""
        values = KeyValues(self.path)
        while self.peek() not in ends:
            if not self.peek():
                raise self.error(ends[0], "")
            values.add(*self.pair())
        values.last = self.number
        return values

    def error(self, expected: str, got: str, number: int | None = None) -> InputError:
        """Return the error of a line, by default of the next line."""
        return line_error(self.path, number or self.number, expected, got)


def scaled(path: FilePath, line: int, text: str, power: int) -> float:
    """Return the number in a text, times 10**power, rounded once. Raises InputError for any other text."""
    match = _NUMBER.fullmatch(text)
    value = float(f"{match[1]}e{int(match[2] or 0) + power}") if match else math.inf
    if not math.isfinite(value):
        raise line_error(path, line, "a finite number", text)
    return value


def radians(path: FilePath, line: int, text: str) -> float:
    """Return the angle in a text [deg] in radians, rounded once. Raises InputError for any other text."""
    scaled(path, line, text, 0)
    return float(_FINE.multiply(Decimal(text), _DEGREE))


def times(
    path: FilePath, lines: Sequence[int], texts: Sequence[str], *, epoch: str, scale: str
) -> np.ndarray:
    """Return the times (n,) [s since `epoch`] of texts.

    scale: time system, one of SCALES

    Raises InputError, naming the line, for a text that is no time.
    """
    calendar = []
    for line, text in zip(lines, texts, strict=True):
        fields = _calendar(text)
        if fields is None:
            raise line_error(path, line, "a time like 2016-09-28T12:09:45", text)
        calendar.append(fields)
    if not calendar:
        return np.empty(0)
    return orbit_arcs.times(path, lines, texts, np.array(calendar), epoch=epoch, scale=scale)


def check_correlations(path: FilePath, line: int, covariance: np.ndarray) -> None:
    """Raise InputError for a covariance (k, k) whose correlations are beyond 1, but for rounding."""
    variances = np.diag(covariance)
    wrong = np.argwhere(np.abs(covariance) > _ROUNDED * np.sqrt(np.outer(variances, variances)))
    if len(wrong):
        row, column = wrong[0]
        got = f"{covariance[row, column]:g} for variances of {variances[row]:g} and {variances[column]:g}"
        raise line_error(path, line, "covariances with correlations of -1 to 1", got)


class KeyValues:
    """Values by their keys, with their lines: of a header, of metadata, of a set of elements.

    last: the line that errors of absent keys name
    """

    def __init__(self, path: FilePath, last: int = 0) -> None:
        self.path, self.last = path, last
        self._values: dict[str, tuple[int, str]] = {}

    def add(self, line: int, key: str, value: str) -> None:
        """Take a value. Raises InputError for a key that is there already."""
        if key in self._values:
            raise line_error(self.path, line, f"{key} once", "it twice")
        self._values[key] = line, value

    @property
    def texts(self) -> dict[str, str]:
        """Values by their keys, without empty ones."""
        return {key: value for key, (_, value) in self._values.items() if value}

    def choice(self, key: str, allowed: Collection[str], default: str | None = None) -> str:
        """Return the value of a key, in upper case. Raises InputError where it is not among `allowed`."""
        number, value = self._value(key, default)
        if value.upper() not in allowed:
            raise line_error(self.path, number, f"{key} = {' or '.join(allowed)}", value)
        return value.upper()

    def number(self, key: str, power: int = 0, default: str | None = None) -> float:
        """Return the number of a key times 10**power. Raises InputError as `text` and `scaled` do."""
        line, text = self._value(key, default)
        return scaled(self.path, line, text, power)

    def has(self, key: str) -> bool:
        """Return whether there is a value of a key."""
        return key in self._values

    def line(self, key: str) -> int:
        """Return the line of a key; for an absent key, the last line of the block."""
        return self._values[key][0] if key in self._values else self.last

    def text(self, key: str, default: str | None = None) -> str:
        """Return the value of a key. Raises InputError for an absent key without a default."""
        return self._value(key, default)[1]

    def time(self, key: str, default: float, *, epoch: str, scale: str) -> float:
        """Return the time of a key [s since `epoch`], `default` for an absent key.

        Raises InputError, naming the line, for a value that is no time.
        """
        if key not in self._values:
            return default
        line, text = self._values[key]
        return float(times(self.path, [line], [text], epoch=epoch, scale=scale)[0])

    def _value(self, key: str, default: str | None) -> tuple[int, str]:
        if key in self._values:
            return self._values[key]
        if default is None:
            raise line_error(self.path, self.last, f"the key {key} before this line", "none")
        return self.last, default


def number_text(value: float, power: int) -> str:
    """Return the shortest text of a number times 10**power from which `scaled` restores the number."""
    return str(Decimal(repr(float(value))).scaleb(power))


def number_texts(values: np.ndarray, power: int) -> list[str]:
    """Return the `number_text` of each of many numbers (n,) times a negative power of ten."""
    texts = pa.array(np.asarray(values, float)).cast(pa.string())
    # Of numbers from 1 on that have no exponent the point moves in all texts in one go.
    parts = pc.extract_regex(texts, r"^(?P<sign>-?)(?P<whole>[1-9]\d*)\.(?P<rest>\d+)$")
    sign, whole, rest = (pc.struct_field(parts, name) for name in ("sign", "whole", "rest"))
    whole = pc.utf8_lpad(whole, 1 - power, "0")
    before, behind = pc.utf8_slice_codeunits(whole, 0, power), pc.utf8_slice_codeunits(whole, power)
    moved = pc.binary_join_element_wise(sign, before, ".", behind, rest, "").to_pylist()
    return [
        number_text(value, power) if text is None else text for value, text in zip(values, moved, strict=True)
    ]


def lines(times: Sequence[str], numbers: np.ndarray, power: int) -> list[str]:
    """Return a line of each time and its numbers (n, k) times a negative power of ten."""
    columns = [number_texts(column, power) for column in numbers.T]
    return [" ".join(line) for line in zip(times, *columns, strict=True)]


def degrees_text(angle: float) -> str:
    """Return the text in degrees of an angle [rad], in 17 digits; `radians` restores the angle."""
    return str(_DOUBLE.plus(_FINE.divide(Decimal(float(angle)), _DEGREE)))


def utc_texts(epoch: str, t: np.ndarray) -> list[str]:
    """Return the UTC texts of times t (n,) [s since `epoch`], to the microsecond."""
    with epochs.strict_erfa():
        year, month, day, clock = erfa.d2dtf("UTC", 6, *epochs.utc(epoch, np.atleast_1d(t)))
    fields = (year, month, day, clock["h"], clock["m"], clock["s"], clock["f"])
    rows = zip(*(np.atleast_1d(field).tolist() for field in fields), strict=True)
    return [f"{y:04d}-{mo:02d}-{d:02d}T{h:02d}:{mi:02d}:{s:02d}.{f:06d}" for y, mo, d, h, mi, s, f in rows]


def header(version_key: str, epoch: str, newest: float) -> list[str]:
    """Return the first lines of a message; version_key, and the others as in `creation_date`."""
    return [
        f"{version_key} = 2.0",
        "COMMENT The creation date is that of the newest input.",
        f"CREATION_DATE = {creation_date(epoch, newest)}",
        f"ORIGINATOR = OPML {__version__}",
    ]


def creation_date(epoch: str, newest: float) -> str:
    """Return the date of a message, which is no clock's, so that runs repeat byte for byte.

    newest: time of the newest of what the message is made from [s since `epoch`]

    The variable SOURCE_DATE_EPOCH of the environment [s since 1970] comes before it. Raises InputError where
    that is no number. Source: reproducible-builds.org, SOURCE_DATE_EPOCH.
    """
    if (text := os.environ.get("SOURCE_DATE_EPOCH")) is None:
        return utc_texts(epoch, np.array([newest]))[0]
    try:
        return datetime.fromtimestamp(int(text), UTC).replace(tzinfo=None).isoformat(timespec="microseconds")
    except (OSError, OverflowError, ValueError):
        raise InputError(f"SOURCE_DATE_EPOCH: expected seconds since 1970, got {text}") from None


def write(path: FilePath, lines: Iterable[str]) -> None:
    """Write a file of lines, whole or not at all: a temporary file takes the name when it is complete."""
    with replacing(path) as temporary, temporary.open("w", encoding="utf-8", newline="\n") as file:
        file.writelines(f"{line}\n" for line in lines)


def utc_text(text: str) -> str | None:
    """Return a time in UTC, of a calendar date or a day of the year, to the microsecond; None for no time.

    Leap seconds are none here: no datetime has them.
    """
    fields = _calendar(text)
    if fields is None:
        return None
    year, month, day, hour, minute, seconds = fields
    try:
        time = datetime(year, month, day, hour, minute) + timedelta(seconds=seconds)
    except (OverflowError, ValueError):
        return None
    return time.isoformat(timespec="microseconds") if seconds < 60.0 else None


def _calendar(text: str) -> tuple[int, int, int, int, int, float] | None:
    """Return year, month, day, hour, minute and second of a text, not checked yet; None for another text."""
    match = _TIME.fullmatch(text)
    return match and (*_calendar_day(match), int(match[5]), int(match[6]), float(match[7]))


def _calendar_day(match: re.Match[str]) -> tuple[int, int, int]:
    """Return year, month and day of a calendar date or a day of the year, not checked yet."""
    if match[4] is None:
        return int(match[1]), int(match[2]), int(match[3])
    number = int(match[4])
    try:
        day = date(int(match[1]), 1, 1) + timedelta(days=number - 1)
    except (OverflowError, ValueError):
        return int(match[1]), 0, 0
    return (day.year, day.month, day.day) if day.year == int(match[1]) else (int(match[1]), 0, 0)
