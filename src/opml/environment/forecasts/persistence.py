"""Persistence: the last F10.7, and the mean Kp of the last 24 hours."""

import numpy as np

from opml.environment.forecasts.method import Forecast, ForecastMethod, ForecastSettings, Future
from opml.environment.space_weather import INTERVALS
from opml.environment.weather import Weather


def fit(_history: Weather, days: int, _settings: ForecastSettings) -> Forecast:
    """Return the forecast, which learns nothing from the history."""

    def forecast(past: Weather, _day: float) -> Future:
        kp = past.kp[-INTERVALS:].mean()
        return Future(np.full(days, past.flux[-1]), np.full(INTERVALS * days, kp))

    return forecast


METHOD = ForecastMethod("persistence", ForecastSettings, fit)

SETTINGS = ForecastSettings(kind=METHOD.kind)
