"""Reader of positions, with velocities or without, from CSV: the fixes of a GPS receiver.

The first line says what the columns are; a column called - is passed over:

    gps,x_itrf_m,y_itrf_m,z_itrf_m,-,sigma_r_m,sigma_s_m,sigma_w_m
    2019-09-03T00:00:00.000,1602171.9,5991628.1,-2835238.7,0.9,3,6,3

Times are in UTC, GPS, TAI or TT, states in ITRF or GCRF, lengths in m or km. Standard deviations are those
along the radial direction, along the track and across it.
"""

import csv
import re
from collections.abc import Sequence

import numpy as np

from opml.base.errors import InputError
from opml.base.files import FilePath
from opml.interop.element_sets import omm
from opml.interop.orbit_arcs import Arc, NoSuchTime, check_ascending, line_error, numbers, seconds_since

PASSED_OVER = "-"  # name of a column that is not read
SCALES = ("utc", "gps", "tai", "tt")  # names of columns of times

EXAMPLE = "utc,x_itrf_m,y_itrf_m,z_itrf_m"

_STATE = re.compile(r"(?P<axis>v?[xyz])_(?P<frame>itrf|gcrf)_(?P<unit>k?m(?:ps)?)")
_SIGMA = re.compile(r"sigma_(?P<axis>v?[rsw])_(?P<unit>k?m(?:ps)?)")
_GROUPS = (("x", "y", "z"), ("vx", "vy", "vz"), ("r", "s", "w"), ("vr", "vs", "vw"))
_TIME = re.compile(r"(\d{4})-(\d\d)-(\d\d)[T ](\d\d):(\d\d):(\d\d(?:\.\d+)?)Z?", re.ASCII)


def matches(content: bytes) -> bool:
    """Return whether the first line of a file has columns, and not those of mean elements."""
    text = content.decode("utf-8", errors="replace")
    first = next((line for line in text.splitlines() if line.strip() and not line.startswith("#")), "")
    return "," in first and not omm.matches(text)


def read(
    path: FilePath, content: bytes, *, epoch: str, satellite: str | None = None
) -> tuple[Arc, np.ndarray]:
    """Read the points of a CSV, and their standard deviations (n, 6) [m, m/s], NaN where it has none.

    Raises InputError for a satellite that is asked for, and, naming the line, for columns of which no points
    can be made, a cell that is no number or no time, and times that do not ascend.
    """
    if satellite is not None:
        raise InputError(f"{path}: expected no name of an object, as a CSV has none, got {satellite}")
    (number, names), *rows = _lines(path, content)
    columns = _Columns(path, number, [name.strip().lower() for name in names])
    if not rows:
        raise InputError(f"{path}: expected points below its first line, got none")
    for line, cells in rows:
        if len(cells) != len(names):
            raise line_error(path, line, f"{len(names)} cells, as in its first line", f"{len(cells)}")
    lines, table = np.array([line for line, _ in rows]), np.array([cells for _, cells in rows])
    t = _times(path, table[:, columns.time], lines, columns.scale, epoch)
    check_ascending(path, t, lines)
    positions, velocities, *deviations = (columns.values(table, lines, group) for group in _GROUPS)
    sigmas = np.concatenate(deviations, axis=1)
    wrong = np.flatnonzero((sigmas <= 0.0).any(axis=1))
    if wrong.size:
        got = f"{np.nanmin(sigmas[wrong[0]]):g}"
        raise line_error(path, int(lines[wrong[0]]), "standard deviations above 0", got)
    frame = columns.frame.upper()
    return Arc(path, "", frame, frame, columns.scale.upper(), t, positions, velocities, lines), sigmas


def _lines(path: FilePath, content: bytes) -> list[tuple[int, list[str]]]:
    try:
        text = content.decode()
    except UnicodeDecodeError as reason:
        raise InputError(f"{path}: expected SP3, CPF, OEM or CSV, got no text ({reason})") from None
    lines = [
        (number, _cells(path, number, line))
        for number, line in enumerate(text.splitlines(), start=1)
        if line.strip() and not line.startswith("#")
    ]
    if not lines:
        raise InputError(f"{path}: expected a line of columns, such as {EXAMPLE}, got an empty file")
    return lines


