"""Space weather as it is known on a day: measured F10.7 and Kp, cut where the day's knowledge ends.

A flux counts as known from the time it is measured, 20:00 UTC, and a Kp once its three hours are over. The
mean flux is that of the last 81 days: the centred one would look 40 days ahead.
"""

import math
from dataclasses import dataclass

import numpy as np

from opml.environment.space_weather import DELAY, INTERVALS, MEASURED, ROUNDING

MEAN_DAYS = 81
"""Days of the mean flux."""

RUN_UP = MEAN_DAYS + 1
"""Days of measurements that have to come before the first time that `Weather.activity` is asked for."""

HIGHEST_KP = 9.0

ACTIVITY = ["f107", "f107_mean", "kp_3h", "kp_24h"]
"""Columns of what DTM2000 asks for; a list, so that a DataFrame takes it as it is."""


@dataclass(frozen=True, eq=False)
class Weather:
    """Measurements without gaps, from the day `first` (modified Julian day, UTC) on.

    flux: (days,) F10.7 [sfu], one a day; kp: (intervals,) Kp, one every three hours. One may reach further.
    """

    first: int
    flux: np.ndarray
    kp: np.ndarray

    def known_at(self, day: float) -> "Weather":
        """What was known at a time, a modified Julian day with its fraction."""
        elapsed = day - self.first + ROUNDING
        fluxes = max(0, math.floor(elapsed - MEASURED) + 1)
        return Weather(self.first, self.flux[:fluxes], self.kp[: max(0, math.floor(INTERVALS * elapsed))])

    def since(self, first: int) -> "Weather":
        """What was measured from the day `first` on, a modified Julian day."""
        skipped = max(0, first - self.first)
        return Weather(self.first + skipped, self.flux[skipped:], self.kp[INTERVALS * skipped :])

    def followed_by(self, flux: np.ndarray, kp: np.ndarray) -> "Weather":
        """The same with what comes after: one F10.7 a day, one Kp every three hours."""
        return Weather(self.first, np.concatenate([self.flux, flux]), np.concatenate([self.kp, kp]))

    def activity(self, day: np.ndarray) -> dict[str, np.ndarray]:
        """What DTM2000 asks for at times `day`, (n,) modified Julian days, by the names of `solar_activity`.

        Each figure depends on nothing that was measured after its time: the flux is that of 24 hours before,
        its mean ends there, Kp is that of the interval before the one at `day`.
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
    """Means of `count` values in a row, (n - count + 1,), added in order: none depends on the others."""
    rows = len(values) - count + 1
    total = np.zeros(rows)
    for k in range(count):
        total += values[k : k + rows]
    return total / count
