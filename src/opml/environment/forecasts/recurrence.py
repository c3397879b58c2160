"""The weather comes back when the Sun has turned once."""

import numpy as np

from opml.base.setting_types import Count
from opml.environment.forecasts.method import Forecast, Future, Method, Settings
from opml.environment.space_weather import INTERVALS
from opml.environment.weather import Weather


def fit(history: Weather, *, days: int, settings: Settings) -> Forecast:
    """The forecast; `settings` holds the days of a turn. It learns nothing from the history."""
    turn = settings["turn_days"]

    def forecast(past: Weather, day: float) -> Future:
        flux, kp = past.flux[-turn:], past.kp[-INTERVALS * turn :]
        return Future(np.resize(flux, days), np.resize(kp, INTERVALS * days))

    return forecast


METHOD = Method(
    "recurrence",
    "the weather of one turn of the Sun before",
    {"turn_days": Count},
    fit,
    past_days=lambda settings: int(settings["turn_days"]),
)
