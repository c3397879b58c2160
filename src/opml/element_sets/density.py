"""Density of the thermosphere at a catalogue's heights: measured up to a morning, forecast after it.

Densities are means over the globe of NRLMSIS 2.1 every six hours. The forecast is linear: for each height
and each day ahead, the change of the logarithm since the day before the morning follows from the last days',
weeks' and one rotation's densities, F10.7 and ap. It is fitted by least absolute deviations.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from opml.base import epochs
from opml.base.errors import InputError
from opml.environment import nrlmsis
from opml.environment.forecasts.similar_days import remove_bursts
from opml.environment.space_weather import INTERVALS, MEASURED, ROUNDING
from opml.environment.weather import QUARTERS, Weather

HEIGHTS = 1e3 * np.array([250.0, 300.0, 350.0, 400.0, 450.0, 500.0, 550.0, 600.0, 700.0, 850.0, 1000.0])
"""Heights of the tables [m]; between them the logarithm is linear."""

DAYS_AHEAD = 9
"""Days of the forecast: seven, half a day to the set that judges, and what the newest weather may lack."""

_FLUX_DAYS = 82  # of flux that a density asks for: the mean of 81 days up to the day before
RUN_UP = 84  # days of densities before a morning that its forecast and its levels of drag need

_LATITUDES, _LONGITUDES = 4, 6
_MEANS = (7, 27, 81)
_ROTATION = 27
_UNIX_DAY = 40587  # modified Julian day of 1970-01-01
_AP_FLOOR = 3.0
_FLUX_SCALE = math.log(120.0)  # of a middling Sun [ln sfu]
_LEAST, _RIDGE, _TOLERANCE, _MOST = 2e-3, 1e-6, 1e-4, 25  # of the iteration for least absolute deviations


@dataclass(frozen=True, eq=False)
class Densities:
    """Logarithms of mean densities [ln kg/m3]."""

    first: int  # the day (modified Julian day, UTC) at which the first quarter begins
    log: np.ndarray  # (quarters, heights)

    def quarter(self, time: float) -> int:
        """Return the number of quarters that are over at a time (modified Julian day)."""
        return math.floor(QUARTERS * (float(time) - self.first + ROUNDING))

    def before(self, morning: float) -> "Densities":
        """Return the densities of the RUN_UP days before a morning (modified Julian day)."""
        issue = self.quarter(morning)
        begin = QUARTERS * (issue // QUARTERS - RUN_UP)
        return Densities(self.first + begin // QUARTERS, self.log[begin:issue])


def first_morning(weather: Weather) -> float:
    """Return the first morning (modified Julian day) whose run-up the weather reaches."""
    return float(weather.first + _FLUX_DAYS + RUN_UP + 1)


def clean(weather: Weather) -> Weather:
    """Return the weather without the radio bursts of flares, for which NRLMSIS has no density."""
    return Weather(weather.first, remove_bursts(weather.flux), weather.kp)


def measured(weather: Weather, first: int, end: float) -> Densities:
    """Return the densities from a day up to a time, both modified Julian days, under the measured weather.

    Each quarter has the flux of the day before it, the mean of the 81 days up to that, and the ap of the 57
    hours before. Raises InputError where the weather does not reach so far back.
    """
    nrlmsis.check_installed()
    days = first - weather.first
    if days < _FLUX_DAYS:
        first_day, begins = map(epochs.calendar, (first, weather.first))
        expected = f"measurements {_FLUX_DAYS} days before {first_day}"
        raise InputError(f"weather: expected {expected}, got them from {begins} on")
    sines, weights = np.polynomial.legendre.leggauss(_LATITUDES)
    north, east = np.arcsin(sines), 2.0 * np.pi * np.arange(_LONGITUDES) / _LONGITUDES
    totals, ap = np.concatenate([[0.0], np.cumsum(weather.flux)]), nrlmsis.ap_of_kp(weather.kp)
    rows = []
    for quarter in range(math.floor(QUARTERS * (end - first + ROUNDING))):
        centre = days + (quarter + 0.5) / QUARTERS
        day, interval = math.floor(centre), math.floor(INTERVALS * centre)
        mean = (totals[day] - totals[day - 81]) / 81.0
        figures = np.concatenate([[weather.flux[day - 1], mean], nrlmsis.ap_inputs(ap, interval)])
        clock = weather.first + centre - _UNIX_DAY
        rho = nrlmsis.densities(clock, east, north, HEIGHTS, figures)
        rows.append(np.log(np.einsum("j,ijk->k", weights / (2.0 * _LONGITUDES), rho)))
    return Densities(first, np.array(rows).reshape(-1, len(HEIGHTS)))


def fit(densities: Densities, weather: Weather, *, end: float) -> np.ndarray:
    """Return the outlook: coefficients (DAYS_AHEAD, predictors, heights) of the forecast, learned from the
    mornings, 06 UTC, whose days ahead are over at a time.

    end: modified Julian day

    Raises InputError for less than a year.
    """
    last = min(densities.quarter(end), len(densities.log))
    issues = np.arange(QUARTERS * RUN_UP + 1, last - QUARTERS * DAYS_AHEAD, QUARTERS)
    if len(issues) < 365:
        raise InputError(
            f"weather: expected a year and more to learn the density from, got {len(issues)} days"
        )
    return np.array([_fit_day(densities, weather, issues, day) for day in range(DAYS_AHEAD)])


def _fit_day(densities: Densities, weather: Weather, issues: np.ndarray, day: int) -> np.ndarray:
    """Return the coefficients (predictors, heights) of one day ahead."""
    x = _predictors(densities, weather, issues, day)
    # Of the change since yesterday: what the model's level is off by drops out.
    y = _mean(densities.log, issues, QUARTERS * day, QUARTERS * (day + 1)) - _mean(
        densities.log, issues, -QUARTERS, 0
    )
    columns = [_least_deviations(x[:, :, k], y[:, k]) for k in range(len(HEIGHTS))]
    return np.stack(columns, axis=1)


def _least_deviations(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Return the coefficients of least absolute deviations, by least squares weighted again and again."""
    x, y = np.ascontiguousarray(x), np.ascontiguousarray(y)
    weights, found = np.ones(len(y)), np.zeros(x.shape[1])
    for _ in range(_MOST):
        weighted = x * weights[:, None]
        before, found = found, np.linalg.solve(x.T @ weighted + _RIDGE * np.eye(len(found)), weighted.T @ y)
        if np.abs(found - before).max() < _TOLERANCE:
            break
        # A square divided by the size of its residual counts as that size; none so small that it dominates.
        weights = 1.0 / np.maximum(np.abs(y - x @ found), _LEAST)
    return found


