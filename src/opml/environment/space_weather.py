"""Observed space weather of each day, from CSSI's files, which CelesTrak keeps, as inputs of DTM2000.

Both forms are read: comma-separated (SW-All.csv) and fixed columns (SpaceWeather-All-v1.2.txt).
Format: CelesTrak, Space Weather Data Documentation; inputs of DTM2000: Bruinsma, Thuillier & Barlier 2003.
Nodes are hourly and interpolated linearly, so that a step of Kp becomes a ramp over the hour before it.
The 81-day mean is centred: it looks 40 days ahead. The weather as known on a day is in `knowledge`.
"""

import logging
import math
import re
from collections.abc import Iterable, Iterator
from datetime import date
from operator import itemgetter
from pathlib import Path

import erfa
import numpy as np
import pandas as pd

from opml.base import epochs
from opml.base.constants import DAY
from opml.base.errors import InputError

KP = [f"KP{k}" for k in range(1, 9)]
_FLUX = ["F10.7_OBS", "F10.7_OBS_CENTER81"]
_FIGURES = [*KP, *_FLUX]
_KIND = "F10.7_DATA_TYPE"
PREDICTED = ("PRD", "PRM")
_TEXT_TITLE = "DATATYPE CssiSpaceWeather"
_TEXT_SECTION = re.compile(r"(BEGIN|END) (\w+)")
_TEXT_DAILY = ("OBSERVED", "DAILY_PREDICTED")
# FORMAT(I4,I3,I3,I5,I3,8I3,I4,8I4,I4,F4.1,I2,I4,F6.1,I2,5F6.1): the flux as observed is the fourth of six.
_TEXT_COLUMNS = [slice(18 + 3 * k, 21 + 3 * k) for k in range(8)] + [slice(112, 118), slice(118, 124)]

_KP_AS_PRINTED = frozenset(round(10.0 * third / 3.0) for third in range(28))
_ZERO = date(1858, 11, 17).toordinal()  # of the modified Julian days
_LEAST_FLUX, _MOST_FLUX = 40.0, 1000.0  # what the Sun can do [sfu]; 53.5 and 938.6 were printed since 1957
_BEFORE, _BURST = 5, 1.7  # days before a flux, and the multiple of their median from which it is a burst
_CENTRED = 81  # days of the centred mean
_MOST_TOLD = 5

INTERVALS = 8  # intervals of Kp in a day
DELAY = 1  # intervals by which DTM2000's Kp lags: 3 hours

MEASURED = 20.0 / 24.0
"""Time of day [d] at which the flux of a date is measured: local noon at Penticton, 20:00 UTC."""

_RUN_UP = 89
"""Days before the first time at which the running sum of Kp starts, if the file reaches so far back.

A few would do. A fixed number gives the same bits for all files with the same days; this number gives those
of a file from 2016-07-01 on, of the first runs of the paper's case.
"""

ROUNDING = 1e-8  # part of a day [d] by which rounding may move an epoch from a whole hour


_log = logging.getLogger(__name__)

_Row = tuple[int, str, list[str], bool]  # line, date and figures of a day, and whether the day was measured


def is_space_weather(text: str) -> bool:
    """Return whether a file's text is space weather in either form."""
    return _TEXT_TITLE in text or _heading(text.splitlines()) is not None


