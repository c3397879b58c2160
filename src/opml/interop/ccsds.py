"""What CCSDS's messages in key-value notation (KVN) share: their lines, times, numbers and frames.

Numbers keep every bit: the shortest text of a double is shifted to the message's unit as decimal digits, and
shifted back on reading. Times are printed to the microsecond.
Source: CCSDS 502.0-B-2 (orbit data messages), 503.0-B-2 (tracking data message).
"""

import math
import re
from collections.abc import Collection, Iterable, Mapping, Sequence
from datetime import date, timedelta
from decimal import Context, Decimal

import erfa
import numpy as np

from opml import __version__
from opml.base import epochs
from opml.base.errors import InputError
from opml.base.files import FilePath, replacing
from opml.interop import orbit_arcs

_TIME = re.compile(r"(\d{4})-(?:(\d\d)-(\d\d)|(\d{3}))T(\d\d):(\d\d):(\d\d(?:\.\d*)?)Z?", re.ASCII)
_NUMBER = re.compile(r"([+-]?(?:\d+\.?\d*|\.\d+))(?:[eE]([+-]?\d{1,4}))?", re.ASCII)
_PAIR = re.compile(r"([A-Z][A-Z0-9_]*)\s*=\s*(\S.*)", re.ASCII)

_FINE, _DOUBLE = Context(prec=40), Context(prec=17)
_DEGREE = Decimal("0.01745329251994329576923690768488612713443")
"""One degree in radians."""

SCALES = ("UTC", "TAI", "TT", "GPS")
"""Time systems that are read; messages are written in UTC."""

FRAMES = {"GCRF": np.eye(3), "ICRF": np.eye(3), "EME2000": np.asarray(erfa.bp06(2451545.0, 0.0)[0]).T}
"""Frames that are read, as rotations to GCRF; EME2000 is off by the bias (IERS Conventions 2010, 5.6)."""


class Message:
    """The lines of a message, read one after the other; empty ones and comments are passed over."""

    def __init__(self, path: FilePath, *, version_key: str, versions: Collection[str]) -> None:
        """Open a message. Raises InputError where it is missing, no text, or of another kind or version."""
        self.path = path
        try:
            text = orbit_arcs.contents(path).decode("utf-8-sig")
        except UnicodeDecodeError as reason:
            raise InputError(f"{path}: expected a message in UTF-8 text ({reason})") from None
        lines = [(number, line.strip()) for number, line in enumerate(text.splitlines(), start=1)]
        self._lines = [(n, line) for n, line in lines if line and not re.match(r"COMMENT\b", line)]
        self._at = 0
        expected = f"{version_key} = {' or '.join(versions)}"
        match = _PAIR.fullmatch(self.peek())
        if match is None or match[1] != version_key or match[2] not in versions:
            raise self.wrong(expected, self.peek())
        self.take()

    def peek(self) -> str:
        """Return the next line, '' at the end."""
        return self._lines[self._at][1] if self._at < len(self._lines) else ""

    @property
    def number(self) -> int:
        """Number of the next line in the file; at the end, of the last one."""
        return self._lines[min(self._at, len(self._lines) - 1)][0] if self._lines else 1

    def take(self) -> tuple[int, str]:
        """Return number and text of the next line and pass it. Raises InputError at the end."""
        if self._at == len(self._lines):
            raise self.wrong("more lines", "the end of the file")
        self._at += 1
        return self._lines[self._at - 1]

    def expect(self, text: str) -> None:
        """Pass a line that has to be `text`. Raises InputError where it is not."""
        if self.peek() != text:
            raise self.wrong(text, self.peek())
        self.take()

    def skip_header(self) -> None:
        """Pass the lines before the first segment. Raises InputError where one is no pair."""
        while self.peek() not in ("", "META_START"):
            self.pair()

    def skip(self, first: str, last: str) -> None:
        """Pass the lines from `first` to `last`, if the next one is `first`. Raises InputError at the end."""
        if self.peek() == first:
            while self.take()[1] != last:
                pass

    def pair(self) -> tuple[int, str, str]:
        """Return number, key and value of a line and pass it. Raises InputError where it is no pair."""
        match = _PAIR.fullmatch(self.peek())
        if match is None:
            raise self.wrong("KEY = value", self.peek())
        return self.take()[0], match[1], match[2].rstrip()

    def pairs(self, end: str) -> "Pairs":
        """Return the pairs before the line `end` and pass it. Raises InputError where a key stands twice."""
        values: dict[str, tuple[int, str]] = {}
        while self.peek() != end:
            if not self.peek():
                raise self.wrong(end, "")
            number, key, value = self.pair()
            if key in values:
                raise self.wrong(f"{key} once", "it twice", number)
            values[key] = number, value
        closing, _ = self.take()
        return Pairs(self, values, closing)

    def wrong(self, expected: str, got: str, number: int | None = None) -> InputError:
        """Return the error of a line, by default the next one."""
        return InputError(
            f"{self.path}: line {number or self.number}: expected {expected}, got {got or 'nothing'}"
        )

    def scaled(self, text: str, power: int, number: int) -> float:
        """Return a number times 10**power, rounded once. Raises InputError for what is no finite number."""
        match = _NUMBER.fullmatch(text)
        value = float(f"{match[1]}e{int(match[2] or 0) + power}") if match else math.inf
        if not math.isfinite(value):
            raise self.wrong("a finite number", text, number)
        return value

    def radians(self, text: str, number: int) -> float:
        """Return an angle in degrees as radians, rounded once. Raises InputError for no finite number."""
        self.scaled(text, 0, number)
        return float(_FINE.multiply(Decimal(text), _DEGREE))

    def elapsed(self, texts: Sequence[str], numbers: Sequence[int], *, epoch: str, scale: str) -> np.ndarray:
        """Times (n,) [s since `epoch`] of texts in a time system. Raises InputError, naming the line."""
        calendar = []
        for text, number in zip(texts, numbers, strict=True):
            match = _TIME.fullmatch(text)
            if match is None:
                raise self.wrong("a time like 2016-09-28T12:09:45", text, number)
            calendar.append((*_calendar_day(match), int(match[5]), int(match[6]), float(match[7])))
        if not texts:
            return np.empty(0)
        try:
            return orbit_arcs.elapsed(epoch, np.array(calendar), scale)
        except orbit_arcs.NoSuchTime as time:
            raise self.wrong("a time that exists", texts[time.index], numbers[time.index]) from None


