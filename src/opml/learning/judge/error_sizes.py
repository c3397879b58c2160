"""How far a corrected orbit may be off, from what earlier corrections left and what may happen ahead.

Each axis of the position has a variance of four parts,

    sigma^2 = a^2 + (b D)^2 + f(D)^2 ((c drag)^2 + weather^2),

D the duration of the prediction, `drag` what a tenth more drag would do to it and `weather` what the futures
of the space weather do (opml.catalog.predict.spread). a, b and c are such that nine tenths of the past's
errors were inside 1.645 sigma: quantile regression on replays that were over (opml.ephemerides.replays),
newer ones weighing more.

f widens what depends on the weather where few stretches of it were seen: the quantile of Student's t of as
many degrees of freedom as predictions of that duration fit side by side into the past, by the normal one.
a and b come from forces that last, and show in a week.

Errors that are held against later estimates have the variance of these, too, which is no part of sigma.

A velocity follows its position (opml.orbits.rsw_covariance); what it may differ by beyond that is
proportional to the radial or cross-track size. One number makes the ellipsoids of the past hold nine tenths.

Source: Koenker & Bassett 1978, Regression quantiles, Econometrica 46; Student's t as the predictive
distribution of few normal deviates, e.g. Gelman et al. 2013, Bayesian Data Analysis, sec. 3.2.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
import pandas as pd

from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.orbits.rsw_covariance import AXES, free_parts, half_width, rsw_covariances
from opml.tables import COMPONENTS, DOUBT

LEVEL = 0.9
"""Share of the errors that intervals and ellipsoids are to hold."""

INSIDE = half_width(LEVEL)
"""Half the width of that interval, in standard deviations."""

MEMORY_DAYS = 8.0
"""By which the weight of a past error falls by e: a week and a day, so that predictions of a week count."""

LEAST_FREEDOM = 2.0
"""Degrees of freedom below which nothing gets wider: a factor of 1.8."""

LEAST_ROWS = 20
"""Errors of the past that sizes can be learned from."""

_MOST_ROWS = 3000
_FIRST_GUESSES = ((-0.5, -1.0, -1.0), (-1.0, -1.0, 0.0))
_SMALLEST = 1.0
"""Sizes below which a position is never stated to be known [m]."""


@dataclass(frozen=True, eq=False)
class Sizes:
    """Sizes of errors: per axis a [m], b [m/s] and c (3,), factors of velocities (3,), of variances.

    days: of the past that they are from; reach: its longest prediction [s].
    """

    constant: np.ndarray
    rate: np.ndarray
    drag: np.ndarray
    velocity: np.ndarray
    inflation: float
    days: float
    reach: float

    def sigmas(self, rows: pd.DataFrame) -> np.ndarray:
        """Standard deviations (n, 6) [m, m/s] of the parts that `rsw_covariance.rsw_covariances` is made of.

        rows: duration [s], rate [rad/s], drag_* and weather_* [m].
        """
        sigmas: np.ndarray = np.sqrt(self.inflation) * self._sigmas(rows, few=True)
        return sigmas

    def _sigmas(self, rows: pd.DataFrame, *, few: bool) -> np.ndarray:
        duration = rows["duration"].to_numpy()
        wide = widening(duration, self.days) if few else np.ones(len(rows))
        # Nobody has seen yet how errors grow beyond the longest prediction that is over: by its square, say.
        grown = duration * np.maximum(duration / self.reach, 1.0)
        position = np.stack(
            [
                np.sqrt(
                    self.constant[k] ** 2
                    + (self.rate[k] * grown) ** 2
                    + wide**2 * ((self.drag[k] * rows[f"drag_{axis}"]) ** 2 + rows[f"weather_{axis}"] ** 2)
                )
                for k, axis in enumerate(AXES)
            ],
            axis=1,
        )
        velocity = self.velocity * rows["rate"].to_numpy()[:, None] * position[:, [0, 0, 2]]
        return np.hstack([position, velocity])

    @classmethod
    def learned(cls, past: pd.DataFrame, *, now: float) -> Self:
        """Sizes by the rows of a `replay` table that were over by `now` [s].

        Raises InputError where there are fewer than LEAST_ROWS.
        """
        from scipy.stats import chi2

        past = past[past["t_known"] <= now]
        if len(past) < LEAST_ROWS:
            raise InputError(
                f"sizes: expected {LEAST_ROWS} predictions that were over by day {now / DAY:g} to learn "
                f"from, got {len(past)}"
            )
        days, reach = (now - past["t_i"].min()) / DAY, float(past["duration"].max())
        past = past.iloc[:: -(-len(past) // _MOST_ROWS)]
        weight = np.exp((past["t_j"].to_numpy() - now) / (MEMORY_DAYS * DAY))
        constant, rate, drag = np.array([_fitted(past, axis, weight) for axis in AXES]).T
        plain = cls(constant, rate, drag, np.ones(3), 1.0, days, reach)
        parts = free_parts(past[list(COMPONENTS)].to_numpy(), past["rate"].to_numpy())
        doubt = past[DOUBT].to_numpy()
        velocity = np.array(
            [
                weighted_quantile(np.abs(part) / sigma, weight, LEVEL) / INSIDE
                for part, sigma in zip(parts[:, 3:].T, plain._sigmas(past, few=False)[:, 3:].T, strict=True)
            ]
        )
        whole = replace(plain, velocity=velocity)
        square = whole._sigmas(past, few=False)[:, :3] ** 2 + doubt**2
        distance = np.sum(parts[:, :3] ** 2 / square, axis=1)
        inflation = weighted_quantile(distance, weight, LEVEL) / float(chi2.ppf(LEVEL, 3))
        return replace(whole, inflation=inflation)


def widening(duration: np.ndarray, days: float) -> np.ndarray:
    """Factor (n,) on what depends on the weather, for durations (n,) [s] after a past of so many days."""
    from scipy.stats import t  # half a second that no plan should wait for

    freedom = np.maximum(days / (1.0 + duration / DAY), LEAST_FREEDOM)
    factor: np.ndarray = t.ppf(0.5 + 0.5 * LEVEL, freedom) / INSIDE
    return factor


def weighted_quantile(values: np.ndarray, weight: np.ndarray, level: float) -> float:
    """Least of the values (n,) such that those up to it hold `level` of the weight (n,)."""
    order = np.argsort(values, kind="stable")
    share = np.cumsum(weight[order])
    return float(values[order][min(int(np.searchsorted(share, level * share[-1])), len(values) - 1)])


def _fitted(past: pd.DataFrame, axis: str, weight: np.ndarray) -> tuple[float, float, float]:
    """a, b and c of an axis by quantile regression; a row counts in units of its day of duration."""
    from scipy.optimize import minimize

    size, duration = past[f"e_{axis}"].abs().to_numpy(), past["duration"].to_numpy()
    drag, weather, doubt = (past[f"{name}_{axis}"].to_numpy() for name in ("drag", "weather", "doubt"))
    day = np.ceil(duration / DAY)
    typical = np.ones(len(past))
    for one in np.unique(day):
        rows = day == one
        typical[rows] = max(weighted_quantile(size[rows], weight[rows], LEVEL), _SMALLEST)
    base = max(float(typical[day == day.min()][0]) / INSIDE, _SMALLEST)
    units = np.array([base, base / DAY, 1.0])
    relative = weight / np.sum(weight) / typical

    def loss(logarithms: np.ndarray) -> float:
        a, b, c = units * np.exp(logarithms)
        above = size - INSIDE * np.sqrt(a**2 + (b * duration) ** 2 + (c * drag) ** 2 + weather**2 + doubt**2)
        pinball = np.where(above > 0.0, LEVEL * above, (LEVEL - 1.0) * above)
        # What the past says nothing of stays where it is.
        return float(np.sum(relative * pinball) + 1e-5 * np.sum(logarithms**2))

    options = {"maxiter": 400, "xatol": 1e-2, "fatol": 1e-6}
    found = [minimize(loss, start, method="Nelder-Mead", options=options) for start in _FIRST_GUESSES]
    best = min(found, key=lambda one: float(one.fun))
    a, b, c = units * np.exp(best.x)
    return float(a), float(b), float(c)


def as_known(replay: pd.DataFrame, mornings: Sequence[float]) -> np.ndarray:
    """Standard deviations (n, 6) of the rows of a `replay` table, each as its own morning would have had it.

    mornings (n,): when what a row was made with was known [s]. Not finite where the past was too short.
    """
    sigma = np.full((len(replay), 6), np.nan)
    when = np.asarray(mornings)
    for now in np.unique(when):
        rows = when == now
        try:
            sizes = Sizes.learned(replay, now=float(now))
        except InputError:
            continue
        sigma[rows] = sizes.sigmas(replay[rows])
    return sigma


def covariances(rows: pd.DataFrame, sigma: np.ndarray) -> np.ndarray:
    """Covariances (n, 6, 6) in RSW [m, m/s] of rows with a `rate` [rad/s], from their `sigmas`."""
    return rsw_covariances(sigma, rows["rate"].to_numpy())
