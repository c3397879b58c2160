"""The space weather that an assumed model flies under, by what is known when.

hindcast: t_j is today. The weather up to then was measured; only what looks ahead of its time is replaced.
forecast: t_i is today. An outlook has what was known when it was issued, and the forecast made then.
"""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from opml.base import epochs
from opml.base.constants import DAY, HOUR
from opml.base.errors import InputError
from opml.environment import solar_activity, space_weather
from opml.environment.forecasts import methods
from opml.environment.forecasts.method import Forecast, Future, Tell
from opml.environment.weather import ACTIVITY, RUN_UP, Weather

MONTHLY, HINDCAST, FORECAST = "monthly", "hindcast", "forecast"
KNOWN = (HINDCAST, FORECAST)
"""Kinds of knowledge that ask for weather that was measured."""

FIT_HOURS = 3
"""Hours between the outlooks that fits fly under: they know Kp up to the last interval that is over."""

_AHEAD = 2.0 * HOUR
"""How far beyond the last time of an arc its figures are looked up, a node of the grid [s]."""


def read(source: str | Path) -> Weather:
    """The measured weather of a source, OBSERVED or a file of CSSI's; its predicted days are left out.

    Raises InputError where it cannot be read or holds monthly figures.
    """
    path = solar_activity.resolve(source)
    text = solar_activity.text_of(path)
    if not space_weather.is_space_weather(text):
        raise InputError(f"{source}: expected weather that was measured day by day, OBSERVED or a CSSI file")
    days = space_weather.read(path, text).iloc[: space_weather.observed_days(text)]
    if days.empty:
        raise InputError(f"{path}: expected measured days, got predicted ones only")
    return Weather(
        int(days.index[0]), days["F10.7_OBS"].to_numpy(), days[space_weather.KP].to_numpy().ravel()
    )


def check_monthly(source: str | Path) -> None:
    """Raise InputError where a source holds no monthly figures."""
    if space_weather.is_space_weather(solar_activity.text_of(solar_activity.resolve(source))):
        raise InputError(f"{source}: expected monthly figures, MSAFE or a bulletin")


def hindcast(source: str | Path, epoch: str, t: np.ndarray) -> pd.DataFrame:
    """Table `solar_activity` at times `t` [s since `epoch`] of what was known at each of them.

    Raises InputError where the source cannot be read or does not reach.
    """
    weather, day = read(source), space_weather.days(epoch, t)
    _check_begin(weather, day, source)
    _check_end(weather, day, source)
    return pd.DataFrame({"t": t, **weather.activity(day)})


def measured(source: str | Path, epoch: str, t: np.ndarray) -> pd.DataFrame:
    """The same up to the last measurement, not finite after it: what a forecast starts from.

    So a run may reach into days that nobody has measured yet. Raises InputError where the source cannot be
    read or begins too late.
    """
    weather, day = read(source), space_weather.days(epoch, t)
    _check_begin(weather, day, source)
    known = day <= _last(weather)
    table = pd.DataFrame({"t": t, **dict.fromkeys(ACTIVITY, np.nan)})
    table.loc[known, ACTIVITY] = pd.DataFrame(weather.activity(day[known])).to_numpy()
    return table


TABLES = {HINDCAST: hindcast, FORECAST: measured}
"""What stands in for the weather of the run, by the kind of knowledge."""


def outlooks(
    source: str | Path,
    epoch: str,
    t: np.ndarray,
    *,
    forecast: Mapping[str, Any],
    issue_hours: int,
    max_days: float,
) -> pd.DataFrame:
    """Table `outlooks`: the activity at times `t` [s since `epoch`] after each issue, as forecast then.

    forecast: settings of the method, which learns from the packaged weather before the epoch; issue_hours:
    between issues, the first at or before the epoch; max_days: how long arcs fly. Raises InputError where a
    source cannot be read or does not reach.
    """
    horizon = max_days * DAY + issue_hours * HOUR + _AHEAD
    method = fitted(epoch, days=math.ceil(horizon / DAY) + 1, forecast=forecast)

    def only(past: Weather, day: float) -> list[Future]:
        return [method(past, day)]

    table = _issued(source, epoch, t, only, hours=issue_hours, horizon=horizon)
    return table.drop(columns="member")


