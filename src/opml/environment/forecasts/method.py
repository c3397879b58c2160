"""What a method of forecasting declares and what its forecasts promise."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol

import numpy as np

from opml.environment.weather import Weather

Settings = Mapping[str, Any]


class Future(NamedTuple):
    """What is said to follow the last measurements."""

    flux: np.ndarray  # (days,) F10.7 [sfu], one a day
    kp: np.ndarray  # (intervals,) Kp, one every three hours


class Forecast(Protocol):
    """What comes after the weather that is known at a time."""

    def __call__(self, past: Weather, day: float) -> Future:
        """The future at `day`, a modified Julian day; `past` is what is known then.

        Raises InputError where it cannot tell.
        """


Tell = Callable[[Weather, float], list[Future]]
"""Several futures at a time, as `Forecast` tells one."""


class Fit(Protocol):
    """Make a forecast for so many days ahead, from the weather before the run."""

    def __call__(self, history: Weather, *, days: int, settings: Settings) -> Forecast:
        """The forecast; the history has at least the method's `least_days` and those ahead."""


@dataclass(frozen=True)
class Method:
    """A kind of forecast, declared by its module and named once, in `methods.METHODS`.

    kind : its name in the settings.
    description : what it is, in words, for the table of skill.
    settings : type of each of its own keys (`opml.base.setting_types`); an `Absent` one may be left out.
    fit : makes a forecast of the history.
    least_days : of history that its settings ask for.
    past_days : of weather up to the issue that a forecast starts from.
    files : the user's own files that its settings name.
    repeatable : whether it can be made again on the days of the history, to see how it errs.
    """

    kind: str
    description: str
    settings: Mapping[str, Any]
    fit: Fit
    least_days: Callable[[Settings], int] = lambda settings: 0
    past_days: Callable[[Settings], int] = lambda settings: 1
    files: Callable[[Settings], list[str]] = lambda settings: []
    repeatable: bool = True