def _cells(path: FilePath, number: int, line: str) -> list[str]:
    if "\0" in line:
        raise line_error(path, number, "text", "bytes that are none")
    try:
        return next(csv.reader([line], strict=True))
    except csv.Error as reason:
        raise line_error(path, number, "cells of CSV", str(reason)) from None


class _Columns:
    """What the columns of a CSV are: their places by axis, with a factor to SI."""

    def __init__(self, path: FilePath, number: int, names: Sequence[str]) -> None:
        """Take the names in the first line, which has a number. Raises InputError for others than known."""
        self.path, self.number = path, number
        self._places: dict[str, tuple[int, float]] = {}
        times, frames = [], []
        for place, name in enumerate(names):
            if names.count(name) > 1 and name != PASSED_OVER:
                raise self._wrong(f"one column {name}", f"{names.count(name)}")
            if name in SCALES:
                times.append(place)
            elif match := _STATE.fullmatch(name) or _SIGMA.fullmatch(name):
                self._add(name, match, place)
                frames += [match["frame"]] if "frame" in match.groupdict() else []
            elif name != PASSED_OVER:
                raise self._wrong(f"columns such as {EXAMPLE}, and - for one to pass over", name)
        if len(times) != 1:
            raise self._wrong(
                f"one column of times, {', '.join(SCALES[:-1])} or {SCALES[-1]}", f"{len(times)}"
            )
        self.time, self.scale = times[0], names[times[0]]
        self._check_groups()
        if len(set(frames)) > 1:
            raise self._wrong("one frame in all columns", " and ".join(sorted(set(frames))))
        self.frame = frames[0]

    def _add(self, name: str, match: re.Match[str], place: int) -> None:
        axis, unit = match["axis"], match["unit"]
        if unit.endswith("ps") != axis.startswith("v"):
            expected = "mps or kmps for a velocity, m or km for a length"
            raise self._wrong(f"{expected} in {name}", unit)
        if axis in self._places:
            raise self._wrong(f"one column of {axis}", "two")
        self._places[axis] = place, 1e3 if unit.startswith("k") else 1.0

    def _check_groups(self) -> None:
        """Raise InputError where positions are not whole, or other columns that belong together are not."""
        for group in _GROUPS:
            there = [axis for axis in group if axis in self._places]
            if len(there) not in (0, len(group)) or (group is _GROUPS[0] and not there):
                raise self._wrong(f"columns of {', '.join(group)}", ", ".join(there) or "none of them")
        if "vr" in self._places and "vx" not in self._places:
            raise self._wrong("velocities with their standard deviations", "none")

    def values(self, table: np.ndarray, lines: np.ndarray, group: Sequence[str]) -> np.ndarray:
        """Return the numbers (n, 3) of a group of axes in SI; NaN where the CSV has no such columns."""
        if group[0] not in self._places:
            return np.full((len(table), len(group)), np.nan)
        places, factors = zip(*(self._places[axis] for axis in group), strict=True)
        return numbers(self.path, table[:, list(places)], lines) * np.array(factors)

    def _wrong(self, expected: str, got: str) -> InputError:
        return line_error(self.path, self.number, expected, got)


def _times(path: FilePath, texts: np.ndarray, lines: np.ndarray, scale: str, epoch: str) -> np.ndarray:
    matches = [_TIME.fullmatch(text.strip()) for text in texts]
    for match, line, text in zip(matches, lines, texts, strict=True):
        if match is None:
            raise line_error(path, int(line), "a time such as 2019-09-03T00:00:00.000", str(text))
    calendar = np.array([match.groups() for match in matches if match], dtype=float)
    try:
        return seconds_since(epoch, calendar, scale.upper())
    except NoSuchTime as time:
        wrong = int(lines[time.index]), "a time that exists", str(texts[time.index])
        raise line_error(path, *wrong) from None
