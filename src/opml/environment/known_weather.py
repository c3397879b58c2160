"""The space weather that an assumed model has, by the time at which it is known.

hindcast: t_j is today. The weather up to t_j was measured; only figures that look ahead are replaced.
forecast: t_i is today. An outlook has the weather known at its issue, and the forecast made then.
"""

import math
from collections.abc import Callable, Sequence
from functools import lru_cache
from pathlib import Path

import numpy as np
import pandas as pd

from opml.base import epochs
from opml.base.constants import DAY, HOUR
from opml.base.errors import InputError
from opml.base.section import JobSettings
from opml.environment import solar_activity, space_weather
from opml.environment.forecasts import regression
from opml.environment.forecasts.regression import Forecast
from opml.environment.weather import ACTIVITY, RUN_UP, Future, Weather

MONTHLY, HINDCAST, FORECAST = "monthly", "hindcast", "forecast"
KNOWN = (HINDCAST, FORECAST)  # kinds of knowledge that need measured weather

OLDEST = 3.0  # days before a date that the weather may end: a forecast begins there

FIT_HOURS = 3
"""Hours between the outlooks of fits: they know Kp up to the last interval that is over."""

_AHEAD = 2.0 * HOUR
"""Time beyond the end of an arc up to which its figures are looked up, two nodes of the grid [s]."""


class Issues(JobSettings):
    """Forecasts of the space weather issued at regular times, learned from the weather before the epoch."""

    source: str | Path  # of the measured weather, OBSERVED or a CSSI file
    epoch: str  # UTC text
    issue_hours: int  # between issues, the first one at or before the epoch
    max_days: float  # longest arc after its epoch

    @property
    def horizon(self) -> float:
        """Time after an issue that its forecast has to cover [s]."""
        return self.max_days * DAY + self.issue_hours * HOUR + _AHEAD

    @property
    def days(self) -> int:
        """Whole days of each forecast."""
        return math.ceil(self.horizon / DAY) + 1


def read(source: str | Path) -> Weather:
    """Read the measured weather of a source, OBSERVED or a CSSI file, without its predicted days.

    Raises InputError where the source is unreadable or holds monthly figures.
    """
    path = solar_activity.resolve(source)
    text = solar_activity.read_text(path)
    if not space_weather.is_space_weather(text):
        raise InputError(f"{source}: expected weather that was measured day by day, OBSERVED or a CSSI file")
    return _measured(path, text)


@lru_cache(maxsize=2)
def _measured(path: str | Path, text: str) -> Weather:
    """Return the measured weather of a file's text: half a second a file of decades, needed many times."""
    days = space_weather.read(path, text).query("is_measured")
    if days.empty:
        raise InputError(f"{path}: expected measured days, got predicted ones only")
    return Weather(
        int(days.index[0]), days["F10.7_OBS"].to_numpy(), days[space_weather.KP].to_numpy().ravel()
    )


def known_on(date: str, measured: Weather, source: str | Path, *, oldest: float = OLDEST) -> Weather:
    """Return what was known of the measured weather of a source on a date (UTC text).

    oldest: days before the date that it may end

    Raises InputError, naming the source, where it ends before these, or begins on the date.
    """
    today = epochs.mjd(date)
    known = measured.keep_known(today)
    if today <= known.first + 1.0:
        expected = f"space weather measured before {date[:10]}, got it from {epochs.calendar(known.first)} on"
        raise InputError(f"{source}: expected {expected}")
    if today - known.end > oldest:
        expected = f"space weather measured up to {date[:10]}, got it up to {epochs.calendar(known.end)}"
        raise InputError(f"{source}: expected {expected}: `opml fetch` gets newer")
    return known


def measured_source(source: str | Path) -> str | Path:
    """Return a source, or OBSERVED in the place of monthly figures; raise InputError where unreadable."""
    text = solar_activity.read_text(solar_activity.resolve(source))
    return source if space_weather.is_space_weather(text) else solar_activity.OBSERVED


def check_monthly(source: str | Path) -> None:
    """Raise InputError where a source holds no monthly figures."""
    if space_weather.is_space_weather(solar_activity.read_text(solar_activity.resolve(source))):
        raise InputError(f"{source}: expected monthly figures, MSAFE or a bulletin")


def hindcast(source: str | Path, epoch: str, t: np.ndarray) -> pd.DataFrame:
    """Return the table `solar_activity` with the figures known at each time `t` (n,) [s since `epoch`].

    Raises InputError where the source is unreadable or does not cover the times.
    """
    table = measured_activity(source, epoch, t)
    if table.isna().any(axis=None):
        raise _reach_error(read(source), space_weather.days(epoch, t), source)
    return table