def read(path: str | Path, text: str) -> pd.DataFrame:
    """Read the daily space weather from a file's text.

    Index: consecutive modified Julian days (UTC). Columns: KP1 to KP8 (thirds), F10.7_OBS and
    F10.7_OBS_CENTER81 [sfu], as observed: not reduced to 1 au, since the atmosphere absorbs what arrives;
    is_measured, False of the predicted days at the end. The table ends before the first day without Kp, where
    the monthly predictions begin. Raises InputError for a malformed line and a day that is missing or out of
    order.
    """
    rows = _text_rows if _TEXT_TITLE in text else _csv_rows
    days: list[list[float]] = []
    listed = rows(text.splitlines())
    for line, date_text, figures, is_measured in listed:
        if not _has_kp(figures):
            _check_ends(path, line, listed)
            if is_measured:
                _log.warning("%s: line %d: day left out, without eight Kp: is the file cut?", path, line)
            break
        days.append([*_day(path, line, date_text, figures, is_measured), is_measured])
        if len(days) > 1 and days[-1][0] != days[-2][0] + 1:
            expected, got = (epochs.calendar(mjd) for mjd in (days[-2][0] + 1, days[-1][0]))
            raise InputError(f"{path}: line {line}: expected the day {expected}, got {got}")
        if len(days) > 1 and is_measured > days[-2][-1]:
            raise InputError(
                f"{path}: line {line}: expected a predicted day after another, got a measured one"
            )
    if len(days) < 2:
        raise InputError(f"{path}: expected at least two days with Kp, got {len(days)}")
    weather = pd.DataFrame(days, columns=["mjd", *_FIGURES, "is_measured"]).set_index("mjd")
    # Files print a third of Kp as ten times its value, rounded: 3, 7, 10.
    weather[KP] = np.round(0.3 * weather[KP]) / 3.0
    return _without_bursts(path, weather)


def _without_bursts(path: str | Path, weather: pd.DataFrame) -> pd.DataFrame:
    """Return the weather without bursts of the Sun in the hour of a measurement, which no atmosphere follows.

    A flux far above the median of the days before it is replaced by that median, in the centred mean as well.
    No flux after it matters, as none was known then.
    """
    flux = weather["F10.7_OBS"]
    usual = flux.rolling(_BEFORE).median().shift()
    bursts = flux > _BURST * usual
    if bursts.any():
        days = ", ".join(epochs.calendar(mjd) for mjd in weather.index[bursts][-_MOST_TOLD:])
        _log.info("%s: fluxes replaced that are bursts: %d, the last on %s", path, bursts.sum(), days)
    excess = (flux - usual).where(bursts, 0.0)
    mean = excess.rolling(_CENTRED, center=True, min_periods=1).sum() / _CENTRED
    cleaned = {"F10.7_OBS": flux - excess, "F10.7_OBS_CENTER81": weather["F10.7_OBS_CENTER81"] - mean}
    return weather.assign(**cleaned)


def _has_kp(figures: list[str]) -> bool:
    return all(map(str.strip, figures[: len(KP)]))


def _check_ends(path: str | Path, line: int, later: Iterable[_Row]) -> None:
    """Raise InputError for a line without Kp where later days were measured."""
    after = next((n for n, _, figures, is_measured in later if is_measured and _has_kp(figures)), None)
    if after is not None:
        raise InputError(f"{path}: line {line}: expected eight Kp, as line {after} has, got none")


def reach(weather: pd.DataFrame) -> tuple[str, str]:
    """Return the first and last calendar day that the measurements of `read` cover as a whole."""
    return epochs.calendar(weather.index[0] + 2), epochs.calendar(weather.index[-1] - 1)


def tabulate(path: str | Path, text: str, epoch: str, t: np.ndarray) -> pd.DataFrame:
    """Return the table `solar_activity`.

    Columns: t [s]; f107: flux of 24 hours before, f107_mean: its centred 81-day mean [sfu], both linear
    between the daily measurements; kp_3h: Kp of the three-hour interval before the one at t; kp_24h: mean of
    kp_3h and the seven Kp before it. Raises InputError for dates outside the file's.
    """
    weather = read(path, text)
    t = np.asarray(t, dtype=float)
    day = days(epoch, t)
    first, last = weather.index[0], weather.index[-1]
    if day.min() < first + 1.0 + MEASURED or day.max() > last + MEASURED:
        begin, end = reach(weather)
        raise InputError(
            f"{Path(path).name}: epoch: expected dates from {begin} to {end}, "
            f"got {epochs.calendar_day(epoch, t.min())} to {epochs.calendar_day(epoch, t.max())}"
        )
    weather = weather.loc[math.floor(day.min()) - _RUN_UP :]
    measured = weather.index.to_numpy() + MEASURED
    kp = weather[KP].to_numpy().ravel()
    sums = np.concatenate([[0.0], np.cumsum(kp)])
    interval = np.floor(INTERVALS * (day - weather.index[0] + ROUNDING)).astype(int) - DELAY
    return pd.DataFrame(
        {
            "t": t,
            "f107": np.interp(day - 1.0, measured, weather["F10.7_OBS"]),
            "f107_mean": np.interp(day, measured, weather["F10.7_OBS_CENTER81"]),
            "kp_3h": kp[interval],
            "kp_24h": (sums[interval + 1] - sums[interval + 1 - INTERVALS]) / INTERVALS,
        }
    )


