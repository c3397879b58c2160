"""Regression: F10.7 and Kp of the days ahead as linear functions of the days before, by ridge regression.

The predictors of each day's F10.7 are the last daily values, those of each Kp the last eight Kp and the means
of the 24-hour periods before.
"""

from collections.abc import Callable

import numpy as np
from threadpoolctl import threadpool_limits

from opml.base.setting_types import Count, Positive
from opml.environment.forecasts.method import Forecast, ForecastMethod, ForecastSettings, Future
from opml.environment.forecasts.radio_bursts import remove_bursts
from opml.environment.space_weather import INTERVALS
from opml.environment.weather import HIGHEST_KP, Weather, trailing_mean

_ROWS = 1024  # of a sum that stay in a processor's cache: all at once take three times as long


class RegressionSettings(ForecastSettings):
    lags: Count  # daily values, the present one included
    ridge: Positive  # penalty on a coefficient of standardized variables [rows]


def fit(history: Weather, days: int, settings: RegressionSettings) -> Forecast:
    """Return the forecast, learned from the history."""
    lags, ridge = settings.lags, settings.ridge
    flux = _Ridge.fit(*_training_rows(remove_bursts(history.flux), lags, days, _flux_variables), ridge)
    kp = _Ridge.fit(*_training_rows(history.kp, INTERVALS * lags, INTERVALS * days, _kp_variables), ridge)

    def forecast(past: Weather, _day: float) -> Future:
        daily = _flux_variables(remove_bursts(past.flux[-2 * lags :]), lags)[-1]
        three_hourly = _kp_variables(past.kp[-INTERVALS * lags :], INTERVALS * lags)[-1]
        return Future(flux.predict(daily), np.clip(kp.predict(three_hourly), 0.0, HIGHEST_KP))

    return forecast


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


class _Ridge:
    """Linear regression of many targets on standardized variables."""

    def __init__(self, mean: np.ndarray, scale: np.ndarray, level: np.ndarray, slopes: np.ndarray) -> None:
        self._mean, self._scale, self._level, self._slopes = mean, scale, level, slopes

    @classmethod
    def fit(cls, x: np.ndarray, y: np.ndarray, ridge: float) -> "_Ridge":
        """Fit the regression to rows x (n, variables) and y (n, targets)."""
        mean, scale, level = x.mean(axis=0), x.std(axis=0) + 1e-12, y.mean(axis=0)
        normal, products = ridge * np.eye(x.shape[1]), np.zeros((x.shape[1], y.shape[1]))
        with threadpool_limits(limits=1, user_api="blas"):  # sums in one order, whatever the machine
            for begin in range(0, len(x), _ROWS):
                rows = slice(begin, begin + _ROWS)
                z = (x[rows] - mean) / scale
                normal += z.T @ z
                products += z.T @ (y[rows] - level)
            return cls(mean, scale, level, np.linalg.solve(normal, products))

    def predict(self, x: np.ndarray) -> np.ndarray:
        """Return the targets of one row of variables."""
        return np.asarray(self._level + ((x - self._mean) / self._scale) @ self._slopes)


METHOD = ForecastMethod(
    "regression",
    RegressionSettings,
    fit,
    least_days=lambda settings: 5 * settings.lags,
    past_days=lambda settings: settings.lags,
)