class Pairs:
    """The keys of a header or of metadata, with their lines."""

    def __init__(self, message: Message, values: Mapping[str, tuple[int, str]], closing: int) -> None:
        self._message, self._values, self._closing = message, values, closing

    def one_of(self, key: str, allowed: Collection[str], default: str | None = None) -> str:
        """Return a value that has to be one of some. Raises InputError, naming the line."""
        number, value = self._value(key, default)
        if value.upper() not in allowed:
            raise self._message.wrong(f"{key} = {' or '.join(allowed)}", value, number)
        return value.upper()

    def line(self, key: str) -> int:
        """Return the line that a key stands in; without one, that of the end."""
        return self._values[key][0] if key in self._values else self._closing

    def text(self, key: str, default: str | None = None) -> str:
        """Return a value. Raises InputError where there is neither one nor a default."""
        return self._value(key, default)[1]

    def time(self, key: str, default: float, *, epoch: str, scale: str) -> float:
        """Return a time [s since `epoch`], `default` where there is none. Raises InputError with the line."""
        if key not in self._values:
            return default
        number, text = self._values[key]
        return float(self._message.elapsed([text], [number], epoch=epoch, scale=scale)[0])

    def _value(self, key: str, default: str | None) -> tuple[int, str]:
        if key in self._values:
            return self._values[key]
        if default is None:
            raise self._message.wrong(f"the key {key} before this line", "none", self._closing)
        return self._closing, default


def number_text(value: float, power: int) -> str:
    """Return the shortest text of a number times 10**power from which `Message.scaled` gets it back."""
    return str(Decimal(repr(float(value))).scaleb(power))


def degrees_text(angle: float) -> str:
    """Return the text in degrees of an angle [rad] from which `Message.radians` gets it back, 17 digits."""
    return str(_DOUBLE.plus(_FINE.divide(Decimal(float(angle)), _DEGREE)))


def utc_texts(epoch: str, t: np.ndarray) -> list[str]:
    """UTC texts of times t (n,) [s since `epoch`], to the microsecond."""
    year, month, day, clock = erfa.d2dtf("UTC", 6, *epochs.utc(epoch, np.atleast_1d(t)))
    fields = (year, month, day, clock["h"], clock["m"], clock["s"], clock["f"])
    rows = zip(*(np.atleast_1d(field).tolist() for field in fields), strict=True)
    return [f"{y:04d}-{mo:02d}-{d:02d}T{h:02d}:{mi:02d}:{s:02d}.{f:06d}" for y, mo, d, h, mi, s, f in rows]


def header(version_key: str, epoch: str) -> list[str]:
    """Lines that open a message; its date is the run's epoch, as the same input gives the same bytes."""
    return [
        f"{version_key} = 2.0",
        "COMMENT The creation date is the epoch of the simulation.",
        f"CREATION_DATE = {utc_texts(epoch, np.zeros(1))[0]}",
        f"ORIGINATOR = OPML {__version__}",
    ]


def write(path: FilePath, lines: Iterable[str]) -> None:
    """Write lines of text, all of them or none: a temporary file takes the name when it is complete."""
    with replacing(path) as temporary, temporary.open("w", encoding="utf-8", newline="\n") as file:
        file.writelines(f"{line}\n" for line in lines)


def _calendar_day(match: re.Match[str]) -> tuple[int, int, int]:
    """Year, month and day of a calendar date or a day of the year; checked later."""
    if match[4] is None:
        return int(match[1]), int(match[2]), int(match[3])
    number = int(match[4])
    try:
        day = date(int(match[1]), 1, 1) + timedelta(days=number - 1)
    except (OverflowError, ValueError):
        return int(match[1]), 0, 0
    return (day.year, day.month, day.day) if day.year == int(match[1]) else (int(match[1]), 0, 0)
