"""How far a corrected position may be off, from what past corrections left on the days after their training.

The residuals of rows that a model was trained on say too little: what a model leaves drifts with the time
since its training ended. So the past is asked. Within the training's days the origin rolls: a model is
trained up to it, and what it leaves on the days behind it is held against the prediction's duration and the
time since the origin, the age. A width is then

    factor(level) * scale(duration) * (1 + growth * age),

with the factor as the conformal quantile. All rows of a day share one vote, and one day more may lie
anywhere, since the predictions to a day share its weather: thousands of rows are evidence of dozens of days.

Source: Tashman 2000, Out-of-sample tests of forecasting accuracy, Int. J. Forecasting 16, for rolling
origins; `opml.learning.intervals` for the quantile of grouped residuals.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from statistics import NormalDist
from typing import Self

import numpy as np
import pandas as pd
from scipy.stats import chi2

from opml.constants import DAY, HOUR
from opml.errors import InputError
from opml.learning.contract import Model
from opml.learning.intervals import grouped_quantile
from opml.learning.mechanism import least_absolute_deviations
from opml.learning.origins import LEAST_BLOCKS
from opml.learning.paths import AXES, left
from opml.learning.splits import known_at
from opml.tables import FACTORS, LEVELS

MAIN = 0.9
"""The level that scales, growth and covariances are true at; the tails follow by their factors."""


@dataclass(frozen=True, eq=False)
class Spread:
    """Half the width of intervals of one component of the position [m]."""

    duration: np.ndarray  # (bins,) [s], ascending
    scale: np.ndarray  # (bins,) [m]
    growth: float  # per day of age
    factor: Mapping[float, float]  # by level

    def half_width(self, duration: np.ndarray, age: np.ndarray, level: float) -> np.ndarray:
        """Half the width (n,) [m] at durations (n,) [s] and ages (n,) [s]; an age below 0 counts as 0.

        Linear between the bins and constant past their ends.
        """
        half: np.ndarray = self.factor[level] * self._unit(duration, age)
        return half

    def _unit(self, duration: np.ndarray, age: np.ndarray) -> np.ndarray:
        grown = 1.0 + self.growth * np.maximum(age, 0.0) / DAY
        scaled: np.ndarray = np.interp(duration, self.duration, self.scale) * grown
        return scaled


@dataclass(frozen=True, eq=False)
class Uncertainty:
    """How far corrected positions of one model may be off: intervals of components, and a covariance."""

    spreads: Mapping[str, Spread]  # by axis
    inflation: float  # of the variances, so that the ellipsoid of MAIN holds that share
    days: int  # of residuals behind it, each counted once per origin

    def half_width(self, axis: str, duration: np.ndarray, age: np.ndarray, level: float) -> np.ndarray:
        """Half the width (n,) [m] of an axis' interval at durations and ages (n,) [s]; one of LEVELS."""
        return self.spreads[axis].half_width(duration, age, level)

    def residual_covariance(self, duration: np.ndarray, age: np.ndarray) -> np.ndarray:
        """Covariance (n, 3, 3) [m2] of corrected positions in RSW, at durations and ages (n,) [s].

        The duration is since the estimate, the age since the training ended. It is diagonal.
        """
        sigma = np.stack([self._sigma(axis, duration, age) for axis in AXES], axis=1)
        covariance: np.ndarray = self.inflation * sigma[:, :, None] ** 2 * np.eye(len(AXES))
        return covariance

    def _sigma(self, axis: str, duration: np.ndarray, age: np.ndarray) -> np.ndarray:
        """Standard deviation (n,) [m] of the normal distribution with the same interval of MAIN."""
        return self.half_width(axis, duration, age, MAIN) / NormalDist().inv_cdf(0.5 + MAIN / 2.0)

    def to_table(self) -> pd.DataFrame:
        """The `uncertainty` table."""
        return pd.concat(
            [
                pd.DataFrame({"axis": axis, "duration": one.duration, "scale": one.scale}).assign(
                    growth=one.growth,
                    inflation=self.inflation,
                    days=self.days,
                    **{name: one.factor[level] for name, level in zip(FACTORS, LEVELS, strict=True)},
                )
                for axis, one in self.spreads.items()
            ],
            ignore_index=True,
        )

    @classmethod
    def from_table(cls, table: pd.DataFrame) -> Self:
        """What `to_table` wrote, bit for bit."""
        spreads = {}
        for axis, rows in table.groupby("axis", sort=True):
            factor = dict(zip(LEVELS, rows[FACTORS].iloc[0], strict=True))
            growth = float(rows["growth"].iloc[0])
            spreads[str(axis)] = Spread(rows["duration"].to_numpy(), rows["scale"].to_numpy(), growth, factor)
        return cls(spreads, float(table["inflation"].iloc[0]), int(table["days"].iloc[0]))