def futures(
    source: str | Path,
    epoch: str,
    t: np.ndarray,
    *,
    forecast: Mapping[str, Any],
    members: int,
    issue_hours: int,
    max_days: float,
) -> pd.DataFrame:
    """Table `futures`: as `outlooks`, of so many members about the forecast (`methods.futures`)."""
    horizon = max_days * DAY + issue_hours * HOUR + _AHEAD
    days = math.ceil(horizon / DAY) + 1
    find = methods.futures(_history(epoch), days=days, settings=forecast, members=members)
    return _issued(source, epoch, t, find, hours=issue_hours, horizon=horizon)


def _issued(
    source: str | Path,
    epoch: str,
    t: np.ndarray,
    tell: Tell,
    *,
    hours: int,
    horizon: float,
) -> pd.DataFrame:
    """The activity at times `t` [s] up to `horizon` [s] after each issue, by each future told then."""
    weather, day = read(source), space_weather.days(epoch, t)
    _check_begin(weather, day, source)
    parts = []
    for issued, today in zip(*issues(epoch, t, hours), strict=True):
        if today > _last(weather):
            break
        known = weather.known_at(today)
        recent = known.since(math.floor(today) - RUN_UP - 1)
        ahead = (t > issued) & (t <= issued + horizon)
        for member, future in enumerate(tell(known, today)):
            activity = recent.followed_by(*future).activity(day[ahead])
            parts.append(pd.DataFrame({"member": member, "issued": issued, "t": t[ahead], **activity}))
    return pd.concat(parts, ignore_index=True)


def fitted(epoch: str, *, days: int, forecast: Mapping[str, Any]) -> Forecast:
    """The forecast of so many `days` that learned from the packaged weather before `epoch` (UTC text).

    Raises InputError where there is too little of it.
    """
    return methods.fit(_history(epoch), days=days, settings=forecast)


def check(
    source: str | Path, epoch: str, ends: np.ndarray, *, forecast: Mapping[str, Any], issue_hours: int
) -> None:
    """Raise InputError where the weather, the history or the user's own forecasts do not reach.

    ends: first and last time of the run's tables [s since `epoch`]; the rest is as in `outlooks`.
    """
    _check_begin(read(source), space_weather.days(epoch, ends), source)
    today = float(issues(epoch, ends, max(issue_hours, FIT_HOURS))[1][0])
    methods.check(_history(epoch), read(source).known_at(today), today, settings=forecast)


def _history(epoch: str) -> Weather:
    """The packaged weather before the epoch."""
    begin = float(space_weather.days(epoch, np.zeros(1))[0])
    return read(solar_activity.OBSERVED).known_at(begin)


def issues(epoch: str, t: np.ndarray, hours: int) -> tuple[np.ndarray, np.ndarray]:
    """When outlooks are issued up to the last of `t`: (times [s since `epoch`], modified Julian days).

    At whole multiples of `hours` of the day (UTC), the first at or before the epoch.
    """
    midnight, _ = epochs.days_of_year(epoch, 0.0)
    first = midnight + hours * HOUR * math.floor(-midnight / (hours * HOUR))
    times = np.arange(first, t[-1], hours * HOUR)
    return times, space_weather.days(epoch, times)


def _last(weather: Weather) -> float:
    """Modified Julian day up to which the weather was measured."""
    return weather.first + min(len(weather.flux) - 1 + space_weather.MEASURED, len(weather.kp) / 8)


def _check_begin(weather: Weather, day: np.ndarray, source: str | Path) -> None:
    """Raise InputError where the mean of the 81 days before does not reach, or nothing is measured yet."""
    if day.min() < weather.first + RUN_UP or day.min() > _last(weather):
        raise _out_of_reach(weather, day, source)


def _check_end(weather: Weather, day: np.ndarray, source: str | Path) -> None:
    """Raise InputError where the weather ends before."""
    if day.max() > _last(weather):
        raise _out_of_reach(weather, day, source)


def _out_of_reach(weather: Weather, day: np.ndarray, source: str | Path) -> InputError:
    wanted = f"{epochs.calendar(day.min())} to {epochs.calendar(day.max())}"
    reach = f"{epochs.calendar(weather.first + RUN_UP)} to {epochs.calendar(_last(weather))}"
    return InputError(f"{source}: epoch: expected dates from {reach}, got {wanted}")
