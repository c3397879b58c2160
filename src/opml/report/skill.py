"""Skill: what a model takes off the errors that the best model without learning leaves."""

from collections.abc import Mapping
from dataclasses import dataclass

import pandas as pd

from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.learning.judge.model_choice import choose
from opml.report.results import NO_VALUE

NO_CORRECTION = "no correction"  # the row of a table whose predictions stay as they are


@dataclass(frozen=True)
class Reference:
    """The best model without learning, as skill needs it."""

    name: str  # of the model, or NO_CORRECTION
    left: float  # summed size of the errors that it leaves
    day: float | None  # end of the past that it was chosen by, None where it is known in hindsight only

    def __str__(self) -> str:
        """Return in words which model it is, and how that is known."""
        name = self.name if self.name == NO_CORRECTION else f"`{self.name}`"
        if self.day is None:
            return f"{name}, the best model without learning, which is known in hindsight only"
        return (
            f"{name}, the best model without training on this object over the mornings up to day {self.day:g}"
        )


def reference(
    left: Mapping[str, float], replays: Mapping[str, pd.DataFrame], day: float | None, *, seed: int
) -> Reference:
    """Return the best of the models without learning: by the past where that is known, else in hindsight.

    left: summed size of the errors that each leaves, NO_CORRECTION among them
    replays: `replay` tables of these models
    day: end of the training, None where it has none
    """
    if replays and day is not None:
        try:
            chosen = choose(replays, (), now=day * DAY, seed=seed).chosen
            return Reference(chosen, left[chosen], day)
        except InputError:  # no morning was over by then
            pass
    best = min(left, key=left.__getitem__)
    return Reference(best, left[best], None)


def skill(left: float, of_reference: float) -> float:
    """Return the skill [%]: 100 perfect, 0 no better than the reference, below 0 worse.

    Both arguments are summed sizes of errors; NaN where the reference leaves none.
    """
    return 100.0 * (1.0 - left / of_reference) if of_reference > 0.0 else float("nan")


def skill_cell(left: float, of_reference: float) -> str:
    """Return the skill as a cell, whole per cent."""
    value = skill(left, of_reference)
    return NO_VALUE if pd.isna(value) else f"{round(value):d}"
