"""Gaussian process regression on a subsample of the rows, with a squared-exponential kernel and noise.

scikit-learn finds the parameters of the kernel by the marginal likelihood.

Source: Rasmussen & Williams 2006, Gaussian Processes for Machine Learning, ch. 2 and 5.
"""

import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Self

import numpy as np
import pandas as pd
from threadpoolctl import threadpool_limits

from opml.base.seeds import derive
from opml.base.setting_types import Count
from opml.learning.models.contract import CHOICE, Learner, Metadata, Settings
from opml.learning.models.gaussian_kernel import expansion, vector_rows, vector_table
from opml.learning.models.inputs import Training, check_rows, subsample
from opml.learning.models.metadata import describe, restore
from opml.tables import real

if TYPE_CHECKING:
    from sklearn.gaussian_process import GaussianProcessRegressor

KIND = "gaussian"
_FIELDS = ("x_mean", "x_scale", "length", "offset", "y_scale", "amplitude", "noise", "rows", "seed")


@dataclass(frozen=True, eq=False)
class GaussianProcessModel:
    """Posterior mean f(x) = offset + y_scale sum_k weight_k exp(-|z - v_k|^2 / (2 length^2)).

    v_k are the rows of the subsample and z the variables x, both standardised by x_mean and x_scale.
    """

    variables: tuple[str, ...]
    vectors: np.ndarray  # (rows, variables), standardised
    weight: np.ndarray  # (rows,), of the scaled target
    x_mean: np.ndarray  # (variables,)
    x_scale: np.ndarray  # (variables,)
    length: float
    offset: float  # in the target's unit
    y_scale: float
    amplitude: float  # standard deviation of the function, of the scaled target
    noise: float  # standard deviation of the noise, of the scaled target
    rows: int
    seed: int

    def predict(self, x: np.ndarray) -> np.ndarray:
        """Return the predicted target (n,) in its own unit; raise InputError as `check_rows` does."""
        x = check_rows(x, self.variables)
        width = np.sqrt(2.0) * self.length
        z = (x - self.x_mean) / (self.x_scale * width)
        predicted = expansion(z, self.vectors / width, self.weight)
        return self.offset + self.y_scale * predicted

    def to_table(self) -> tuple[pd.DataFrame, dict[str, Any]]:
        """Return a table with one row per row of the subsample, and the model's metadata."""
        return vector_rows(self.vectors, self.variables, weight=self.weight), describe(self, KIND, *_FIELDS)

    @classmethod
    def from_table(cls, table: pd.DataFrame, metadata: Metadata) -> Self:
        """Return the model that `to_table` wrote, bit for bit."""
        return cls(
            vectors=table[list(metadata["variables"])].to_numpy(dtype=float),
            weight=table["weight"].to_numpy(dtype=float),
            **restore(metadata, *_FIELDS),
        )


def fit(training: Training, settings: Settings) -> GaussianProcessModel:
    """Train on at most `settings['rows']` of the rows, drawn with the seed.

    The process has one noise for all rows, so weights are not used. Raises InputError for too few rows or
    values that are not finite.
    """
    training = training.validate(least=2)
    x, y = training.x, training.y
    drawn = subsample(len(x), settings["rows"], derive(training.seed, "gaussian_process", "rows"))
    mean, scale = training.standardisation()
    z, offset, y_scale = (x[drawn] - mean) / scale, float(y.mean()), float(y.std()) or 1.0
    with threadpool_limits(limits=1), warnings.catch_warnings():
        warnings.simplefilter("ignore")  # a parameter at its bound is a result too
        machine = _machine().fit(z, (y[drawn] - offset) / y_scale)
    amplitude, length = machine.kernel_.k1.k1.constant_value, machine.kernel_.k1.k2.length_scale
    return GaussianProcessModel(
        variables=tuple(training.variables),
        vectors=z,
        weight=amplitude * np.ravel(machine.alpha_),
        x_mean=mean,
        x_scale=scale,
        length=float(length),
        offset=offset,
        y_scale=y_scale,
        amplitude=float(np.sqrt(amplitude)),
        noise=float(np.sqrt(machine.kernel_.k2.noise_level)),
        rows=len(drawn),
        seed=training.seed,
    )


def _machine() -> "GaussianProcessRegressor":
    # Imported only to train: it takes a second, more than most models need to predict.
    from sklearn.gaussian_process import GaussianProcessRegressor
    from sklearn.gaussian_process.kernels import RBF, ConstantKernel, WhiteKernel

    function = ConstantKernel(1.0, (1e-3, 1e5)) * RBF(3.0, (1e-1, 1e3))
    return GaussianProcessRegressor(function + WhiteKernel(0.1, (1e-6, 1e1)))


LEARNER = Learner(
    kind=KIND,
    description="Gaussian process",
    settings={**CHOICE, "rows": Count},
    table=vector_table("a row learned from", real("weight", "1", "weight of the row's kernel")),
    fit=fit,
    load=GaussianProcessModel.from_table,
)