def _mean(log: np.ndarray, issues: np.ndarray, begin: int, end: int) -> np.ndarray:
    """Return means (issues, heights) over the quarters from `begin` to `end` after each issue."""
    totals = np.concatenate([np.zeros((1, log.shape[1])), np.cumsum(log, axis=0)])
    return np.asarray((totals[issues + end] - totals[issues + begin]) / (end - begin))


def _predictors(densities: Densities, weather: Weather, issues: np.ndarray, day: int) -> np.ndarray:
    """Return what the forecast of a day ahead rests on: (issues, predictors, heights).

    issues: numbers of quarters that are over
    """
    log = densities.log
    yesterday = _mean(log, issues, -QUARTERS, 0)
    recent = [_mean(log, issues, -QUARTERS * (k + 1), -QUARTERS * k) for k in (1, 2)]
    means = [_mean(log, issues, -QUARTERS * k, 0) for k in _MEANS]
    before = [  # one rotation before the day, and its neighbours
        _mean(log, issues + min(QUARTERS * (day - _ROTATION + k), -QUARTERS), 0, QUARTERS) for k in (-1, 0, 1)
    ]
    air = [part - yesterday for part in (*recent, *means, log[issues - 1], *before)]
    sun = [
        np.broadcast_to(part[:, None], yesterday.shape) for part in _activity(densities, weather, issues, day)
    ]
    return np.stack([np.ones_like(yesterday), *air, *sun], axis=1)


def _activity(densities: Densities, weather: Weather, issues: np.ndarray, day: int) -> list[np.ndarray]:
    """Return the predictors (issues,) of F10.7 and ap, each as it was known."""
    elapsed = densities.first - weather.first + issues / QUARTERS + ROUNDING
    newest = np.minimum(np.floor(elapsed - MEASURED).astype(int), len(weather.flux) - 1)
    flux = np.log(weather.flux)
    level = _trailing(flux, newest, 81)
    target = np.minimum(newest + 1 + day - _ROTATION, newest)
    ap = nrlmsis.ap_of_kp(weather.kp)
    over = np.floor(INTERVALS * elapsed).astype(int) - 1
    rotation = np.minimum(over + INTERVALS * (day + 1 - _ROTATION), over)
    return [
        flux[newest] - level,
        flux[newest - 1] - level,
        _trailing(flux, newest, _ROTATION) - level,
        flux[target] - level,
        flux[target - 1] - level,
        level - _FLUX_SCALE,
        np.log(_trailing(ap, over, 2) + _AP_FLOOR),
        np.log(_trailing(ap, over, INTERVALS) + _AP_FLOOR),
        np.log(_trailing(ap, over - INTERVALS, INTERVALS) + _AP_FLOOR),
        np.log(_trailing(ap, rotation, INTERVALS) + _AP_FLOOR),
    ]


