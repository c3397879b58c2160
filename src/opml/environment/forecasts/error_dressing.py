"""Futures of a forecast: the forecast shifted by its errors on those days of the past most like today.

F10.7 is multiplied by the ratio of the true to the forecast value of that day, Kp is shifted by the
difference. So the futures surround the forecast and spread as much as it errs on such days (error dressing:
Roulston & Smith 2003, Tellus A 55; similar days as in `analogues`).
"""

import numpy as np

from opml.environment.forecasts import analogues
from opml.environment.forecasts.method import Forecast, Future, FutureForecast
from opml.environment.weather import HIGHEST_KP, Weather


def dress_futures(
    history: Weather, forecast: Forecast, *, days: int, past_days: int, members: int
) -> FutureForecast:
    """Return the forecast's futures, one for each of the nearest days, nearest first.

    history: weather before the run
    days: of each future
    past_days: of weather that the forecast starts from
    members: number of futures
    """
    likeness = analogues.Likeness(history, days, past_days)

    def repeat_forecast(day: int) -> Future:
        """Return the forecast that was possible on a day of the history."""
        issue = history.first + day + 1.0
        return forecast(history.keep_known(issue), issue)

    def ensemble(past: Weather, day: float) -> list[Future]:
        today = forecast(past, day)
        nearest = likeness.nearest(past, members)
        return [_shift(today, likeness.sequel(k), repeat_forecast(k)) for k in nearest]

    return ensemble


def _shift(today: Future, true: Future, forecast: Future) -> Future:
    """Return today's forecast shifted by the error of an earlier forecast, whose truth is known."""
    kp = np.clip(today.kp + true.kp - forecast.kp, 0.0, HIGHEST_KP)
    return Future(today.flux * true.flux / forecast.flux, kp)
