"""How wrong a corrected ephemeris is after so long, by estimates that were not learned from.

The along-track model is trained anew without a share of the estimates, and held against those. The radial and
the cross-track errors are those of the predictions themselves, so on the safe side: the radial ones without
the part that a bent path puts there, e_y^2 / 2a, which the correction takes away.
"""

from collections.abc import Callable
from statistics import NormalDist

import numpy as np
import pandas as pd

from opml.learning.contract import Model
from opml.learning.evaluation import evaluate
from opml.learning.intervals import calibrate, held_out
from opml.learning.paths import CORRECTED


def build(
    train: Callable[[pd.DataFrame], Model],
    training: pd.DataFrame,
    *,
    level: float,
    share: float,
    bin_hours: float,
    seed: int,
) -> pd.DataFrame:
    """The `residuals` table: standard deviations by duration, such that `level` of the errors lie inside.

    `train` makes an along-track model of rows of the `training` dataset, and is given all but a share of the
    estimates. The quantile is that of `intervals.calibrate`, the deviations those of a normal distribution
    with it. Raises InputError where there are too few estimates for the level.
    """
    held = held_out(training["i"].to_numpy(), share=share, seed=seed)
    left = evaluate(train(training[~held]), training, np.ones(len(training), bool), component=CORRECTED)
    bent = training["e_y"].to_numpy() ** 2 / (2.0 * training["a"].to_numpy())
    errors = {
        "x": training["e_x"].to_numpy() + bent,
        "y": left["residual"].to_numpy(),
        "z": training["e_z"].to_numpy(),
    }
    duration, groups = training["duration"].to_numpy(), training["i"].to_numpy()
    widths = {
        axis: calibrate(duration, error, groups, held, level=level, bin_hours=bin_hours)
        for axis, error in errors.items()
    }
    inside = NormalDist().inv_cdf(0.5 + 0.5 * level)
    at = widths["y"].duration
    return pd.DataFrame({"duration": at} | {f"sigma_{axis}": w.at(at) / inside for axis, w in widths.items()})


def sigmas(residuals: pd.DataFrame, duration: np.ndarray) -> np.ndarray:
    """Standard deviations (n, 3) in RSW [m] at durations (n,) [s]: linear between those of the table."""
    known = residuals["duration"].to_numpy()
    columns = [np.interp(duration, known, residuals[f"sigma_{axis}"].to_numpy()) for axis in "xyz"]
    return np.stack(columns, axis=1)
