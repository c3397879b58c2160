"""What followed the days of the past that were most like today.

Days are alike where F10.7 and Kp have had the same course: of the last days, and of a turn of the Sun before
the days to come. F10.7 then changes by the factor that it changed by then, Kp is what it was.
"""

import numpy as np

from opml.base.setting_types import Count
from opml.environment.forecasts.bursts import without_bursts
from opml.environment.forecasts.method import Forecast, Future, Method, Settings, Tell
from opml.environment.space_weather import INTERVALS
from opml.environment.weather import Weather, trailing_mean

FLUX_LAGS = (0, 1, 2, 4, 7, 13, 19, 21, 23, 25)
KP_LAGS = (0, 1, 2, 3, 19, 20, 21, 22, 23, 24, 25, 26)
"""Days before at which F10.7, and the mean Kp of 24 hours, are compared."""

APART = 3
"""Least number of days between two analogues, so that one event is not taken twice."""

PAST = 60
"""Days up to the issue that are looked at: for the lags, and for what a burst is judged by."""

_LEVEL = 2.0
"""Weight of how high F10.7 stands against that of each of its changes."""


def members_of(history: Weather, *, days: int, members: int) -> Tell:
    """The futures of the nearest days, nearest first."""
    like = Likeness(history, days)

    def find(past: Weather, day: float) -> list[Future]:
        return [like.future(past, k) for k in like.nearest(past, members)]

    return find


def fit(history: Weather, *, days: int, settings: Settings) -> Forecast:
    """The forecast, the median of the futures; `settings` holds how many `members`."""
    find = members_of(history, days=days, members=settings["members"])

    def forecast(past: Weather, day: float) -> Future:
        found = find(past, day)
        return Future(
            np.median([one.flux for one in found], axis=0), np.median([one.kp for one in found], axis=0)
        )

    return forecast


class Likeness:
    """The days of a history that have a past to compare and a future to take."""

    def __init__(self, history: Weather, days: int, past_days: int = 0) -> None:
        """days: of the future; past_days: that each has to have before, beside those that are compared."""
        self._ahead = days
        self._flux, self._kp = without_bursts(history.flux), history.kp
        before = max(*FLUX_LAGS, *KP_LAGS, past_days) + 1
        last = min(len(self._flux), len(self._kp) // INTERVALS) - days - 1
        self.days = np.arange(before, max(before, last))
        self._scale = np.ones(1)
        courses = self._courses(self.days)
        self._scale = courses.std(axis=0) + 1e-12
        self._scale[0] /= _LEVEL
        self._known = courses / self._scale

    def nearest(self, past: Weather, count: int) -> list[int]:
        """The `count` days that are most like the end of `past`, nearest first."""
        flux, kp = without_bursts(past.flux[-PAST:]), past.kp[-INTERVALS * PAST :]
        means = trailing_mean(kp, INTERVALS)
        now = _course(np.log(flux), means, np.array(len(flux) - 1), np.array(len(means) - 1))
        distance = np.sum((self._known - now / self._scale) ** 2, axis=1)
        chosen: list[int] = []
        for k in np.argsort(distance, kind="stable"):
            if all(abs(self.days[k] - day) >= APART for day in chosen):
                chosen.append(int(self.days[k]))
            if len(chosen) == count:
                break
        return chosen

    def future(self, past: Weather, day: int) -> Future:
        """What followed a day of the history, as it would follow `past`."""
        now = without_bursts(past.flux[-PAST:])[-1]
        after = self.after(day)
        return Future(now * after.flux / self._flux[day], after.kp)

    def after(self, day: int) -> Future:
        """What followed a day of the history, without the bursts of flares."""
        begin = INTERVALS * (day + 1)
        flux = self._flux[day + 1 : day + 1 + self._ahead]
        return Future(flux, self._kp[begin : begin + INTERVALS * self._ahead])

    def _courses(self, days: np.ndarray) -> np.ndarray:
        """The courses that are compared, (days, n); Kp counts up to the end of each day."""
        means = trailing_mean(self._kp, INTERVALS)
        return _course(np.log(self._flux), means, days, INTERVALS * days)


def _course(log_flux: np.ndarray, kp_means: np.ndarray, day: np.ndarray, interval: np.ndarray) -> np.ndarray:
    """Height of F10.7, its changes since, and mean Kp, at days of the one and intervals of the other."""
    flux = [log_flux[day - lag] for lag in FLUX_LAGS]
    changes = [flux[0] - before for before in flux[1:]]
    return np.stack([flux[0], *changes, *(kp_means[interval - INTERVALS * lag] for lag in KP_LAGS)], axis=-1)


METHOD = Method(
    "analogues",
    "the median of the futures of the days most like today",
    {"members": Count},
    fit,
    least_days=lambda settings: PAST + 4 * APART * int(settings["members"]),
    past_days=lambda settings: PAST,
    repeatable=False,
)
