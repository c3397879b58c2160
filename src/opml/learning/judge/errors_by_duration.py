"""Growth of errors with the prediction duration: medians and 95th percentiles of their size."""

from collections.abc import Sequence

import numpy as np
import pandas as pd

from opml.base.constants import DAY

_QUANTILES = (0.5, 0.95)  # shares of the errors that stay below the sizes returned
REACH_DAYS = 0.25  # a prediction counts for a duration that it misses by no more than this [days]: six hours


def at_days(evaluation: pd.DataFrame, days: Sequence[float]) -> pd.DataFrame:
    """Return sizes of the errors of an `evaluation` table near prediction durations.

    days: the durations [days]

    One row per day with predictions: day, rows, before_50, before_95, after_50, after_95 in the table's unit.
    """
    size = evaluation[["true", "residual"]].abs().set_axis(["before", "after"], axis=1)
    sizes = []
    for day in days:
        near = (evaluation["duration"] / DAY - day).abs() <= REACH_DAYS
        if near.any():
            sizes.append({"day": day, "rows": int(near.sum())} | _quantiles(size[near]))
    return pd.DataFrame(sizes)


def by_duration(evaluation: pd.DataFrame, *, width_days: float) -> pd.DataFrame:
    """Return the table of `at_days` for bins of the duration, each at its mean duration [days]."""
    size = evaluation[["true", "residual"]].abs().set_axis(["before", "after"], axis=1)
    days = evaluation["duration"] / DAY
    sizes = []
    # A bin holds its upper end, so that the longest predictions make no bin of their own.
    for _, rows in size.groupby(np.ceil(days / width_days)):
        sizes.append({"day": float(days[rows.index].mean()), "rows": len(rows)} | _quantiles(rows))
    return pd.DataFrame(sizes)


def _quantiles(size: pd.DataFrame) -> dict[str, float]:
    return {
        f"{name}_{100.0 * quantile:.0f}": float(np.quantile(size[name], quantile))
        for name in size
        for quantile in _QUANTILES
    }
