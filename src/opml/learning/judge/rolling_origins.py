"""A learner as an operator runs it: trained anew at intervals on what is known, for the predictions ahead.

The learner of a day is trained on labels that are known when the day begins. It corrects the predictions that
start on that day, whenever they end. So all that it is trained on is over before it predicts.
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
    """When a learner is trained anew, in days."""

    days: tuple[float, float]  # first and last day of the predictions to correct
    every_days: float  # time between trainings
    last_days: float  # length of the past to train on

    @property
    def begins(self) -> np.ndarray:
        """Times of training (n,) [days], the first day included."""
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
    """Return the `rolling` table: kept rows of a dataset, corrected by the newest model.

    train: makes a model from rows of a dataset
    learned: dataset to train on
    judge: dataset of the same pairs, whose rows with t_i in the days are corrected

    `predicted_once` is the prediction of the model of the first day. A day without rows to test is left out.
    Raises InputError where nothing is known yet to train on, and where no row is tested.
    """
    once = train(learned[_known(learned, rolling.days[0], rolling)])
    parts = []
    for begin in rolling.begins:
        end = min(begin + rolling.every_days, rolling.days[1])
        rows = judge["keep"].to_numpy() & in_days(judge["t_i"].to_numpy(), (begin, end))
        if rows.any():
            known = _known(learned, begin, rolling)
            part = evaluate(train(learned[known]), judge, rows, component=component)
            single = evaluate(once, judge, rows, component=component)["predicted"]
            parts.append(part.assign(day=begin, trained=int(known.sum()), predicted_once=single))
    if not parts:
        first, last = rolling.days
        raise InputError(f"rolling: expected kept predictions from days {first:g} to {last:g}, got none")
    return pd.concat(parts, ignore_index=True)


def by_day(table: pd.DataFrame) -> pd.DataFrame:
    """Return P_ML [%] of a `rolling` table by day, trained anew (`anew`) and once (`once`), with its rows."""
    days = [
        {
            "day": day,
            "rows": len(rows),
            "anew": p_ml(rows["true"].to_numpy(), rows["predicted"].to_numpy()),
            "once": p_ml(rows["true"].to_numpy(), rows["predicted_once"].to_numpy()),
        }
        for day, rows in table.groupby("day", sort=True)
    ]
    return pd.DataFrame(days)


def _known(dataset: pd.DataFrame, begin: float, rolling: Rolling) -> np.ndarray:
    """Return kept rows (bool, n) of the last days whose error is known when a day begins."""
    within = in_days(dataset["t_j"].to_numpy(), (begin - rolling.last_days, begin))
    rows: np.ndarray = dataset["keep"].to_numpy() & within & (known_at(dataset) <= begin * DAY)
    if not rows.any():
        raise InputError(f"rolling: expected errors that are known by day {begin:g} to train on, got none")
    return rows
