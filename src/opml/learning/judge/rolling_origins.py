"""A learner as an operator runs it: trained anew at intervals on what is known by then, for what comes next.

The learner of a day is trained on labels known when the day begins and corrects the predictions that start
in it, whenever they end: what it is trained on is over before the prediction is made.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pandas as pd

from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.learning.data.splits import in_days, known_at
from opml.learning.judge.evaluation import evaluate
from opml.learning.judge.metrics import p_ml
from opml.learning.models.contract import Model


@dataclass(frozen=True)
class Rolling:
    """When a learner is trained anew: on which days, how often, on the labels of how many days [days]."""

    days: tuple[float, float]
    every_days: float
    last_days: float

    @property
    def begins(self) -> np.ndarray:
        """Times of training (n,) [days], the first day among them."""
        first, last = self.days
        return np.arange(first, last, self.every_days)


def roll(
    train: Callable[[pd.DataFrame], Model],
    learned: pd.DataFrame,
    judge: pd.DataFrame,
    rolling: Rolling,
    *,
    component: str,
) -> pd.DataFrame:
    """The `rolling` table: kept rows of `judge` with t_i in the days, corrected by the newest model.

    `train` makes a model of rows of the dataset `learned`, which is of the same pairs. `predicted_once` is
    what the model of the first day says, never trained again. A day without rows to test has none. Raises
    InputError where nothing is known yet to train on, and where no row is tested.
    """
    once = train(learned[_known(learned, rolling.days[0], rolling)])
    found = []
    for begin in rolling.begins:
        end = min(begin + rolling.every_days, rolling.days[1])
        rows = judge["keep"].to_numpy() & in_days(judge["t_i"].to_numpy(), (begin, end))
        if rows.any():
            known = _known(learned, begin, rolling)
            part = evaluate(train(learned[known]), judge, rows, component=component)
            single = evaluate(once, judge, rows, component=component)["predicted"]
            found.append(part.assign(day=begin, trained=int(known.sum()), predicted_once=single))
    if not found:
        first, last = rolling.days
        raise InputError(f"rolling: expected kept predictions from days {first:g} to {last:g}, got none")
    return pd.concat(found, ignore_index=True)


def by_day(table: pd.DataFrame) -> pd.DataFrame:
    """P_ML [%] of a `rolling` table by day, trained anew (`anew`) and once (`once`), with its rows."""
    days = [
        {
            "day": day,
            "rows": len(own),
            "anew": p_ml(own["true"].to_numpy(), own["predicted"].to_numpy()),
            "once": p_ml(own["true"].to_numpy(), own["predicted_once"].to_numpy()),
        }
        for day, own in table.groupby("day", sort=True)
    ]
    return pd.DataFrame(days)


def _known(dataset: pd.DataFrame, begin: float, rolling: Rolling) -> np.ndarray:
    """Kept rows (bool) of the last days whose error is known when a day begins."""
    within = in_days(dataset["t_j"].to_numpy(), (begin - rolling.last_days, begin))
    rows: np.ndarray = dataset["keep"].to_numpy() & within & (known_at(dataset) <= begin * DAY)
    if not rows.any():
        raise InputError(f"rolling: expected errors that are known by day {begin:g} to train on, got none")
    return rows