def measured_activity(source: str | Path, epoch: str, t: np.ndarray) -> pd.DataFrame:
    """Return the table of `hindcast` up to the last measurement, not finite after it.

    A forecast starts from it, so that a run may reach into days without measurements. Raises InputError where
    the source is unreadable or begins too late.
    """
    weather, day = read(source), space_weather.days(epoch, t)
    _check_begin(weather, day, source)
    known = day <= _last_day(weather)
    table = pd.DataFrame({"t": t, **dict.fromkeys(ACTIVITY, np.nan)})
    table.loc[known, ACTIVITY] = pd.DataFrame(weather.activity(day[known])).to_numpy()
    return table


TABLES = {HINDCAST: hindcast, FORECAST: measured_activity}
"""Makers of the run's table `solar_activity`, by the kind of knowledge."""


def outlooks(issues: Issues, t: np.ndarray) -> pd.DataFrame:
    """Return the table `outlooks`: the activity at times `t` (n,) [s] after each issue, as forecast then.

    Raises InputError where a source is unreadable or does not cover the times.
    """
    forecast = fit_forecast(issues.epoch, days=issues.days)
    return _tabulate(issues, t, lambda past: [forecast.future(past)]).drop(columns="member")


def tabulate_futures(issues: Issues, t: np.ndarray, *, members: int) -> pd.DataFrame:
    """Return the table `futures`: as `outlooks`, for each member of an ensemble about the forecast."""
    forecast = fit_forecast(issues.epoch, days=issues.days)
    return _tabulate(issues, t, lambda past: forecast.futures(past, members))


def _tabulate(issues: Issues, t: np.ndarray, ensemble: Callable[[Weather], Sequence[Future]]) -> pd.DataFrame:
    """Return the activity at times `t` [s] up to the horizon of each issue, by each of its futures."""
    weather, day = read(issues.source), space_weather.days(issues.epoch, t)
    _check_begin(weather, day, issues.source)
    parts = []
    for issued, today in zip(*issue_times(issues.epoch, t, issues.issue_hours), strict=True):
        if today > _last_day(weather):
            break
        known = weather.keep_known(today)
        recent = known.drop_before(math.floor(today) - RUN_UP - 1)
        ahead = (t > issued) & (t <= issued + issues.horizon)
        for member, future in enumerate(ensemble(known)):
            activity = recent.extend(future).activity(day[ahead])
            parts.append(pd.DataFrame({"member": member, "issued": issued, "t": t[ahead], **activity}))
    return pd.concat(parts, ignore_index=True)


@lru_cache(maxsize=1)
def fit_forecast(epoch: str, *, days: int) -> Forecast:
    """Return a forecast of `days` days that has learned from the packaged weather before `epoch` (UTC text).

    Outlooks and futures of one issue learn once.

    Raises InputError where there is too little weather before the epoch.
    """
    return Forecast.fit(_history(epoch), days=days)


def check(source: str | Path, epoch: str, ends: np.ndarray) -> None:
    """Raise InputError where the weather or the history before it do not cover a run.

    source: of the measured weather, OBSERVED or a CSSI file
    ends: (2,) first and last time of the run's tables [s since `epoch`]
    """
    _check_begin(read(source), space_weather.days(epoch, ends), source)
    regression.check_history(_history(epoch), days=1)


def _history(epoch: str) -> Weather:
    begin = float(space_weather.days(epoch, np.zeros(1))[0])
    return read(solar_activity.OBSERVED).keep_known(begin)


def issue_times(epoch: str, t: np.ndarray, hours: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the times of issue up to the last of `t`, in [s since `epoch`] and as modified Julian days.

    They are whole multiples of `hours` of the day (UTC), the first one at or before the epoch.
    """
    midnight, _ = epochs.days_of_year(epoch, 0.0)
    first = midnight + hours * HOUR * math.floor(-midnight / (hours * HOUR))
    times = np.arange(first, t[-1], hours * HOUR)
    return times, space_weather.days(epoch, times)


def _last_day(weather: Weather) -> float:
    """Return the modified Julian day of the last time with both F10.7 and Kp."""
    return weather.first + min(len(weather.flux) - 1 + space_weather.MEASURED, len(weather.kp) / 8)


def _check_begin(weather: Weather, day: np.ndarray, source: str | Path) -> None:
    """Raise InputError where the weather lacks the 81 days before the first day, or ends before it."""
    if day.min() < weather.first + RUN_UP or day.min() > _last_day(weather):
        raise _reach_error(weather, day, source)


def _reach_error(weather: Weather, day: np.ndarray, source: str | Path) -> InputError:
    wanted = f"{epochs.calendar(day.min())} to {epochs.calendar(day.max())}"
    reach = f"{epochs.calendar(weather.first + RUN_UP)} to {epochs.calendar(_last_day(weather))}"
    return InputError(f"{source}: epoch: expected dates from {reach}, got {wanted}")
