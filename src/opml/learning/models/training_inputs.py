"""Training data of a learner: rows of learning variables and a target, checked and standardised."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
import pandas as pd

from opml.base.errors import InputError


@dataclass(frozen=True, eq=False)
class Training:
    """Rows to train on, in their own units.

    weights: (n,) inverse variances of the target, up to a factor; None where all rows weigh the same. A
        squared loss takes them as they are, an absolute loss takes their roots.
    """

    x: np.ndarray  # (n, variables)
    y: np.ndarray  # (n,) the target
    variables: Sequence[str]  # names of the columns of x
    seed: int  # of the learner's draws
    weights: np.ndarray | None = None

    @classmethod
    def from_rows(cls, rows: pd.DataFrame, variables: Sequence[str], *, component: str, seed: int) -> Self:
        """Take rows of a dataset and one error component as the target.

        Labels from later estimates are weighted by their own uncertainty. Raises InputError for a variable
        that the rows do not have.
        """
        sigma = rows.get(f"sigma_{component}")
        return cls(
            columns_of(rows, variables),
            rows[component].to_numpy(),
            variables,
            seed,
            weights=None if sigma is None else inverse_variances(sigma.to_numpy()),
        )

    def validate(self, *, least: int) -> Self:
        """Return the training with x and y as floats.

        Raises InputError for fewer rows than `least`, another shape, or values that are not finite.
        """
        x = check_rows(self.x, self.variables)
        return replace(self, x=x, y=_check_target(self.y, len(x), least=least))

    def row_weights(self) -> np.ndarray:
        """Return weights (n,), ones where all rows weigh the same."""
        return np.ones(len(self.x)) if self.weights is None else np.asarray(self.weights, dtype=float)


def columns_of(rows: pd.DataFrame, variables: Sequence[str]) -> np.ndarray:
    """Return learning variables (n, variables) of rows; raise InputError for one that they do not have."""
    for name in variables:
        if name not in rows:
            raise InputError(f"learning variable {name}: expected it in a dataset or another table, got none")
    return rows[list(variables)].to_numpy()


def check_rows(x: np.ndarray, variables: Sequence[str]) -> np.ndarray:
    """Return rows x (n, variables) as floats.

    Raises InputError for another shape or a value that is not finite.
    """
    x = np.asarray(x, dtype=float)
    if x.ndim != 2 or x.shape[1] != len(variables):
        raise InputError(
            f"learning variables: expected {len(variables)} columns, got an array of shape {x.shape}"
        )
    finite = np.isfinite(x).all(axis=0)
    if not finite.all():
        raise InputError(
            f"learning variable {variables[int(np.argmin(finite))]}: expected finite values only"
        )
    return x


def _check_target(y: np.ndarray, count: int, *, least: int) -> np.ndarray:
    """Return y (count,) as floats; raise InputError for fewer than `least`, or one that is not finite."""
    y = np.asarray(y, dtype=float)
    if count < least:
        raise InputError(f"training rows: expected at least {least}, got {count}")
    if y.shape != (count,) or not np.all(np.isfinite(y)):
        raise InputError(f"target: expected {count} finite values, got {np.count_nonzero(np.isfinite(y))}")
    return y


def inverse_variances(sigma: np.ndarray) -> np.ndarray:
    """Return weights (n,) of targets with uncertainties sigma (n,): 2 m / (m + sigma^2), m = median(sigma^2).

    A target of typical uncertainty weighs 1, an exact target 2, a useless target 0. What a model leaves is
    more than the noise of the best labels, so these must not outweigh all others.
    """
    variance = sigma**2
    typical = float(np.median(variance))
    return 2.0 * typical / (typical + variance) if typical > 0.0 else np.ones(len(sigma))


def standardisation(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return mean and sample deviation (variables,) of rows x; 1 for a variable that never changes."""
    mean, scale = x.mean(axis=0), x.std(axis=0, ddof=1)
    # A variable that never changes carries no information. Scale 1 keeps it at zero, also in later rows if
    # it stays the same. Its computed deviation may be rounding noise instead of 0, hence the test on the
    # range.
    scale[np.ptp(x, axis=0) == 0.0] = 1.0
    return mean, scale


def subsample(count: int, limit: int, rng: np.random.Generator) -> np.ndarray:
    """Return at most `limit` of the row numbers 0 to count - 1, ascending."""
    if count <= limit:
        return np.arange(count)
    return np.sort(rng.choice(count, limit, replace=False))
