"""Days of the past that were most like today.

Days are similar where F10.7 and Kp had the same course, over the last days and over those of the last turn of
the Sun.
"""

import numpy as np

from opml.environment.space_weather import INTERVALS
from opml.environment.weather import Future, Weather, trailing_mean

FLUX_LAGS = (0, 1, 2, 4, 7, 13, 19, 21, 23, 25)
KP_LAGS = (0, 1, 2, 3, 19, 20, 21, 22, 23, 24, 25, 26)
"""Days back at which F10.7, and the mean Kp of 24 hours, are compared."""

APART = 3  # least number of days between two similar ones, so that no event counts twice
PAST = 60  # days of weather before the issue: for the lags, and for the removal of bursts
_LEVEL = 2.0  # weight of the height of F10.7 relative to the weight of each of its changes

_MEDIAN_DAYS = 5  # days up to a reading whose median it is compared with
_HIGHEST = 60.0  # highest reading above the median that is no burst [sfu]


def remove_bursts(flux: np.ndarray) -> np.ndarray:
    """Return daily F10.7 (n,) [sfu] without flares' radio bursts, which the median of five days replaces.

    Bursts are readings of minutes, which do not last into the next day.
    """
    before = np.concatenate([np.repeat(flux[:1], _MEDIAN_DAYS - 1), flux])
    median = np.median(np.lib.stride_tricks.sliding_window_view(before, _MEDIAN_DAYS), axis=1)
    return np.where(flux > median + _HIGHEST, median, flux)


class SimilarDays:
    """Comparison of a day with the days of a history that have enough past and enough future."""

    def __init__(self, history: Weather, days: int, past_days: int) -> None:
        """Prepare the courses of the history.

        days: of each future
        past_days: that each day of the history must have before it
        """
        self._ahead = days
        self._flux, self._kp = remove_bursts(history.flux), history.kp
        before = max(*FLUX_LAGS, *KP_LAGS, past_days) + 1
        last = min(len(self._flux), len(self._kp) // INTERVALS) - days - 1
        self.days = np.arange(before, max(before, last))
        means = trailing_mean(self._kp, INTERVALS)
        courses = _course(np.log(self._flux), means, self.days, INTERVALS * self.days)  # Kp of whole days
        self._scale = courses.std(axis=0) + 1e-12
        self._scale[0] /= _LEVEL
        self._known = courses / self._scale

    def nearest(self, past: Weather, count: int) -> list[int]:
        """Return the indices of the `count` days most like the end of `past`, nearest first."""
        flux, kp = remove_bursts(past.flux[-PAST:]), past.kp[-INTERVALS * PAST :]
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

    def sequel(self, day: int) -> Future:
        """Return the weather after a day of the history, without bursts."""
        begin = INTERVALS * (day + 1)
        flux = self._flux[day + 1 : day + 1 + self._ahead]
        return Future(flux, self._kp[begin : begin + INTERVALS * self._ahead])


def _course(log_flux: np.ndarray, kp_means: np.ndarray, day: np.ndarray, interval: np.ndarray) -> np.ndarray:
    """Return the height of F10.7, its changes and the mean Kp at the lags: (..., n).

    log_flux: logarithms of F10.7, one a day
    kp_means: means of Kp over 24 hours, one every interval
    day, interval: places in these two series
    """
    flux = [log_flux[day - lag] for lag in FLUX_LAGS]
    changes = [flux[0] - before for before in flux[1:]]
    return np.stack([flux[0], *changes, *(kp_means[interval - INTERVALS * lag] for lag in KP_LAGS)], axis=-1)
