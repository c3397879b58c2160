"""How errors grow with the prediction duration: medians and 95th percentiles of their size."""

from collections.abc import Sequence

import numpy as np
import pandas as pd

from opml.base.constants import DAY

QUANTILES = (0.5, 0.95)
"""The size that half of the errors, and that 95 % of them, stay below."""

REACH_DAYS = 0.25
"""Durations this near to a day are taken for it [days]: six hours to either side."""


def at_days(evaluation: pd.DataFrame, days: Sequence[float]) -> pd.DataFrame:
    """Sizes of the errors of an `evaluation` table near some prediction durations [days].

    One row per day that has rows: day, rows, before_50, before_95, after_50, after_95 in the table's unit.
    """
    size = evaluation[["true", "residual"]].abs().set_axis(["before", "after"], axis=1)
    found = []
    for day in days:
        near = (evaluation["duration"] / DAY - day).abs() <= REACH_DAYS
        if near.any():
            found.append({"day": day, "rows": int(near.sum())} | _quantiles(size[near]))
    return pd.DataFrame(found)


def by_duration(evaluation: pd.DataFrame, *, width_days: float) -> pd.DataFrame:
    """The same in bins of the duration: at the mean duration [days] of each bin's rows."""
    size = evaluation[["true", "residual"]].abs().set_axis(["before", "after"], axis=1)
    days = evaluation["duration"] / DAY
    found = []
    # A bin holds its upper end, so that the longest predictions of all make none of their own.
    for _, rows in size.groupby(np.ceil(days / width_days)):
        found.append({"day": float(days[rows.index].mean()), "rows": len(rows)} | _quantiles(rows))
    return pd.DataFrame(found)


def _quantiles(size: pd.DataFrame) -> dict[str, float]:
    return {
        f"{name}_{100.0 * quantile:.0f}": float(np.quantile(size[name], quantile))
        for name in size
        for quantile in QUANTILES
    }
