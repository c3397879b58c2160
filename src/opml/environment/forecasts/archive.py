"""Archive: published forecasts, from tables or from the predicted days of CSSI's files.

A table is tab-separated text with the columns issued, valid (UTC, such as 2016-09-28T00:00:00), f107 [sfu],
and kp or ap. A row holds from `valid` until the next row of the same issue; the last row has no end. A CSSI
file counts as issued at the end of its last measured day.
"""

import math
from collections.abc import Iterator, Mapping
from glob import glob
from itertools import groupby
from operator import attrgetter
from typing import Annotated, NamedTuple

import numpy as np
from annotated_types import MinLen

from opml.base import epochs
from opml.base.errors import InputError
from opml.base.setting_types import Text
from opml.environment import solar_activity, space_weather
from opml.environment.forecasts.method import Forecast, ForecastMethod, ForecastSettings, Future
from opml.environment.space_weather import INTERVALS, MEASURED, ROUNDING
from opml.environment.weather import Weather

_COLUMNS = ("issued", "valid", "f107")
_INDICES = ("kp", "ap")
_LEAST_FLUX, _MOST_FLUX = 40.0, 1000.0
_MOST: Mapping[str, float] = {"kp": 9.0, "ap": 400.0}


class ArchiveSettings(ForecastSettings):
    files: Annotated[list[Text], MinLen(1)]


class _Issue(NamedTuple):
    """A forecast of the archive; times are modified Julian days."""

    issued: float
    valid: np.ndarray  # (n,) beginnings of the rows
    flux: np.ndarray  # (n,) F10.7 [sfu]
    kp: np.ndarray  # (n,)


def fit(_history: Weather, days: int, settings: ArchiveSettings) -> Forecast:
    """Return the newest forecast of the setting `files`, which learns nothing from the history.

    Raises InputError for an unreadable file.
    """
    issues = sorted(
        (issue for path in archive_files(settings) for issue in read(path)), key=attrgetter("issued")
    )
    times = np.array([issue.issued for issue in issues])

    def forecast(past: Weather, day: float) -> Future:
        newest = int(np.searchsorted(times, day + ROUNDING, side="right")) - 1
        if newest < 0:
            wanted, first = epochs.calendar(day), epochs.calendar(times[0])
            raise InputError(f"forecast: expected one issued by {wanted}, got the first on {first}")
        issue = issues[newest]
        fluxes = past.first + len(past.flux) + np.arange(days) + MEASURED
        intervals = past.first + (len(past.kp) + np.arange(INTERVALS * days)) / INTERVALS
        return Future(issue.flux[_rows_at(issue, fluxes)], issue.kp[_rows_at(issue, intervals)])

    return forecast


def archive_files(settings: ArchiveSettings) -> list[str]:
    """Return the files of the paths and patterns in the setting `files`; a path without a file stays."""
    return [path for pattern in settings.files for path in sorted(glob(pattern)) or [pattern]]


def read(path: str) -> list[_Issue]:
    """Read the forecasts of a file, by their issue. Raises InputError naming the file and row."""
    text = solar_activity.read_text(path)
    if space_weather.is_space_weather(text):
        return [_cssi_issue(path, text)]
    rows = list(_rows(path, text))
    if not rows:
        raise InputError(f"{path}: expected forecasts, got none")
    return [_issue(list(group)) for _, group in groupby(sorted(rows), key=lambda row: row[0])]


def _rows_at(issue: _Issue, times: np.ndarray) -> np.ndarray:
    """Return the rows (n,) that hold at times (n,) [MJD]; the first row holds before its beginning, too."""
    return np.maximum(np.searchsorted(issue.valid, times + ROUNDING, side="right") - 1, 0)


def _issue(rows: list[tuple[float, ...]]) -> _Issue:
    issued, valid, flux, kp = np.array(rows).T
    return _Issue(float(issued[0]), valid, flux, kp)


def _cssi_issue(path: str, text: str) -> _Issue:
    weather = space_weather.read(path, text)
    days = weather.iloc[space_weather.observed_days(path, text) :]
    if days.empty:
        raise InputError(f"{path}: expected predicted days after those measured, got none")
    valid = (days.index.to_numpy()[:, None] + np.arange(INTERVALS) / INTERVALS).ravel()
    flux = np.repeat(days["F10.7_OBS"].to_numpy(), INTERVALS)
    return _Issue(float(days.index[0]), valid, flux, days[space_weather.KP].to_numpy().ravel())


def _rows(path: str, text: str) -> Iterator[tuple[float, ...]]:
    """Yield (issued, valid [MJD], F10.7 [sfu], Kp) of each row. Raises InputError for a malformed row."""
    lines = [(number, line) for number, line in enumerate(text.splitlines(), start=1) if line.strip()]
    lines = [(number, line) for number, line in lines if not line.startswith("#")]
    names = lines[0][1].split("\t") if lines else []
    index = next((name for name in _INDICES if name in names), "kp")
    if missing := [name for name in (*_COLUMNS, index) if name not in names]:
        expected = "the columns issued, valid, f107 and kp or ap"
        raise InputError(f"{path}: expected {expected}, got no {missing[0]}")
    for number, line in lines[1:]:
        cells = dict(zip(names, line.split("\t"), strict=False))
        yield _row(f"{path}: line {number}", cells, index)


def _row(where: str, cells: Mapping[str, str], index: str) -> tuple[float, ...]:
    issued, valid = (_time(where, name, cells.get(name, "")) for name in ("issued", "valid"))
    if valid < math.floor(issued):
        raise InputError(f"{where}: valid: expected no day before that of the issue, got {cells['valid']}")
    flux = _figure(where, "f107", cells.get("f107", ""), _LEAST_FLUX, _MOST_FLUX)
    figure = _figure(where, index, cells.get(index, ""), 0.0, _MOST[index])
    return issued, valid, flux, float(solar_activity.kp_from_ap(figure)) if index == "ap" else figure


def _time(where: str, name: str, text: str) -> float:
    try:
        day, fraction = epochs.utc(text, 0.0)
    except InputError:
        expected = "UTC text like 2016-09-28T00:00:00"
        raise InputError(f"{where}: {name}: expected {expected}, got {text!r}") from None
    return float((day - epochs.MJD_ZERO) + fraction)


def _figure(where: str, name: str, text: str, least: float, most: float) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not least <= value <= most:
        raise InputError(f"{where}: {name}: expected a number from {least:g} to {most:g}, got {text!r}")
    return value


METHOD = ForecastMethod(
    "archive",
    ArchiveSettings,
    fit,
    files=archive_files,
    repeatable=False,
)
