"""The interface of forecasts of the space weather, and the declaration of a method."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, NamedTuple, Protocol, TypeVar

import numpy as np

from opml.base.kind_sections import KindSection
from opml.environment.weather import Weather


class ForecastSettings(KindSection):
    """Settings of a forecast; those of its method follow `kind`."""


S = TypeVar("S", bound=ForecastSettings)
S_in = TypeVar("S_in", bound=ForecastSettings, contravariant=True)


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


class MakeForecast(Protocol[S_in]):
    """A function that makes a forecast from the weather before the run."""

    def __call__(self, history: Weather, days: int, settings: S_in, /) -> Forecast:
        """Return a forecast.

        history: weather before the run, at least the method's `least_days` and `days`
        days: of each future
        """


@dataclass(frozen=True)
class ForecastMethod(Generic[S]):
    """A kind of forecast, declared by its module and listed in `methods.METHODS`.

    past_days: days of weather before the issue that a forecast starts from
    """

    kind: str  # name in the settings
    settings: type[S]  # section of its settings
    fit: MakeForecast[S]  # makes a forecast from the history
    least_days: Callable[[S], int] = lambda _: 0  # days of history that the settings require
    past_days: Callable[[S], int] = lambda _: 1
    files: Callable[[S], list[str]] = lambda _: []  # the user's own files in the settings
    repeatable: bool = True  # whether forecasts can be repeated on days of the history, to learn their errors
