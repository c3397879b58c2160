"""What a learner is given: rows of learning variables and a target, checked and standardised."""

from collections.abc import Sequence

import numpy as np
import pandas as pd

from opml.base.errors import InputError
from opml.learning.models.contract import Settings

STANDARDISED_WITH = "standardised_with"
"""Key of a learner's settings: rows (m, variables) over which its variables are standardised, too."""


def columns_of(rows: pd.DataFrame, variables: Sequence[str]) -> np.ndarray:
    """Learning variables (n, variables) of rows; raises InputError for one that they do not have."""
    for name in variables:
        if name not in rows:
            raise InputError(
                f"learning variable {name}: expected a dataset with it, or a table beside it, got none"
            )
    found: np.ndarray = rows[list(variables)].to_numpy()
    return found


def checked(x: np.ndarray, variables: Sequence[str]) -> np.ndarray:
    """Rows x (n, variables) as floats; raises InputError for another shape or a value that is not finite."""
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


def checked_target(y: np.ndarray, count: int, *, least: int) -> np.ndarray:
    """Target y (count,) as floats; raises InputError for fewer than `least` or a value that is not finite."""
    y = np.asarray(y, dtype=float)
    if count < least:
        raise InputError(f"training rows: expected at least {least}, got {count}")
    if y.shape != (count,) or not np.all(np.isfinite(y)):
        raise InputError(f"target: expected {count} finite values, got {np.count_nonzero(np.isfinite(y))}")
    return y


def inverse_variances(sigma: np.ndarray) -> np.ndarray:
    """Weights (n,) of targets of known uncertainty: 2 m / (m + sigma^2), with m the median of sigma^2.

    A target of typical uncertainty weighs 1, an exact one 2, a useless one nothing: what a model leaves is
    more than the noise of the best labels, so that these must not outweigh all others.
    """
    variance = sigma**2
    typical = float(np.median(variance))
    weights: np.ndarray = 2.0 * typical / (typical + variance) if typical > 0.0 else np.ones(len(sigma))
    return weights


def weighing(weights: np.ndarray | None, count: int) -> np.ndarray:
    """Weights (count,), ones where none are given."""
    return np.ones(count) if weights is None else np.asarray(weights, dtype=float)


def standardisation(x: np.ndarray, settings: Settings | None = None) -> tuple[np.ndarray, np.ndarray]:
    """Mean and sample deviation (variables,) of rows x; 1 for a variable that never changes.

    Rows that a learner's `settings` have under `STANDARDISED_WITH` count, too.
    """
    if settings and STANDARDISED_WITH in settings:
        x = np.vstack([x, settings[STANDARDISED_WITH]])
    mean, scale = x.mean(axis=0), x.std(axis=0, ddof=1)
    # A variable that never changes tells nothing; scale 1 keeps it at zero, in later rows too if it stays
    # there. Its computed deviation may be rounding noise instead of 0, hence the test on the range.
    scale[np.ptp(x, axis=0) == 0.0] = 1.0
    return mean, scale


def subsample(count: int, limit: int, rng: np.random.Generator) -> np.ndarray:
    """At most `limit` of the row numbers 0 to count - 1, ascending."""
    if count <= limit:
        return np.arange(count)
    return np.sort(rng.choice(count, limit, replace=False))
