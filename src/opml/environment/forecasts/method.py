"""The interface of forecasts of the space weather, and the declaration of a method."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol

import numpy as np

from opml.environment.weather import Weather

ForecastSettings = Mapping[str, Any]
"""Settings of a forecast: its kind, and the keys of the method."""


class Future(NamedTuple):
    """A course of the space weather after the last measurements."""

    flux: np.ndarray  # (days,) F10.7 [sfu], one a day
    kp: np.ndarray  # (intervals,) Kp, one every three hours


class Forecast(Protocol):
    """A function that forecasts the weather from the weather known at a time."""

    def __call__(self, past: Weather, day: float, /) -> Future:
        """Return the forecast at a time.

        past: weather known then
        day: the time, a modified Julian day

        Raises InputError where no forecast can be made.
        """


FutureForecast = Callable[[Weather, float], list[Future]]
"""A function that forecasts several futures; its parameters are those of `Forecast`."""


class MakeForecast(Protocol):
    """A function that makes a forecast from the weather before the run."""

    def __call__(self, history: Weather, days: int, settings: ForecastSettings, /) -> Forecast:
        """Return a forecast.

        history: weather before the run, at least the method's `least_days` and `days`
        days: of each future
        settings: of the forecast
        """


@dataclass(frozen=True)
class ForecastMethod:
    """A kind of forecast, declared by its module and listed in `methods.METHODS`.

    kind: name in the settings
    settings: type of each of its own keys (`opml.base.setting_types`); an `Absent` one may be left out
    fit: makes a forecast from the history
    least_days: days of history that the settings require
    past_days: days of weather before the issue that a forecast starts from
    files: the user's own files in the settings
    repeatable: whether forecasts can be repeated on days of the history, to learn their errors
    """

    kind: str
    settings: Mapping[str, Any]
    fit: MakeForecast
    least_days: Callable[[ForecastSettings], int] = lambda _: 0
    past_days: Callable[[ForecastSettings], int] = lambda _: 1
    files: Callable[[ForecastSettings], list[str]] = lambda _: []
    repeatable: bool = True
