"""Initial guesses of fits: the results of earlier ones that others may start from."""

from dataclasses import dataclass

import numpy as np
import pandas as pd

from opml.catalog.fit.apriori import CD, LINEAR, SCALES
from opml.tables import PARAMETER_COVARIANCES, PARAMETERS, symmetric_matrices

StartParameters = tuple[int, np.ndarray]
"""An epoch of a run's measurements, by its number, and the parameters (7,) of an orbit there."""


@dataclass(frozen=True)
class Solution:
    """The result of a fit."""

    at: int  # number of its epoch among those of the run's measurements
    best: np.ndarray  # (7,) parameters
    covariance: np.ndarray  # (7, 7) of these
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


def is_usable(solution: Solution, cd_bounds: tuple[float, float] | None) -> bool:
    """Whether others may start from a solution: converged, with Cd within bounds or well determined.

    A fit of one short track may converge on a Cd of thousands, from which no other would find back.
    """
    if not solution.converged:
        return False
    if cd_bounds is None:
        return bool(solution.covariance[CD, CD] < SCALES[CD] ** 2)
    low, high = cd_bounds
    return bool(low <= solution.best[CD] <= high)


def with_known_cd(solution: Solution, cd: float) -> StartParameters | None:
    """Return what others may start from, had Cd been known beforehand at its a-priori value.

    A short fit may say nothing about Cd, but the whole state. None where it did not converge, or its Cd
    is so far off that the state would not move in a straight line.
    """
    if not solution.converged:
        return None
    covariance, best = solution.covariance, solution.best
    missing = cd - best[CD]
    # A measurement of Cd alone would move the other parameters as they correlate with it.
    if covariance[CD, CD] > 0.0:
        moved: np.ndarray = best + missing * covariance[:, CD] / covariance[CD, CD]
    else:
        moved = best + missing * np.eye(7)[CD]
    return (solution.at, moved) if np.linalg.norm((moved - best)[:3]) < LINEAR else None
