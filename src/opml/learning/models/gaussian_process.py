"""Gaussian process regression on a subsample of the rows, with a squared-exponential kernel and noise.

Source: Rasmussen & Williams 2006, Gaussian Processes for Machine Learning, ch. 2 and 5; scikit-learn finds
the kernel's numbers by the marginal likelihood.
"""

import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Self

import numpy as np
import pandas as pd
from threadpoolctl import threadpool_limits

from opml.base.seeds import derive
from opml.base.setting_types import Count
from opml.learning.models.contract import CHOICE, Learner, Metadata, Settings
from opml.learning.models.gaussian_kernel import expansion, vector_table
from opml.learning.models.inputs import checked, checked_target, standardisation, subsample
from opml.tables import real

if TYPE_CHECKING:
    from sklearn.gaussian_process import GaussianProcessRegressor

_SCALARS = ("length", "offset", "y_scale", "amplitude", "noise", "rows", "seed")


@dataclass(frozen=True, eq=False)
class GaussianProcessModel:
    """Posterior mean f(x) = offset + y_scale sum_k weight_k exp(-|z - v_k|^2 / (2 length^2)).

    v_k are the subsample's rows and z the variables x, both standardised by x_mean and x_scale.
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
        """Predicted target (n,) in its own unit; raises InputError as `checked` does."""
        x = checked(x, self.variables)
        width = np.sqrt(2.0) * self.length
        z = (x - self.x_mean) / (self.x_scale * width)
        predicted = expansion(z, self.vectors / width, self.weight)
        return self.offset + self.y_scale * predicted

    def to_table(self) -> tuple[pd.DataFrame, dict[str, Any]]:
        """One row per row of the subsample, and metadata of JSON-able values."""
        table = pd.DataFrame(self.vectors, columns=list(self.variables))
        table.insert(0, "weight", self.weight)
        metadata = {
            "kind": "gaussian",
            "variables": list(self.variables),
            "x_mean": self.x_mean.tolist(),
            "x_scale": self.x_scale.tolist(),
        }
        return table, metadata | {name: getattr(self, name) for name in _SCALARS}

    @classmethod
    def from_table(cls, table: pd.DataFrame, metadata: Metadata) -> Self:
        """The model that `to_table` wrote, bit for bit."""
        return cls(
            variables=tuple(metadata["variables"]),
            vectors=table[list(metadata["variables"])].to_numpy(dtype=float),
            weight=table["weight"].to_numpy(dtype=float),
            x_mean=np.array(metadata["x_mean"], dtype=float),
            x_scale=np.array(metadata["x_scale"], dtype=float),
            **{name: metadata[name] for name in _SCALARS},
        )


def fit(
    x: np.ndarray,
    y: np.ndarray,
    *,
    variables: Sequence[str],
    settings: Settings,
    seed: int,
    groups: np.ndarray | None = None,
    weights: np.ndarray | None = None,
) -> GaussianProcessModel:
    """Train on at most `settings['rows']` of the rows x (n, variables), y (n,), drawn with the seed.

    The process finds one noise for all rows, so that weights are not used. Raises InputError for too few
    rows or values that are not finite.
    """
    x = checked(x, variables)
    y = checked_target(y, len(x), least=2)
    drawn = subsample(len(x), settings["rows"], derive(seed, "gaussian_process", "rows"))
    mean, scale = standardisation(x, settings)
    z, offset, y_scale = (x[drawn] - mean) / scale, float(y.mean()), float(y.std()) or 1.0
    with threadpool_limits(limits=1), warnings.catch_warnings():
        warnings.simplefilter("ignore")  # a number at its bound is an answer too
        machine = _machine().fit(z, (y[drawn] - offset) / y_scale)
    amplitude, length = machine.kernel_.k1.k1.constant_value, machine.kernel_.k1.k2.length_scale
    return GaussianProcessModel(
        variables=tuple(variables),
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
        seed=seed,
    )


def _machine() -> "GaussianProcessRegressor":
    # Imported only to train: it takes a second, more than most models need to predict.
    from sklearn.gaussian_process import GaussianProcessRegressor
    from sklearn.gaussian_process.kernels import RBF, ConstantKernel, WhiteKernel

    function = ConstantKernel(1.0, (1e-3, 1e5)) * RBF(3.0, (1e-1, 1e3))
    return GaussianProcessRegressor(function + WhiteKernel(0.1, (1e-6, 1e1)))


LEARNER = Learner(
    kind="gaussian",
    description="Gaussian process",
    settings={**CHOICE, "rows": Count},
    table=vector_table("a row learned from", real("weight", "1", "weight of the row's kernel")),
    fit=fit,
    load=GaussianProcessModel.from_table,
)
