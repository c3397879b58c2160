"""Regression: F10.7 and Kp of the days ahead as linear functions of the days before, by ridge regression.

The predictors of each day's F10.7 are the last daily values, those of each Kp the last eight Kp and the means
of the 24-hour periods before.

Futures are the forecast with its errors on those days of the past most like today: F10.7 is multiplied by the
ratio of the true to the forecast value of that day, Kp is shifted by the difference. So they surround the
forecast and spread as much as it errs on such days (error dressing: Roulston & Smith 2003, Tellus A 55).
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from threadpoolctl import threadpool_limits

from opml.base.errors import InputError
from opml.environment.forecasts import similar_days
from opml.environment.forecasts.similar_days import SimilarDays, remove_bursts
from opml.environment.space_weather import INTERVALS
from opml.environment.weather import HIGHEST_KP, Future, Weather, trailing_mean

NAME = "regression"  # in tables and reports
LAGS = 82  # daily values that a forecast starts from, the present one included
RIDGE = 10.0  # penalty on a coefficient of standardized variables [rows]

_LEAST_DAYS = 5 * LAGS  # of history, beside those of a future
_ROWS = 1024  # of a sum that stay in a processor's cache: all at once take three times as long


_Law = Callable[[np.ndarray], np.ndarray]
"""Returns the targets of one row of variables."""


def _ridge(x: np.ndarray, y: np.ndarray) -> _Law:
    """Return the linear law of targets y (n, targets) by standardized variables x (n, variables)."""
    mean, scale, level = x.mean(axis=0), x.std(axis=0) + 1e-12, y.mean(axis=0)
    normal, products = RIDGE * np.eye(x.shape[1]), np.zeros((x.shape[1], y.shape[1]))
    with threadpool_limits(limits=1, user_api="blas"):  # sums in one order, whatever the machine
        for begin in range(0, len(x), _ROWS):
            rows = slice(begin, begin + _ROWS)
            z = (x[rows] - mean) / scale
            normal += z.T @ z
            products += z.T @ (y[rows] - level)
        slopes = np.linalg.solve(normal, products)
    return lambda row: np.asarray(level + ((row - mean) / scale) @ slopes)


@dataclass(frozen=True, eq=False)
class Forecast:
    """A forecast of some days that has learned from the weather before a run."""

    history: Weather
    days: int  # of each future
    flux: _Law
    kp: _Law

    @classmethod
    def fit(cls, history: Weather, *, days: int) -> "Forecast":
        """Return the forecast, learned from the history. Raises InputError where that is too short."""
        check_history(history, days=days)
        flux = _ridge(*_training_rows(remove_bursts(history.flux), LAGS, days, _flux_variables))
        kp = _ridge(*_training_rows(history.kp, INTERVALS * LAGS, INTERVALS * days, _kp_variables))
        return cls(history, days, flux, kp)

    def future(self, past: Weather) -> Future:
        """Return what is expected after the weather that is known."""
        daily = _flux_variables(remove_bursts(past.flux[-2 * LAGS :]), LAGS)[-1]
        three_hourly = _kp_variables(past.kp[-INTERVALS * LAGS :], INTERVALS * LAGS)[-1]
        return Future(self.flux(daily), np.clip(self.kp(three_hourly), 0.0, HIGHEST_KP))

    def futures(self, past: Weather, members: int) -> list[Future]:
        """Return what may come: a future of each of the days most like the last known one, nearest first.

        Raises InputError where the history is too short.
        """
        _check_length(self.history, similar_days.PAST + 4 * similar_days.APART * members + self.days)
        today, history, futures = self.future(past), self.history, []
        for day in self._similar_days.nearest(past, members):
            expected = self.future(history.keep_known(history.first + day + 1.0))
            true = self._similar_days.sequel(day)
            kp = np.clip(today.kp + true.kp - expected.kp, 0.0, HIGHEST_KP)
            futures.append(Future(today.flux * true.flux / expected.flux, kp))
        return futures

    @cached_property
    def _similar_days(self) -> SimilarDays:
        return SimilarDays(self.history, self.days, LAGS)


def check_history(history: Weather, *, days: int) -> None:
    """Raise InputError where the history is too short to learn from."""
    _check_length(history, _LEAST_DAYS + days)


def _check_length(history: Weather, least: int) -> None:
    if len(history.flux) < least:
        expected = f"{least} days of packaged weather before the epoch to learn from"
        raise InputError(f"forecast: expected {expected}, got {len(history.flux)}")


def _training_rows(
    values: np.ndarray, before: int, after: int, variables: Callable[[np.ndarray, int], np.ndarray]
) -> tuple[np.ndarray, np.ndarray]:
    """Return the variables from the `before` values up to each time, and the `after` values that follow."""
    window = np.lib.stride_tricks.sliding_window_view
    return variables(values[:-after], before), window(values[before:], after)


def _flux_variables(flux: np.ndarray, count: int) -> np.ndarray:
    """Return the `count` values up to each day, (rows, count), the newest last."""
    return np.lib.stride_tricks.sliding_window_view(flux, count)


def _kp_variables(kp: np.ndarray, count: int) -> np.ndarray:
    """Return the means of the 24-hour periods up to each Kp and the last eight Kp: (rows, count / 8 + 8)."""
    means = trailing_mean(kp, INTERVALS)
    window = np.lib.stride_tricks.sliding_window_view
    daily = window(means, count - INTERVALS + 1)[:, ::INTERVALS]
    return np.hstack([daily, window(kp, INTERVALS)[count - INTERVALS :]])