def _trailing(values: np.ndarray, last: np.ndarray, count: int) -> np.ndarray:
    """Return the means of `count` values up to and with the places `last` (n,)."""
    totals = np.concatenate([[0.0], np.cumsum(values)])
    return np.asarray((totals[last + 1] - totals[last + 1 - count]) / count)


class MorningDensity:
    """The density about one morning, integrated twice over time: what drag does to a mean anomaly."""

    def __init__(self, densities: Densities, ahead: np.ndarray, morning: float) -> None:
        """Take the densities up to a morning (modified Julian day) and the days after it (days, heights)."""
        recent = densities.before(morning)
        log = np.concatenate([recent.log, np.repeat(ahead, QUARTERS, axis=0)])
        self._begin = float(recent.first)
        # About one at all heights, so that the least displacement that counts means the same at each.
        self._level = log.mean(axis=0)
        self._rho = np.exp(log - self._level)
        step, start = 1.0 / QUARTERS, np.zeros((1, len(HEIGHTS)))
        self._once = np.concatenate([start, np.cumsum(step * self._rho, axis=0)])
        # The density is constant within a quarter of a day: linear when integrated once, quadratic twice.
        twice = step * self._once[:-1] + 0.5 * step**2 * self._rho
        self._twice = np.concatenate([start, np.cumsum(twice, axis=0)])

    def displacement(self, height: np.ndarray, t: np.ndarray, after: np.ndarray) -> np.ndarray:
        """Return the density integrated twice from epochs `t` on: (n, m) [kg/m3 d2].

        height: (n,) [m]
        t: (n,) modified Julian days
        after: (n, m) times after `t` [d], negative ones before it
        """
        lower = np.clip(np.searchsorted(HEIGHTS, height) - 1, 0, len(HEIGHTS) - 2)
        part = ((height - HEIGHTS[lower]) / (HEIGHTS[lower + 1] - HEIGHTS[lower]))[:, None]
        below, above = (self._at_height(lower + k, t, after) for k in (0, 1))
        return np.asarray(np.exp((1.0 - part) * below + part * above))

    def _at_height(self, column: np.ndarray, t: np.ndarray, after: np.ndarray) -> np.ndarray:
        """Return the logarithm of the displacement at heights of the table."""
        once, twice = self._integrals(column, t)
        _, later = self._integrals(column[:, None], t[:, None] + after)
        displacement = later - twice[:, None] - after * once[:, None]
        logs = np.log(np.maximum(displacement, 1e-12))
        return np.asarray(logs + self._level[column][:, None])

    def _integrals(self, column: np.ndarray, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        place = QUARTERS * (t - self._begin)
        row = np.clip(np.floor(place).astype(int), 0, len(self._rho) - 1)
        rest = (place - row) / QUARTERS
        rho, once = self._rho[row, column], self._once[row, column]
        return once + rho * rest, self._twice[row, column] + (once + 0.5 * rho * rest) * rest


Air = Callable[[float], MorningDensity]
"""Returns the density about a morning (modified Julian day), after the last measurement as of that."""


def air(weather: Weather, densities: Densities, outlook: np.ndarray) -> Air:
    """Return the air that is measured up to a morning, and forecast after it.

    weather: clean; densities: under it; outlook: coefficients of a forecast, as of `fit`
    """

    def about(morning: float) -> MorningDensity:
        issued = min(morning, weather.end)
        # Nothing that was measured after the morning counts.
        known = weather.keep_known(issued).drop_before(math.floor(issued) - RUN_UP)
        recent = densities.before(issued)
        issue = np.array([len(recent.log)])
        changes = [
            np.einsum("kh,kh->h", _predictors(recent, known, issue, day)[0], of_day)
            for day, of_day in enumerate(outlook)
        ]
        ahead = _mean(recent.log, issue, -QUARTERS, 0) + np.array(changes)
        return MorningDensity(densities, ahead, issued)

    return about


def learned_air(weather: Weather, *, first: int, end: float) -> tuple[Air, np.ndarray]:
    """Return the air and its outlook, learned from the days (modified Julian) from `first` to `end`."""
    densities = measured(weather, max(first, weather.first + RUN_UP), weather.end)
    outlook = fit(densities, weather, end=end)
    return air(weather, densities, outlook), outlook
