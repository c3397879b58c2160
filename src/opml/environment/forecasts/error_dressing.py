"""A forecast, and how it erred on the days of the past that were most like today.

Each future is the forecast moved by one of these errors: F10.7 by the factor between what was forecast on
that day and what came, Kp by the difference. So the futures lie about the forecast, and spread as it errs on
such days (error dressing: Roulston & Smith 2003, Tellus A 55; days as in `analogues`).
"""

import numpy as np

from opml.environment.forecasts import analogues
from opml.environment.forecasts.method import Forecast, Future, Tell
from opml.environment.weather import HIGHEST_KP, Weather


def members_of(history: Weather, forecast: Forecast, *, days: int, past_days: int, members: int) -> Tell:
    """The forecast moved by its errors of so many nearest days, nearest first.

    past_days: of weather that the forecast starts from.
    """
    like = analogues.Likeness(history, days, past_days)

    def said_after(day: int) -> Future:
        today = history.first + day + 1.0
        return forecast(history.known_at(today), today)

    def find(past: Weather, day: float) -> list[Future]:
        said = forecast(past, day)
        return [_moved(said, like.after(k), said_after(k)) for k in like.nearest(past, members)]

    return find


def _moved(said: Future, true: Future, forecast: Future) -> Future:
    """What is said, moved by the difference between what was true and what was forecast then."""
    kp = np.clip(said.kp + true.kp - forecast.kp, 0.0, HIGHEST_KP)
    return Future(said.flux * true.flux / forecast.flux, kp)
