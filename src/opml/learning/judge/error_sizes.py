"""Sizes of a corrected orbit's errors, from those of earlier corrections and from the weather ahead.

The variance of each axis of the position has four parts,

    sigma^2 = f(D)^2 (a^2 + (b D)^2 + (c drag)^2 + weather^2),

D the duration of the prediction, `drag` the displacement by a tenth more drag and `weather` the spread of the
futures of the space weather (opml.catalog.predict.weather_spread). a, b and c are such that nine tenths of
the past errors are inside 1.645 sigma. They come from quantile regression on the predictions of past mornings
that later measurements judged (opml.mornings.verdicts), in which newer errors weigh more.

f(D) = t_{0.95, n} / z_{0.95}, Student's t over the normal distribution, inflates all parts after a short
past. The degrees of freedom are one and a half times the number of predictions of that duration that fit into
the past side by side: errors of predictions that overlap by a share are correlated by that share, and the sum
of their squares then counts as that of so many independent errors.

Errors are differences from later estimates, whose own variance s^2 adds to theirs. It is subtracted.

A velocity error follows from the position's (opml.orbits.rsw_covariance); its remaining part is proportional
to the radial or cross-track size. A factor that changes with the duration makes the ellipsoids of the past
hold nine tenths.

Source: Koenker & Bassett 1978, Regression quantiles, Econometrica 46; Student's t as the predictive
distribution of few normal deviates, e.g. Gelman et al. 2013, Bayesian Data Analysis, sec. 3.2; Bartlett 1946,
On the theoretical specification and sampling properties of autocorrelated time-series, J. R. Stat. Soc. 8;
Hausman 1978, Specification tests in econometrics, Econometrica 46: the variance of the difference from a
better estimate is the difference of the variances.
"""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np
import pandas as pd

from opml.base.constants import DAY, HOUR
from opml.base.errors import InputError
from opml.learning.data.splits import are_over
from opml.orbits.rsw_covariance import AXES, free_parts, half_width
from opml.tables import COMPONENTS, DOUBT

LEVEL = 0.9  # share of the errors that intervals and ellipsoids are to hold, and the level that reports print
INSIDE = half_width(LEVEL)  # half the width of that interval, in standard deviations

MEMORY_DAYS = 8.0
"""Time in which the weight of a past error falls by e: eight days, so that predictions of a week count."""

OVERLAP = 1.5
"""Independent errors per duration of a prediction, where predictions overlap: 1 / (integral of (1 - x)^2 over
both sides of 0)."""

LEAST_FREEDOM = 2.0  # least degrees of freedom: a factor of 1.8
LEAST_ROWS = 20  # least number of past errors to learn sizes from

_MOST_ROWS = 3000
_FACTORS_AT = DAY * np.array([0.5, 1.0, 2.0, 4.0, 7.0])
"""Durations at which the ellipsoids of the past have a factor each [s]; between them by the logarithm."""

_NEARBY = 0.35  # width of the bell of ln(duration) whose ellipsoids a factor comes from

_FIRST_GUESSES = ((-0.5, -1.0, -1.0), (-1.0, -1.0, 0.0))
_SMALLEST = 1.0  # least size of an error that is stated for a position [m]


