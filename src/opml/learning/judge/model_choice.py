"""The choice of the model to use next, by predictions that later measurements judged.

The model that left the least is chosen: newer errors weigh more, and errors of each day of duration have the
same weight.
"""

from collections.abc import Sequence

import numpy as np
import pandas as pd

from opml.base.constants import DAY
from opml.base.errors import InputError

MEMORY_DAYS = 8.0
"""Time in which the weight of a past error falls by e: eight days, so that predictions of a week count."""

_LEAST = 1.0  # least typical error of a day of duration [m]


def best_model(judged: pd.DataFrame, models: Sequence[str], *, now: float) -> str:
    """Return the model that left the least along the track.

    judged: rows of that table that are known at `now` [s]; predictions that all models made count

    Raises InputError where no prediction was made by all of them.
    """
    rows = judged[judged["model"].isin(models)]
    sizes = rows.assign(size=rows["e_y"].abs()).pivot(index=["i", "j"], columns="model", values="size")
    pairs = rows.groupby(["i", "j"])[["t_j", "duration"]].first()
    day, usual = np.ceil(pairs["duration"] / DAY), sizes.median(axis=1)
    typical = np.maximum(usual.groupby(day).transform("median"), _LEAST)
    weight = np.exp((pairs["t_j"] - now) / (MEMORY_DAYS * DAY)) / typical
    shared = sizes.reindex(columns=models).dropna()
    if shared.empty:
        raise InputError(f"choice: expected a prediction of all models judged by day {now / DAY:g}, got none")
    return str(shared.mul(weight[shared.index], axis=0).sum().idxmin())
