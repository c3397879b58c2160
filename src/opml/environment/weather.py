"""Measured F10.7 and Kp as they are known at a time.

A flux is known from its measurement at 20:00 UTC on, a Kp from the end of its three hours on. The mean flux
is that of the last 81 days; the centred mean would look 40 days ahead.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from opml.environment.space_weather import DELAY, INTERVALS, MEASURED, ROUNDING

MEAN_DAYS = 81  # days of the mean flux
RUN_UP = MEAN_DAYS + 1  # days of measurements that `Weather.activity` needs before its first time
QUARTERS = 4  # densities a day
HIGHEST_KP = 9.0  # upper end of the scale of Kp

ACTIVITY = ["f107", "f107_mean", "kp_3h", "kp_24h"]
"""Columns of the inputs of DTM2000; a list, as pandas selects columns by a list."""


class Future(NamedTuple):
    """A course of the space weather after the last measurements."""

    flux: np.ndarray  # (days,) F10.7 [sfu], one a day
    kp: np.ndarray  # (intervals,) Kp, one every three hours


@dataclass(frozen=True, eq=False)
class Weather:
    """Measurements of F10.7 and Kp without gaps; either series may be the longer one."""

    first: int  # the first day (modified Julian day, UTC)
    flux: np.ndarray  # (days,) F10.7 [sfu], one a day
    kp: np.ndarray  # (intervals,) Kp, one every three hours

    @property
    def end(self) -> float:
        """Time (modified Julian day) up to which both are known, a whole quarter of a day."""
        # A flux serves the day after it.
        end = min(self.first + len(self.flux) + 1, self.first + len(self.kp) / INTERVALS)
        return math.floor(QUARTERS * (end + ROUNDING)) / QUARTERS

    def keep_known(self, day: float) -> "Weather":
        """Return the measurements that were known at a time, a modified Julian day with its fraction."""
        elapsed = day - self.first + ROUNDING
        fluxes = max(0, math.floor(elapsed - MEASURED) + 1)
        return Weather(self.first, self.flux[:fluxes], self.kp[: max(0, math.floor(INTERVALS * elapsed))])

    def drop_before(self, first: int) -> "Weather":
        """Return the measurements from the day `first` on, a modified Julian day."""
        skipped = max(0, first - self.first)
        return Weather(self.first + skipped, self.flux[skipped:], self.kp[INTERVALS * skipped :])

    def extend(self, future: Future) -> "Weather":
        """Return the measurements followed by a future."""
        flux, kp = np.concatenate([self.flux, future.flux]), np.concatenate([self.kp, future.kp])
        return Weather(self.first, flux, kp)

    def activity(self, day: np.ndarray) -> dict[str, np.ndarray]:
        """Return the inputs of DTM2000 at times `day` (n,), modified Julian days, by the names of ACTIVITY.

        No figure depends on a later measurement: the flux is that of 24 hours before, its mean ends there,
        and Kp is that of the interval before the one at `day`.
        """
        measured = self.first + np.arange(len(self.flux)) + MEASURED
        interval = np.floor(INTERVALS * (day - self.first + ROUNDING)).astype(int) - DELAY
        return {
            "f107": np.interp(day - 1.0, measured, self.flux),
            "f107_mean": np.interp(day - 1.0, measured[MEAN_DAYS - 1 :], trailing_mean(self.flux, MEAN_DAYS)),
            "kp_3h": self.kp[interval],
            "kp_24h": sum(self.kp[interval - k] for k in range(INTERVALS)) / INTERVALS,
        }


def trailing_mean(values: np.ndarray, count: int) -> np.ndarray:
    """Return the means (n - count + 1,) of `count` consecutive values, each summed by itself, in order."""
    rows = len(values) - count + 1
    total = np.zeros(rows)
    for k in range(count):
        total += values[k : k + rows]
    return total / count
