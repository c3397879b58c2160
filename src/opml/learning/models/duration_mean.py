"""The mean error of the training rows by prediction duration, which any learner has to beat."""

from dataclasses import dataclass
from typing import Any, Self

import numpy as np
import pandas as pd

from opml.base.constants import HOUR
from opml.base.setting_types import Positive
from opml.learning.models.contract import Learner, LearnerSettings, Metadata, fixed, table_of
from opml.learning.models.metadata import describe, restore
from opml.learning.models.training_inputs import Training, check_rows
from opml.tables import real

KIND = "durationmean"


@dataclass(frozen=True, eq=False)
class DurationMean:
    """Predicts the mean error of the training rows of about the same prediction duration.

    Source: Rivera & Bai 2016, as the paper cites it (sec. Results on Simulated RSO).
    """

    variables: tuple[str, ...]
    duration: np.ndarray  # (bins,) mean duration of a bin's rows [s], ascending
    mean: np.ndarray  # (bins,) their mean error

    def predict(self, x: np.ndarray) -> np.ndarray:
        """Return the mean error (n,) at durations x (n, 1) [s].

        It is linear between the bins and constant past the ends.
        """
        durations = check_rows(x, self.variables)[:, 0]
        return np.interp(durations, self.duration, self.mean)

    def to_table(self) -> tuple[pd.DataFrame, dict[str, Any]]:
        """Return a table with one row per bin, and the model's metadata."""
        return pd.DataFrame({"duration": self.duration, "mean": self.mean}), describe(self, KIND)

    @classmethod
    def from_table(cls, table: pd.DataFrame, metadata: Metadata) -> Self:
        """Return the model that `to_table` wrote, bit for bit."""
        columns = {name: table[name].to_numpy() for name in ("duration", "mean")}
        return cls(**restore(metadata), **columns)


class DurationMeanSettings(LearnerSettings):
    bin_hours: Positive


def fit(training: Training, settings: DurationMeanSettings) -> DurationMean:
    """Average the target in bins of x (n, 1), the duration [s].

    Raises InputError for values that are not finite.
    """
    training = training.validate(least=1)
    duration = training.x[:, 0]
    bins = np.unique(np.floor(duration / (HOUR * settings.bin_hours)), return_inverse=True)[1]
    weights = training.row_weights()
    total = np.bincount(bins, weights)
    centre, mean = (np.bincount(bins, weights * values) / total for values in (duration, training.y))
    return DurationMean(tuple(training.variables), centre, mean)


LEARNER = Learner(
    kind=KIND,
    description="mean error by duration (Rivera & Bai 2016)",
    settings=DurationMeanSettings,
    table=table_of(
        "a bin of prediction durations",
        real("duration", "s", "mean duration of the bin's rows"),
        real("mean", "SI", "their mean error (m or m/s)", "RSW"),
    ),
    fit=fit,
    load=DurationMean.from_table,
    resolve=fixed("duration"),
)
