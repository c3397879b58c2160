"""A learner retrained each morning, on the errors that are known when the day begins."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import pandas as pd

from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.learning.data.error_components import CORRECTED
from opml.learning.data.splits import are_over, in_days
from opml.learning.models import learners
from opml.learning.models.contract import Model, ResolvedSettings
from opml.learning.models.training_inputs import Training


@dataclass(frozen=True)
class DailyLearner:
    """Models of e_y by the time of their training."""

    dataset: pd.DataFrame  # labelled rows; none are needed by what learns nothing
    settings: ResolvedSettings  # of the learner, resolved
    seed: int  # of its draws
    first_day: float = 0.0  # of the rows to train on [days]
    _trained: dict[float, Model] = field(default_factory=dict, repr=False, compare=False)

    @property
    def variables(self) -> tuple[str, ...]:
        """Columns of the dataset that the models predict from."""
        return tuple(self.settings.variables)

    @property
    def arc(self) -> tuple[float, float] | None:
        """Window [h] and memory [days] of the arcs that the learner needs, None for no arcs."""
        return learners.arc_of(self.settings)

    @property
    def learns(self) -> bool:
        """Whether the learner takes anything from errors."""
        return learners.learns(self.settings.own)

    def __call__(self, now: float) -> Model:
        """Return the model as of `now` [s]; raise InputError where no error is known by then."""
        if now not in self._trained:
            self._trained[now] = learners.fit(self._training(now), self.settings)
        return self._trained[now]

    def _training(self, now: float) -> Training:
        """Return what the model as of `now` [s] learns from: rows of zeros where it learns nothing."""
        if self.learns:
            rows = self._known(now)
            return Training.from_rows(rows, self.variables, component=CORRECTED, seed=self.seed)
        return Training(np.zeros((1, len(self.variables))), np.zeros(1), self.variables, seed=self.seed)

    def _known(self, now: float) -> pd.DataFrame:
        """Return the kept rows whose error is known at `now` [s], without manoeuvres known by then."""
        within = in_days(self.dataset["t_j"].to_numpy(), (self.first_day, now / DAY))
        rows = self.dataset[self.dataset["keep"].to_numpy() & within & are_over(self.dataset, now)]
        if rows.empty:
            raise InputError(f"training: expected errors that were known by day {now / DAY:g}, got none")
        return rows


def first_day(settings: ResolvedSettings, *, window_hours: float, train_days: Sequence[float]) -> float:
    """Return the day of a learner's first morning.

    A learner that learns waits until half of the days to train on are over, any other until a window of
    tracks is full.
    """
    begin, end = train_days
    if learners.learns(settings.own):
        return float(np.ceil(begin + 0.5 * (end - begin)))
    arc = learners.arc_of(settings)
    return begin + max(window_hours, arc[0] if arc else 0.0) / 24.0
