"""Ridge regression: the linear model of the same standardised variables."""

from dataclasses import dataclass
from typing import Any, Self

import numpy as np
import pandas as pd
from threadpoolctl import threadpool_limits

from opml.base.setting_types import Positive
from opml.learning.models.contract import CHOICE, Learner, Metadata, Settings, table_of
from opml.learning.models.inputs import Training, check_rows
from opml.learning.models.metadata import describe, restore
from opml.tables import real, text

KIND = "ridge"


@dataclass(frozen=True, eq=False)
class RidgeModel:
    """f(x) = offset + sum_k coefficient_k (x_k - mean_k) / scale_k."""

    variables: tuple[str, ...]
    x_mean: np.ndarray  # (variables,)
    x_scale: np.ndarray  # (variables,)
    coefficient: np.ndarray  # (variables,) in the target's unit
    offset: float

    def predict(self, x: np.ndarray) -> np.ndarray:
        """Return the predicted target (n,) in its own unit; raise InputError as `check_rows` does."""
        z = (check_rows(x, self.variables) - self.x_mean) / self.x_scale
        predicted: np.ndarray = self.offset + np.einsum("nk,k->n", z, self.coefficient)
        return predicted

    def to_table(self) -> tuple[pd.DataFrame, dict[str, Any]]:
        """Return a table with one row per variable, and the model's metadata."""
        table = pd.DataFrame(
            {
                "variable": list(self.variables),
                "x_mean": self.x_mean,
                "x_scale": self.x_scale,
                "coefficient": self.coefficient,
            }
        )
        return table, describe(self, KIND, "offset")

    @classmethod
    def from_table(cls, table: pd.DataFrame, metadata: Metadata) -> Self:
        """Return the model that `to_table` wrote, bit for bit."""
        columns = {name: table[name].to_numpy() for name in ("x_mean", "x_scale", "coefficient")}
        return cls(**columns, **restore(metadata, "offset"))


def fit(training: Training, settings: Settings) -> RidgeModel:
    """Minimise the squared residuals plus alpha times the squared coefficients of standardised variables.

    `settings` holds alpha. Raises InputError for too few rows or values that are not finite.
    """
    training = training.validate(least=2)
    x, y, weights = training.x, training.y, training.weights
    scale = training.standardisation()[1]
    mean, offset = np.average(x, axis=0, weights=weights), float(np.average(y, weights=weights))
    root = np.sqrt(training.row_weights())
    z = root[:, None] * ((x - mean) / scale)
    with threadpool_limits(limits=1, user_api="blas"):  # sums in one order, whatever the machine
        normal = z.T @ z + settings["alpha"] * np.eye(z.shape[1])
        coefficient = np.linalg.lstsq(normal, z.T @ (root * (y - offset)))[0]
    return RidgeModel(tuple(training.variables), mean, scale, coefficient, offset)


LEARNER = Learner(
    kind=KIND,
    description="ridge regression",
    settings={**CHOICE, "alpha": Positive},
    table=table_of(
        "a learning variable",
        text("variable", "learning variable"),
        real("x_mean", "SI", "its mean"),
        real("x_scale", "SI", "its standard deviation"),
        real("coefficient", "SI", "coefficient of the standardised variable (m or m/s)", "RSW"),
    ),
    fit=fit,
    load=RidgeModel.from_table,
)
