"""Initial guesses of fits: states at the tracks, and the results of earlier fits."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from opml.catalog.fit.apriori import CD, LINEAR, SCALES
from opml.catalog.fit.measurements import Measurements, Window
from opml.catalog.fit.neighbour_arcs import propagate_parameters
from opml.catalog.propagator import Propagator
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


@dataclass(frozen=True)
class Starts:
    """Possible initial guesses of a run's fits."""

    measured: Measurements
    propagator: Propagator
    states: np.ndarray  # (tracks, 6) GCRF at the tracks' starts
    ages: np.ndarray  # (tracks,) how long before each start its orbit was known [s]
    cd_bounds: tuple[float, float] | None  # Cd to start others from; None where its uncertainty decides

    def in_turn(
        self, windows: Sequence[Window], usable: StartParameters | None, spare: StartParameters | None
    ) -> Iterator[np.ndarray]:
        """Yield parameters (windows, 7) to start from, the best first; not finite where there are none.

        usable: of the newest estimate whose Cd is known
        spare: of the newest estimate that has a state at least

        First those of the newest usable estimate, carried to each track's start; then the newer of the
        track's state and the spare estimate, then the older.
        """
        at = np.array([window.at for window in windows])
        tracks = [window.track for window in windows]
        first = np.column_stack([self.states[tracks], np.full(len(tracks), self.propagator.rso.cd)])
        if usable is not None:
            yield self.propagate(*usable, at)
        if spare is None:
            yield first
            return
        kept, epochs = self.propagate(*spare, at), self.measured.epochs
        is_newer = (epochs[at] - epochs[spare[0]] < self.ages[tracks])[:, None]
        yield np.where(is_newer, kept, first)
        yield np.where(is_newer, first, kept)

    def propagate(self, begin: int, parameters: np.ndarray, at: np.ndarray) -> np.ndarray:
        """Return parameters (7,) at an epoch `begin` carried to epochs `at`: (n, 7), lost ones not finite."""
        epochs = self.measured.epochs[np.append(begin, at)]
        arcs = propagate_parameters(
            self.propagator, epochs, parameters[None], np.array([0]), np.array([len(at)])
        )
        return np.column_stack([arcs.path(0), np.full(len(at), parameters[CD])])

    def is_usable(self, solution: Solution) -> bool:
        """Whether others may start from a solution: converged, with Cd within the bounds or well determined.

        A fit of one short track may converge on a Cd of thousands, from which no other would find back.
        """
        if not solution.converged:
            return False
        if self.cd_bounds is None:
            return bool(solution.covariance[CD, CD] < SCALES[CD] ** 2)
        low, high = self.cd_bounds
        return bool(low <= solution.best[CD] <= high)

    def with_known_cd(self, solution: Solution) -> StartParameters | None:
        """Return what others may start from, had Cd been known beforehand at its a-priori value.

        A short fit may say nothing about Cd, but the whole state. None where it did not converge, or its Cd
        is so far off that the state would not move in a straight line.
        """
        if not solution.converged:
            return None
        covariance, best = solution.covariance, solution.best
        missing = self.propagator.rso.cd - best[CD]
        # A measurement of Cd alone would move the other parameters as they correlate with it.
        if covariance[CD, CD] > 0.0:
            moved: np.ndarray = best + missing * covariance[:, CD] / covariance[CD, CD]
        else:
            moved = best + missing * np.eye(7)[CD]
        return (solution.at, moved) if np.linalg.norm((moved - best)[:3]) < LINEAR else None

    def newest(
        self, solutions: Sequence[Solution], usable: StartParameters | None, spare: StartParameters | None
    ) -> tuple[StartParameters | None, StartParameters | None]:
        """Return the newest usable and the newest spare start of solutions; without one, that given."""
        last_first = solutions[::-1]
        usable = next(((one.at, one.best) for one in last_first if self.is_usable(one)), usable)
        return usable, next((known for known in map(self.with_known_cd, last_first) if known), spare)
