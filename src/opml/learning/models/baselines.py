"""What any learner has to beat: no correction, the mean error by duration, re-prediction with a better Cd."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
import pandas as pd

from opml.base.constants import HOUR
from opml.base.setting_types import Positive
from opml.learning.models.contract import Learner, Metadata, Settings, fixed, table_of
from opml.learning.models.inputs import checked, checked_target, weighing
from opml.tables import real


@dataclass(frozen=True, eq=False)
class NoCorrection:
    """Predicts that there is no error: P_ML is 100 %."""

    variables: tuple[str, ...]

    def predict(self, x: np.ndarray) -> np.ndarray:
        """Zeros (n,)."""
        return np.zeros(len(x))

    def to_table(self) -> tuple[pd.DataFrame, dict[str, Any]]:
        """An empty table, and metadata of JSON-able values."""
        return pd.DataFrame(), {"kind": "none", "variables": list(self.variables)}

    @classmethod
    def from_table(cls, table: pd.DataFrame, metadata: Metadata) -> Self:
        """The model that `to_table` wrote."""
        return cls(variables=tuple(metadata["variables"]))


@dataclass(frozen=True, eq=False)
class Repredicted:
    """Predicts the error as the difference r_* to a prediction made again; nothing is learned."""

    variables: tuple[str, ...]

    def predict(self, x: np.ndarray) -> np.ndarray:
        """The one variable (n,), in the target's unit. Raises InputError as `checked` does."""
        return checked(x, self.variables)[:, 0].copy()

    def to_table(self) -> tuple[pd.DataFrame, dict[str, Any]]:
        """An empty table, and metadata of JSON-able values."""
        return pd.DataFrame(), {"kind": "repredicted", "variables": list(self.variables)}

    @classmethod
    def from_table(cls, table: pd.DataFrame, metadata: Metadata) -> Self:
        """The model that `to_table` wrote."""
        return cls(variables=tuple(metadata["variables"]))


@dataclass(frozen=True, eq=False)
class DurationMean:
    """Predicts the mean error of the training rows of about the same prediction duration.

    Source: Rivera & Bai 2016, as the paper cites it (sec. Results on Simulated RSO).
    """

    variables: tuple[str, ...]
    duration: np.ndarray  # (bins,) mean duration of a bin's rows [s], ascending
    mean: np.ndarray  # (bins,) their mean error

    def predict(self, x: np.ndarray) -> np.ndarray:
        """Mean error (n,) at durations x (n, 1) [s], linear between the bins and constant past the ends."""
        predicted: np.ndarray = np.interp(checked(x, self.variables)[:, 0], self.duration, self.mean)
        return predicted

    def to_table(self) -> tuple[pd.DataFrame, dict[str, Any]]:
        """One row per bin, and metadata of JSON-able values."""
        table = pd.DataFrame({"duration": self.duration, "mean": self.mean})
        return table, {"kind": "durationmean", "variables": list(self.variables)}

    @classmethod
    def from_table(cls, table: pd.DataFrame, metadata: Metadata) -> Self:
        """The model that `to_table` wrote, bit for bit."""
        return cls(tuple(metadata["variables"]), table["duration"].to_numpy(), table["mean"].to_numpy())


def fit_none(
    x: np.ndarray,
    y: np.ndarray,
    *,
    variables: Sequence[str],
    settings: Settings,
    seed: int,
    groups: np.ndarray | None = None,
    weights: np.ndarray | None = None,
) -> NoCorrection:
    """Nothing to train."""
    return NoCorrection(tuple(variables))


def fit_repredict(
    x: np.ndarray,
    y: np.ndarray,
    *,
    variables: Sequence[str],
    settings: Settings,
    seed: int,
    groups: np.ndarray | None = None,
    weights: np.ndarray | None = None,
) -> Repredicted:
    """Nothing to train; x holds the one variable r_* of the component."""
    checked(x, variables)
    return Repredicted(tuple(variables))


def fit_duration_mean(
    x: np.ndarray,
    y: np.ndarray,
    *,
    variables: Sequence[str],
    settings: Settings,
    seed: int,
    groups: np.ndarray | None = None,
    weights: np.ndarray | None = None,
) -> DurationMean:
    """Average the target in bins of x (n, 1), the duration [s]; `settings` holds bin_hours.

    Raises InputError for values that are not finite.
    """
    x = checked(x, variables)
    y = checked_target(y, len(x), least=1)
    bins = np.unique(np.floor(x[:, 0] / (HOUR * settings["bin_hours"])), return_inverse=True)[1]
    weights = weighing(weights, len(x))
    total = np.bincount(bins, weights)
    duration, mean = (np.bincount(bins, weights * values) / total for values in (x[:, 0], y))
    return DurationMean(tuple(variables), duration, mean)


_NOTHING = table_of("nothing: there is no number to keep")

NONE = Learner(
    kind="none",
    description="no correction",
    settings={},
    table=_NOTHING,
    fit=fit_none,
    load=NoCorrection.from_table,
    resolve=fixed(),
    learns=False,
)

REPREDICT = Learner(
    kind="repredicted",
    description="predicted again with the running mean of Cd",
    settings={},
    table=_NOTHING,
    fit=fit_repredict,
    load=Repredicted.from_table,
    resolve=fixed("r"),
    learns=False,
)

DURATION_MEAN = Learner(
    kind="durationmean",
    description="mean error by duration (Rivera & Bai 2016)",
    settings={"bin_hours": Positive},
    table=table_of(
        "a bin of prediction durations",
        real("duration", "s", "mean duration of the bin's rows"),
        real("mean", "SI", "their mean error (m or m/s)", "RSW"),
    ),
    fit=fit_duration_mean,
    load=DurationMean.from_table,
    resolve=fixed("duration"),
)
