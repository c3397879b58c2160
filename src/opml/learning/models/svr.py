"""Support vector regression with a Gaussian kernel, with the defaults of MATLAB's fitrsvm.

fitrsvm (Statistics and Machine Learning Toolbox, its reference page) standardises the variables and takes,
for a target y, C = iqr(y)/1.349, epsilon = iqr(y)/13.49 and the KKT tolerance 1e-3. Here the target is
divided by S = iqr(y)/1.349 instead. Dividing the primal objective by S^2 shows that C = 1 and epsilon = 0.1
on the scaled target give the same function. The tolerance then means the same for metres and for metres per
second.
"""

from dataclasses import dataclass, replace
from typing import Annotated, Any, Self

import numpy as np
import pandas as pd

from opml.base.seeds import derive
from opml.base.setting_types import Expected, NotNegative, OneOf, Positive
from opml.learning.data.cleaning import quartiles
from opml.learning.models.contract import ChoosingSettings, Learner, Metadata, describe, restore
from opml.learning.models.gaussian_kernel import QUANTILES, distance_quantile, expansion
from opml.learning.models.training_inputs import Training, check_rows, standardisation
from opml.tables import Schema, real

NORMAL_IQR = 1.349  # interquartile range of the standard normal distribution
MIN_ROWS = 2  # a standard deviation needs two

KIND = "svr"
_FIELDS = (
    *("offset", "kernel_scale", "kernel_rule", "x_mean", "x_scale", "y_scale"),
    *("c", "epsilon", "tol", "iterations", "seed"),
)


@dataclass(frozen=True, eq=False)
class SvrModel:
    """A trained model, f(x) = y_scale (sum_k dual_coef_k k(v_k, z) + offset).

    v_k are the support vectors and z the variables x standardised by x_mean and x_scale.
    """

    variables: tuple[str, ...]
    support_vectors: np.ndarray  # (vectors, variables), standardised
    dual_coef: np.ndarray  # (vectors,), alpha - alpha*, of the scaled target
    offset: float  # of the scaled target
    kernel_scale: float
    kernel_rule: str
    x_mean: np.ndarray  # (variables,)
    x_scale: np.ndarray  # (variables,)
    y_scale: float
    c: float
    epsilon: float
    tol: float
    iterations: int
    seed: int

    def predict(self, x: np.ndarray) -> np.ndarray:
        """Return the predicted target (n,) in its own unit; raise InputError as `check_rows` does."""
        x = check_rows(x, self.variables)
        z = (x - self.x_mean) / (self.x_scale * self.kernel_scale)
        predicted = expansion(z, self.support_vectors / self.kernel_scale, self.dual_coef)
        return self.y_scale * (predicted + self.offset)

    def to_table(self) -> tuple[pd.DataFrame, dict[str, Any]]:
        """Return a table with one row per support vector, and the model's metadata."""
        vectors = pd.DataFrame(self.support_vectors, columns=list(self.variables))
        return pd.DataFrame({"dual_coef": self.dual_coef}).join(vectors), describe(self, KIND, *_FIELDS)

    @classmethod
    def from_table(cls, table: pd.DataFrame, metadata: Metadata) -> Self:
        """Return the model that `to_table` wrote, bit for bit."""
        return cls(
            support_vectors=table[list(metadata["variables"])].to_numpy(dtype=float),
            dual_coef=table["dual_coef"].to_numpy(dtype=float),
            **restore(metadata, *_FIELDS),
        )


class SvrSettings(ChoosingSettings):
    """Settings of a machine."""

    kernel_scale: Annotated[
        Annotated[str, OneOf(tuple(QUANTILES))] | Positive, Expected("sigest, median or a number above 0")
    ]
    c: Positive
    epsilon: NotNegative
    tol: Positive


def fit(training: Training, settings: SvrSettings) -> SvrModel:
    """Train a machine; raise InputError for too few rows or values that are not finite."""
    training = training.validate(least=MIN_ROWS)
    x_mean, x_scale = standardisation(training.x)
    z = (training.x - x_mean) / x_scale
    q1, q3 = quartiles(training.y)
    y_scale = (q3 - q1) / NORMAL_IQR if q3 > q1 else 1.0  # fitrsvm falls back to C = 1, epsilon = 0.1 as well

    scaled = replace(training, x=z, y=training.y / y_scale)
    scale = _kernel_scale(scaled, settings)
    beta, offset, steps = _solve(scaled, scale, settings)
    support = beta != 0.0
    return SvrModel(
        variables=tuple(training.variables),
        support_vectors=z[support],
        dual_coef=beta[support],
        offset=offset,
        kernel_scale=scale,
        kernel_rule=str(settings.kernel_scale),
        x_mean=x_mean,
        x_scale=x_scale,
        y_scale=y_scale,
        c=settings.c,
        epsilon=settings.epsilon,
        tol=settings.tol,
        iterations=steps,
        seed=training.seed,
    )


def _kernel_scale(scaled: Training, settings: SvrSettings) -> float:
    rule, rng = settings.kernel_scale, derive(scaled.seed, "svr", "kernel_scale")
    if rule in QUANTILES:
        return distance_quantile(scaled.x, QUANTILES[rule], rng=rng)
    return float(rule)


def _solve(scaled: Training, scale: float, settings: SvrSettings) -> tuple[np.ndarray, float, int]:
    """Solve for standardised rows and the scaled target; the root of a weight scales the limit of its row."""
    # Imported only to train: it brings Numba, which takes longer to start than most models to predict.
    from opml.learning.models import smo

    limits = settings.c * np.sqrt(scaled.row_weights())
    epsilon, tol = settings.epsilon, settings.tol
    return smo.solve(scaled.x / scale, scaled.y, limits, epsilon=epsilon, tol=tol)


def _table(metadata: Metadata) -> Schema:
    vector = (real(name, "1", f"{name}, standardised") for name in metadata["variables"])
    weight = real("dual_coef", "1", "dual coefficient alpha - alpha*")
    return Schema(f"model_{KIND}", "a support vector", (weight, *vector))


LEARNER = Learner(
    kind=KIND,
    description="SVR, as in the paper",
    settings=SvrSettings,
    table=_table,
    fit=fit,
    load=SvrModel.from_table,
)
