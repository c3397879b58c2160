"""Growth of errors with the prediction duration: medians and 95th percentiles of their size."""

from collections.abc import Sequence

import pandas as pd

from opml.base.constants import DAY

_QUANTILES = (0.5, 0.95)  # shares of the errors that stay below the sizes returned
REACH_DAYS = 0.25  # a prediction counts for a duration within this of its own [days]: six hours


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
            quantiles = size[near].quantile(list(_QUANTILES)).unstack()
            named = {f"{when}_{100.0 * share:.0f}": value for (when, share), value in quantiles.items()}
            sizes.append({"day": day, "rows": int(near.sum())} | named)
    return pd.DataFrame(sizes)