def roll(
    train: Callable[[pd.DataFrame], Model], training: pd.DataFrame, *, at: Sequence[float]
) -> pd.DataFrame:
    """What models of e_y that were trained up to origins `at` [days] left of the training's later rows.

    `training`: the rows of a dataset `with_paths` that the model itself is trained on. One row per origin and
    later row: origin [days], duration, age [s], x, y, z [m].
    """
    found = []
    for origin in at:
        later = training[training["t_j"] > origin * DAY]
        errors = left(train(training[known_at(training) <= origin * DAY]), later)
        table = pd.DataFrame(errors, columns=list(AXES)).assign(
            origin=origin, duration=later["duration"].to_numpy(), age=later["t_j"].to_numpy() - origin * DAY
        )
        found.append(table)
    return pd.concat(found, ignore_index=True)


def calibrate(rolled: pd.DataFrame, *, bin_hours: float, block_hours: float) -> Uncertainty:
    """The uncertainty that the residuals `rolled`, as `roll` gives them, show.

    Scales are of durations in bins of bin_hours; all rows of a block of block_hours behind one origin share a
    vote. Raises InputError where there are too few blocks.
    """
    block = _blocks(rolled, block_hours)
    if block.max(initial=-1) + 1 < LEAST_BLOCKS:
        raise InputError(
            f"uncertainty: expected residuals in {LEAST_BLOCKS} blocks of {block_hours:g} hours behind the "
            f"origins, got {block.max(initial=-1) + 1}"
        )
    duration, age = rolled["duration"].to_numpy(), rolled["age"].to_numpy()
    spreads = {axis: _spread(duration, age, rolled[axis].to_numpy(), block, bin_hours) for axis in AXES}
    normal = Uncertainty(spreads, 1.0, int(block.max()) + 1)
    distance = mahalanobis(rolled[list(AXES)].to_numpy(), normal.residual_covariance(duration, age))
    inflation = _quantile(distance, block, MAIN) / float(chi2.ppf(MAIN, len(AXES)))
    return Uncertainty(spreads, inflation, normal.days)


def mahalanobis(errors: np.ndarray, covariance: np.ndarray) -> np.ndarray:
    """Squared Mahalanobis distances (n,) of errors (n, 3) by their covariances (n, 3, 3)."""
    solved = np.linalg.solve(covariance, errors[:, :, None])[:, :, 0]
    squared: np.ndarray = np.sum(errors * solved, axis=1)
    return squared


def _blocks(rolled: pd.DataFrame, block_hours: float) -> np.ndarray:
    """The block (n,) of each row: its origin, and the stretch of time behind it."""
    stretch = np.floor(rolled["age"] / (HOUR * block_hours))
    blocks: np.ndarray = rolled.groupby([rolled["origin"], stretch], sort=True).ngroup().to_numpy()
    return blocks


def _quantile(scores: np.ndarray, block: np.ndarray, level: float) -> float:
    """Quantile of the scores with one vote per block; at levels that need more blocks, the largest score."""
    blocks = len(np.unique(block))
    return grouped_quantile(scores, block, level=min(level, blocks / (blocks + 1.0)))


def _spread(
    duration: np.ndarray, age: np.ndarray, residual: np.ndarray, block: np.ndarray, bin_hours: float
) -> Spread:
    centre, scale = duration_scale(duration, residual, bin_hours=bin_hours)
    scaled = np.abs(residual) / np.interp(duration, centre, scale)
    growth = growth_of(scaled, age)
    scores = scaled / (1.0 + growth * age / DAY)
    factor = {level: _quantile(scores, block, level) for level in LEVELS}
    return Spread(centre, scale, growth, factor)


def duration_scale(
    duration: np.ndarray, residual: np.ndarray, *, bin_hours: float
) -> tuple[np.ndarray, np.ndarray]:
    """Mean duration [s] of bins, and the size that the share MAIN of their residuals stays below, never zero.

    A bin holds its upper end, so that the longest predictions of all make none of their own.
    """
    bins = np.unique(np.ceil(duration / (HOUR * bin_hours)), return_inverse=True)[1]
    members = [bins == k for k in range(bins.max() + 1)]
    centre = np.array([duration[member].mean() for member in members])
    scale = np.array([np.quantile(np.abs(residual[member]), MAIN) for member in members])
    return centre, np.maximum(scale, 1e-6 * scale.max() or 1.0)


def growth_of(scaled: np.ndarray, age: np.ndarray) -> float:
    """Growth of scaled residuals (n,) by age (n,) [s], per day; 0 where they do not grow.

    From a line through the share MAIN of each day of age, by least absolute deviations, by its start.
    """
    day = np.unique(np.floor(age / DAY), return_inverse=True)[1]
    size = np.array([np.quantile(scaled[day == k], MAIN) for k in range(day.max() + 1)])
    middle = np.bincount(day, age / DAY) / np.bincount(day)
    start, slope = least_absolute_deviations(np.stack([np.ones_like(middle), middle], axis=1), size)
    # A line that starts below the first day's size at nothing has no start to be relative to.
    return float(max(slope, 0.0) / max(start, 0.1 * size.mean()))
