"""What fits came to, for others to start from: under way, or read from a table."""

from dataclasses import dataclass

import numpy as np
import pandas as pd

from opml.tables import PARAMETER_COVARIANCES, PARAMETERS, symmetric_matrices

StartParameters = tuple[int, np.ndarray]
"""An epoch of a run's measurements, by its number, and the parameters (7,) of an orbit there."""


@dataclass(frozen=True)
class Solution:
    """What a fit came to.

    at: number of its epoch among those of the run's measurements
    best: (7,) parameters
    covariance: (7, 7) of these
    """

    at: int
    best: np.ndarray
    covariance: np.ndarray
    converged: bool


def solutions(estimates: pd.DataFrame, at: np.ndarray) -> list[Solution]:
    """Return the solutions of rows of `estimates`; at: (tracks,) number of the epoch of each track."""
    rows = zip(
        at[estimates["track"]],
        estimates[PARAMETERS].to_numpy(),
        symmetric_matrices(estimates, PARAMETER_COVARIANCES),
        estimates["converged"],
        strict=True,
    )
    return [Solution(int(at), best, covariance, bool(done)) for at, best, covariance, done in rows]