def days(epoch: str, t: np.ndarray) -> np.ndarray:
    """Return modified Julian days (UTC) at times `t` [s since `epoch`], every day of 86400 s.

    ERFA lengthens a day with a leap second, which would move the hours of Kp.
    """
    whole, part = epochs.utc(epoch, t)
    day: np.ndarray = (whole - epochs.MJD_ZERO) + part
    midnight = np.floor(day)
    leap = np.round(DAY * (_tai(midnight + 1.0) - _tai(midnight) - 1.0))
    return np.where(leap == 0.0, day, midnight + (day - midnight) * (DAY + leap) / DAY)


def _tai(midnight: np.ndarray) -> np.ndarray:
    with epochs.strict_erfa():
        whole, part = erfa.utctai(epochs.MJD_ZERO, midnight)
    return np.asarray((whole - epochs.MJD_ZERO) + part)


def _heading(lines: list[str]) -> int | None:
    """Return the index of the line that names the columns; None without such a line."""
    for number, line in enumerate(lines):
        if line and not line.startswith("#"):
            return number if {"DATE", *_FIGURES} <= set(line.split(",")) else None
    return None


def _csv_rows(lines: list[str]) -> Iterator[_Row]:
    """Yield the days of the comma-separated form; without a column of types all count as measured."""
    first = _heading(lines) or 0
    names = lines[first].split(",")
    kind = names.index(_KIND) if _KIND in names else len(names)
    columns = itemgetter(*(names.index(name) for name in ("DATE", *_FIGURES)))
    lacking = [""] * len(names)
    for number, line in enumerate(lines[first + 1 :], start=first + 2):
        if line:
            cells = line.split(",") + lacking
            day, *figures = columns(cells)
            yield number, day, figures, cells[kind] not in PREDICTED


def _text_rows(lines: list[str]) -> Iterator[_Row]:
    section = ""
    for number, line in enumerate(lines, start=1):
        if match := _TEXT_SECTION.match(line):
            section = match[2] if match[1] == "BEGIN" else ""
        elif section in _TEXT_DAILY and line.strip():
            figures = [line[columns] for columns in _TEXT_COLUMNS]
            yield number, "-".join(line[:10].split()), figures, section == _TEXT_DAILY[0]


def _day(path: str | Path, line: int, day: str, figures: list[str], is_measured: bool) -> list[float]:
    """Return the modified Julian day and the figures of a row.

    Raises InputError for a malformed one, and for figures that cannot be.
    """
    try:
        mjd = date.fromisoformat(day).toordinal() - _ZERO
        values = list(map(float, figures))
    except ValueError:
        values = [math.nan]
    kp, fluxes = values[: len(KP)], values[len(KP) :]
    is_kp = _KP_AS_PRINTED.issuperset(kp) or (not is_measured and all(0.0 <= value <= 90.0 for value in kp))
    if is_kp and all(_LEAST_FLUX <= value <= _MOST_FLUX for value in fluxes):
        return [mjd, *values]
    if not all(map(math.isfinite, values)):
        got = " ".join([day, *map(str.strip, figures)])
        raise InputError(f"{path}: line {line}: expected a date, eight Kp and two fluxes, got '{got}'")
    if not is_kp:
        got = " ".join(map(str.strip, figures[: len(KP)]))
        raise InputError(f"{path}: line {line}: expected ten times Kp in thirds from 0 to 90, got {got}")
    got = " and ".join(map(str.strip, figures[len(KP) :]))
    expected = f"two fluxes of {_LEAST_FLUX:g} to {_MOST_FLUX:g} sfu"
    raise InputError(f"{path}: line {line}: expected {expected}, got {got}")
