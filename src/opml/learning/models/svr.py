"""Support vector regression with a Gaussian kernel, set up as MATLAB's fitrsvm is by default.

fitrsvm (Statistics and Machine Learning Toolbox, its reference page) standardises the variables and takes,
for a target y, C = iqr(y)/1.349, epsilon = iqr(y)/13.49 and the KKT tolerance 1e-3. Here the target is
divided by S = iqr(y)/1.349 instead. Dividing the primal objective by S^2 shows that C = 1 and epsilon = 0.1
on the scaled target give the same function, while the tolerance now means the same for metres and for metres
per second.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, Self

import numpy as np
import pandas as pd

from opml.base.errors import InputError
from opml.base.seeds import derive
from opml.base.setting_types import Expected, NotNegative, OneOf, Positive
from opml.learning.data.cleaning import quartiles
from opml.learning.models import kernel_scale as scales
from opml.learning.models.contract import CHOICE, Learner, Metadata, Settings
from opml.learning.models.gaussian_kernel import expansion, vector_table
from opml.learning.models.inputs import checked, checked_target, standardisation, weighing
from opml.tables import real

if TYPE_CHECKING:
    from opml.learning.models.smo import Solution

NORMAL_IQR = 1.349  # interquartile range of the standard normal distribution
MIN_ROWS = 2  # a standard deviation needs two


@dataclass(frozen=True, eq=False)
class SvrModel:
    """A fitted model, f(x) = y_scale (sum_k dual_coef_k k(v_k, z) + offset).

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
        """Predicted target (n,) in its own unit for rows x (n, variables) in theirs.

        Raises InputError for non-finite values or another number of variables.
        """
        x = checked(x, self.variables)
        z = (x - self.x_mean) / (self.x_scale * self.kernel_scale)
        predicted = expansion(z, self.support_vectors / self.kernel_scale, self.dual_coef)
        return self.y_scale * (predicted + self.offset)

    def to_table(self) -> tuple[pd.DataFrame, dict[str, Any]]:
        """The `model` table, one row per support vector, and its metadata of JSON-able values."""
        table = pd.DataFrame(self.support_vectors, columns=list(self.variables))
        table.insert(0, "dual_coef", self.dual_coef)
        metadata = {
            "kind": "svr",
            "variables": list(self.variables),
            "offset": self.offset,
            "kernel_scale": self.kernel_scale,
            "kernel_rule": self.kernel_rule,
            "x_mean": self.x_mean.tolist(),
            "x_scale": self.x_scale.tolist(),
            "y_scale": self.y_scale,
            "c": self.c,
            "epsilon": self.epsilon,
            "tol": self.tol,
            "iterations": self.iterations,
            "seed": self.seed,
        }
        return table, metadata

    @classmethod
    def from_table(cls, table: pd.DataFrame, metadata: Metadata) -> Self:
        """The model that `to_table` wrote, bit for bit."""
        scalars = ["offset", "kernel_scale", "kernel_rule", "y_scale", "c", "epsilon", "tol", "iterations"]
        return cls(
            variables=tuple(metadata["variables"]),
            support_vectors=table[list(metadata["variables"])].to_numpy(dtype=float),
            dual_coef=table["dual_coef"].to_numpy(dtype=float),
            x_mean=np.array(metadata["x_mean"], dtype=float),
            x_scale=np.array(metadata["x_scale"], dtype=float),
            **{name: metadata[name] for name in [*scalars, "seed"]},
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
) -> SvrModel:
    """Train on rows x (n, variables) and target y (n,), both in their own units.

    `settings` holds kernel_scale (`sigest`, `median`, `cv` or a number), c, epsilon and tol; `groups` (n,)
    tells which estimate a row belongs to, for `cv`. Raises InputError for too few rows, non-finite values or
    an unknown rule.
    """
    x = checked(x, variables)
    y = checked_target(y, len(x), least=MIN_ROWS)
    x_mean, x_scale = standardisation(x, settings)
    z = (x - x_mean) / x_scale
    q1, q3 = quartiles(y)
    y_scale = (q3 - q1) / NORMAL_IQR if q3 > q1 else 1.0  # fitrsvm falls back to C = 1, epsilon = 0.1 as well

    rule = settings["kernel_scale"]
    scale = _kernel_scale(rule, z, y / y_scale, groups, settings=settings, seed=seed)
    solution = _solve(z, y / y_scale, scale, settings, weights)
    support = solution.beta != 0.0
    return SvrModel(
        variables=tuple(variables),
        support_vectors=z[support],
        dual_coef=solution.beta[support],
        offset=solution.offset,
        kernel_scale=scale,
        kernel_rule=str(rule),
        x_mean=x_mean,
        x_scale=x_scale,
        y_scale=y_scale,
        c=float(settings["c"]),
        epsilon=float(settings["epsilon"]),
        tol=float(settings["tol"]),
        iterations=solution.steps,
        seed=seed,
    )


def _kernel_scale(
    rule: str | float,
    z: np.ndarray,
    y: np.ndarray,
    groups: np.ndarray | None,
    *,
    settings: Settings,
    seed: int,
) -> float:
    rng = derive(seed, "svr", "kernel_scale")
    if rule in scales.QUANTILES:
        return scales.distance_quantile(z, scales.QUANTILES[rule], rng=rng)
    if rule == "cv":
        return scales.cross_validated(
            z, y, groups, predicted=lambda *rows: _predicted(*rows, settings=settings), rng=rng
        )
    if isinstance(rule, int | float) and not isinstance(rule, bool) and 0.0 < rule < np.inf:
        return float(rule)
    raise InputError(f"kernel_scale: expected {', '.join(scales.RULES)} or a positive number, got {rule!r}")


def _solve(
    z: np.ndarray, y: np.ndarray, scale: float, settings: Settings, weights: np.ndarray | None = None
) -> "Solution":
    """Solve for standardised rows and the scaled target; the root of a weight scales its row's limit."""
    # Imported only to train: it brings Numba, which takes longer to start than most models to predict.
    from opml.learning.models import smo

    limits = float(settings["c"]) * np.sqrt(weighing(weights, len(y)))
    return smo.solve(z / scale, y, limits, epsilon=float(settings["epsilon"]), tol=float(settings["tol"]))


def _predicted(
    scale: float, z: np.ndarray, y: np.ndarray, new: np.ndarray, *, settings: Settings
) -> np.ndarray:
    """What a machine trained on z and y at this kernel scale says of new rows."""
    solution = _solve(z, y, scale, settings)
    support = solution.beta != 0.0
    return expansion(new / scale, z[support] / scale, solution.beta[support]) + solution.offset


LEARNER = Learner(
    kind="svr",
    description="SVR, as in the paper",
    settings={
        **CHOICE,
        "kernel_scale": Annotated[
            Annotated[str, OneOf(scales.RULES)] | Positive, Expected("sigest, median, cv or a number above 0")
        ],
        "c": Positive,
        "epsilon": NotNegative,
        "tol": Positive,
    },
    table=vector_table("a support vector", real("dual_coef", "1", "dual coefficient alpha - alpha*")),
    fit=fit,
    load=SvrModel.from_table,
)
