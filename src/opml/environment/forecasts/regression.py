"""F10.7 and Kp of the days ahead as linear functions of the days before, by ridge regression.

F10.7 of each day ahead is regressed on the daily values before it, each Kp ahead on the eight last ones and
on the means of the 24-hour periods before.
"""

from collections.abc import Callable

import numpy as np

from opml.base.setting_types import Count, Positive
from opml.environment.forecasts.bursts import without_bursts
from opml.environment.forecasts.method import Forecast, Future, Method, Settings
from opml.environment.space_weather import INTERVALS
from opml.environment.weather import HIGHEST_KP, Weather, trailing_mean


def fit(history: Weather, *, days: int, settings: Settings) -> Forecast:
    """The forecast; `settings` holds the number of daily `lags`, the present one included, and `ridge`.

    ridge: penalty on a coefficient of standardized variables, in rows.
    """
    lags, ridge = settings["lags"], settings["ridge"]
    flux = _Ridge.of(*_pairs(without_bursts(history.flux), lags, days, _last), ridge)
    kp = _Ridge.of(*_pairs(history.kp, INTERVALS * lags, INTERVALS * days, _last_kp), ridge)

    def forecast(past: Weather, day: float) -> Future:
        daily = _last(without_bursts(past.flux[-2 * lags :]), lags)[-1]
        three_hourly = _last_kp(past.kp[-INTERVALS * lags :], INTERVALS * lags)[-1]
        return Future(flux.predict(daily), np.clip(kp.predict(three_hourly), 0.0, HIGHEST_KP))

    return forecast


def _pairs(
    values: np.ndarray, before: int, after: int, variables: Callable[[np.ndarray, int], np.ndarray]
) -> tuple[np.ndarray, np.ndarray]:
    """Variables of the `before` values up to each, and the `after` values behind it."""
    window = np.lib.stride_tricks.sliding_window_view
    return variables(values[:-after], before), window(values[before:], after)


def _last(values: np.ndarray, count: int) -> np.ndarray:
    """Values up to each, (rows, count), the newest last."""
    return np.lib.stride_tricks.sliding_window_view(values, count)


def _last_kp(kp: np.ndarray, count: int) -> np.ndarray:
    """Means of the 24-hour periods up to each Kp, then the last eight values: (rows, count / 8 + 8)."""
    means = trailing_mean(kp, INTERVALS)
    window = np.lib.stride_tricks.sliding_window_view
    daily = window(means, count - INTERVALS + 1)[:, ::INTERVALS]
    return np.hstack([daily, window(kp, INTERVALS)[count - INTERVALS :]])


class _Ridge:
    """Linear regression of many targets on standardized variables."""

    def __init__(self, mean: np.ndarray, scale: np.ndarray, level: np.ndarray, slopes: np.ndarray) -> None:
        self._mean, self._scale, self._level, self._slopes = mean, scale, level, slopes

    @classmethod
    def of(cls, x: np.ndarray, y: np.ndarray, ridge: float) -> "_Ridge":
        """Learn from rows x (n, variables) and y (n, targets)."""
        mean, scale, level = x.mean(axis=0), x.std(axis=0) + 1e-12, y.mean(axis=0)
        z = (x - mean) / scale
        normal = z.T @ z + ridge * np.eye(z.shape[1])
        return cls(mean, scale, level, np.linalg.solve(normal, z.T @ (y - level)))

    def predict(self, x: np.ndarray) -> np.ndarray:
        """Targets of one row of variables."""
        found: np.ndarray = self._level + ((x - self._mean) / self._scale) @ self._slopes
        return found


METHOD = Method(
    "regression",
    "ridge regression of F10.7 and of Kp on their own past",
    {"lags": Count, "ridge": Positive},
    fit,
    least_days=lambda settings: 5 * int(settings["lags"]),
    past_days=lambda settings: int(settings["lags"]),
)
