"""No correction, and what a well-run catalogue does without learning: laws without a number of their own.

A catalogue fits over longer windows, or takes the mean of its past Cd.
P_ML then says what the catalogue itself would leave of the errors of its short fits.
"""

from dataclasses import dataclass
from typing import Any, ClassVar, Self

import numpy as np
import pandas as pd

from opml.base.setting_types import Positive
from opml.learning.models.contract import Learner, LearnerSettings, Metadata, describe, restore, table_of
from opml.learning.models.training_inputs import Training, check_rows


@dataclass(frozen=True, eq=False)
class FixedLaw:
    """Predicts 0 (no variable), `x0` (one) or `x0 + x1 * (x2 - x3)` (four)."""

    kind: str
    variables: tuple[str, ...]

    def predict(self, x: np.ndarray) -> np.ndarray:
        """Return the predicted error (n,) in its own unit; raise InputError as `check_rows` does."""
        x = check_rows(x, self.variables)
        if len(self.variables) < 2:
            return x.sum(axis=1)
        difference, answer, cd, past = x.T
        return difference + answer * (cd - past)

    def to_table(self) -> tuple[pd.DataFrame, dict[str, Any]]:
        """Return an empty table, and the law's metadata."""
        return pd.DataFrame(), describe(self, self.kind)

    @classmethod
    def from_table(cls, _: pd.DataFrame, metadata: Metadata) -> Self:
        """Return the law that `to_table` wrote."""
        return cls(metadata["kind"], **restore(metadata))


class WindowSettings(LearnerSettings):
    columns: ClassVar[tuple[str, ...]] = ("l_arc",)

    window_hours: Positive


class RunningSettings(WindowSettings):
    columns: ClassVar[tuple[str, ...]] = ("l_arc", "v_arc", "cd_arc", "cd_past")

    memory_days: Positive


def _law(
    kind: str, description: str, settings: type[LearnerSettings] = LearnerSettings
) -> Learner[LearnerSettings]:
    """Return the learner of a law."""

    def fit(training: Training, _: LearnerSettings) -> FixedLaw:
        check_rows(training.x, training.variables)
        return FixedLaw(kind, tuple(training.variables))

    return Learner(
        kind=kind,
        description=description,
        settings=settings,
        table=table_of("nothing: there is no number to keep"),
        fit=fit,
        load=FixedLaw.from_table,
        learns=False,
    )


NONE = _law("none", "no correction")


REFITTED = _law("refitted", "fit over another window, nothing learned", WindowSettings)

RUNNING = _law(
    "running",
    "law without a truth: l_arc + v_arc (cd_arc - cd_past), with the running mean of Cd",
    RunningSettings,
)