@dataclass(frozen=True, eq=False)
class Sizes:
    """Sizes of errors, in the terms of the module's formula."""

    constant: np.ndarray  # (3,) a [m]
    rate: np.ndarray  # (3,) b [m/s]
    drag: np.ndarray  # (3,) c
    velocity: np.ndarray  # (3,) factors of the velocity
    inflation: np.ndarray  # (5,) factors of the variances, at the durations `_FACTORS_AT`
    days: float  # length of the past that the sizes come from
    reach: float  # its longest prediction [s]

    def sigmas(self, rows: pd.DataFrame) -> np.ndarray:
        """Return standard deviations (n, 6) [m, m/s] of the parts for `rsw_covariance.rsw_covariances`.

        rows: duration [s], rate [rad/s], drag_* and weather_* [m]
        """
        return self._factors(rows)[:, None] * self._shown(rows)

    def _factors(self, rows: pd.DataFrame) -> np.ndarray:
        """Return by what (n,) sizes are larger than the past showed them: widening and inflation."""
        wide = widening(rows["duration"].to_numpy(), self.days)
        factor = np.interp(np.log(np.maximum(rows["duration"], HOUR)), np.log(_FACTORS_AT), self.inflation)
        return wide * np.sqrt(factor)

    def _shown(self, rows: pd.DataFrame) -> np.ndarray:
        """Return standard deviations (n, 6) as the past showed them, without widening and inflation."""
        duration = rows["duration"].to_numpy()
        # How errors grow beyond the longest prediction that is over is unknown: by the square, it is assumed.
        grown = duration * np.maximum(duration / self.reach, 1.0)
        position = np.stack(
            [
                np.sqrt(
                    self.constant[k] ** 2
                    + (self.rate[k] * grown) ** 2
                    + (self.drag[k] * rows[f"drag_{axis}"]) ** 2
                    + rows[f"weather_{axis}"] ** 2
                )
                for k, axis in enumerate(AXES)
            ],
            axis=1,
        )
        velocity = self.velocity * rows["rate"].to_numpy()[:, None] * position[:, [0, 0, 2]]
        return np.hstack([position, velocity])

    @classmethod
    def learned(cls, past: pd.DataFrame, *, now: float) -> Self:
        """Learn sizes from the rows of a `judged` table that were over by `now` [s].

        Raises InputError for fewer than LEAST_ROWS.
        """
        past = past[are_over(past, now)]
        if len(past) < LEAST_ROWS:
            raise InputError(
                f"sizes: expected {LEAST_ROWS} predictions that were over by day {now / DAY:g} to learn "
                f"from, got {len(past)}"
            )
        days, reach = (now - past["t_i"].min()) / DAY, float(past["duration"].max())
        past = past.iloc[:: -(-len(past) // _MOST_ROWS)]
        weight = np.exp((past["t_j"].to_numpy() - now) / (MEMORY_DAYS * DAY))
        parts = free_parts(past[list(COMPONENTS)].to_numpy(), past["rate"].to_numpy())
        errors, reference = np.abs(parts[:, :3]), past[DOUBT].to_numpy(float)
        axes = zip(AXES, errors.T, reference.T, strict=True)
        fitted = [_fit_axis(past, *axis, weight=weight) for axis in axes]
        constant, rate, drag = np.array(fitted).T
        plain = cls(constant, rate, drag, np.ones(3), np.ones(len(_FACTORS_AT)), days, reach)
        sizes = np.abs(parts[:, 3:])
        velocity = np.array(
            [
                weighted_quantile(size / sigma, weight, LEVEL) / INSIDE
                for size, sigma in zip(sizes.T, plain._shown(past)[:, 3:].T, strict=True)
            ]
        )
        stated = replace(plain, velocity=velocity)
        square = stated._shown(past)[:, :3] ** 2 + reference**2
        distance = np.sum(errors**2 / square, axis=1)
        return replace(stated, inflation=_inflation(distance, past["duration"].to_numpy(), weight))


def along_track(rows: pd.DataFrame) -> np.ndarray:
    """Return the standard deviations (n,) of e_y in such rows [m]."""
    return np.hypot(rows["sigma_y"].to_numpy(float), rows["doubt_y"].to_numpy(float))


def widening(duration: np.ndarray, days: float) -> np.ndarray:
    """Return f (n,) of the formula, for durations (n,) [s] after a past of so many days."""
    from scipy.special import stdtrit  # `scipy.stats` has the same number, and takes half a second to import

    freedom = np.maximum(OVERLAP * days / (1.0 + duration / DAY), LEAST_FREEDOM)
    return np.asarray(stdtrit(freedom, 0.5 + 0.5 * LEVEL) / INSIDE)


def _inflation(distance: np.ndarray, duration: np.ndarray, weight: np.ndarray) -> np.ndarray:
    """Return the factors that make ellipsoids with squared distances (n,) hold nine tenths, by duration."""
    nearness = np.log(np.maximum(duration, HOUR)[None] / _FACTORS_AT[:, None]) / _NEARBY
    bells = weight * np.exp(-0.5 * nearness**2)
    holding = np.array([weighted_quantile(distance, bell, LEVEL) for bell in bells])
    return holding / _within()


def _within() -> float:
    """Return the squared distance within which LEVEL of normal errors of three axes lie."""
    from scipy.special import gammaincinv

    return 2.0 * float(gammaincinv(1.5, LEVEL))  # chi2 of three degrees of freedom


def weighted_quantile(values: np.ndarray, weight: np.ndarray, level: float) -> float:
    """Return the least of the values (n,) such that those up to it hold `level` of the weight (n,)."""
    order = np.argsort(values, kind="stable")
    share = np.cumsum(weight[order])
    return float(values[order][min(int(np.searchsorted(share, level * share[-1])), len(values) - 1)])


def _fit_axis(
    past: pd.DataFrame, axis: str, size: np.ndarray, reference: np.ndarray, *, weight: np.ndarray
) -> tuple[float, float, float]:
    """Return a, b and c of an axis by quantile regression.

    size: (n,) of the errors [m]
    reference: (n,) standard deviations of what they are compared with [m]
    weight: (n,); an error counts in units of the typical error of its day of duration
    """
    from opml.learning.judge.simplex_kernels import minimum  # with Numba, where sizes are learned alone

    duration = past["duration"].to_numpy()
    drag, weather = (past[f"{name}_{axis}"].to_numpy() for name in ("drag", "weather"))
    day = np.ceil(duration / DAY)
    typical = np.ones(len(past))
    for number in np.unique(day):
        rows = day == number
        typical[rows] = max(weighted_quantile(size[rows], weight[rows], LEVEL), _SMALLEST)
    base = max(float(typical[day == day.min()][0]) / INSIDE, _SMALLEST)
    units = np.array([base, base / DAY, 1.0])
    relative = weight / np.sum(weight) / typical

    errors = size, duration, drag, weather**2 + reference**2, relative
    minima = [minimum(np.array(start), units, errors, INSIDE, LEVEL) for start in _FIRST_GUESSES]
    a, b, c = units * np.exp(min(minima, key=lambda end: float(end[1]))[0])
    return float(a), float(b), float(c)
