"""Iterations of several fits side by side.

In a large field only the first trial of a fit is propagated with all of it, with its neighbours. A later
trial near by parts from it under the first degrees of the field as under all of it, and the partial
derivatives are the same. So it is propagated alone, with these.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from opml.catalog.fit.least_squares import Evaluation, Fit
from opml.catalog.fit.measurements import Window
from opml.catalog.fit.neighbour_arcs import NeighbourArcs, propagate_around, propagate_near
from opml.catalog.propagator import Propagator
from opml.dynamics.ensemble import REASONS

FASTEST = 1e6
"""Speed of trials above which arcs are not propagated [m/s]: fits to short tracks of angles wander far."""

TOO_FAST = "start arc faster than any orbit"  # why such a fit did not begin

NEAR = 3.0
"""Largest change of a residual, in its standard deviation, between trials that are near each other.

The distance of arcs that near is right to some 0.0003 of itself (`propagator.neighbour_paths`), a residual to
0.001 of its standard deviation.
"""


@dataclass(frozen=True)
class Iterations:
    """Shared state of the iterations of several fits."""

    propagator: Propagator
    epochs: np.ndarray  # of the run [s]
    windows: Sequence[Window]  # of the fits
    evaluation: Callable[[int, np.ndarray], Evaluation]  # of a fit's trial, from states (8, epochs, 6)

    def run(self, fits: Sequence[Fit], *, most: int) -> None:
        """Iterate the fits until they end, or after so many iterations."""
        known: dict[int, tuple[NeighbourArcs, Evaluation]] = {}
        for _ in range(most):
            trials = {k: fit.trial for k, fit in enumerate(fits) if _is_running(fit)}
            if not trials:
                break
            near = self._near({k: trial for k, trial in trials.items() if k in known}, known)
            for k, evaluation in near.items():
                fits[k].take(evaluation)
            # What was tried alone, and came out far from what is known, is propagated again with all of it.
            far = {k: trial for k, trial in trials.items() if k not in near}
            for k, around, lost in self._propagated(far):
                if lost:
                    fits[k].reject(f"start arc {REASONS[lost]}")
                else:
                    evaluation = self.evaluation(k, around.states)
                    known[k] = around, evaluation
                    fits[k].take(evaluation)

    def _propagated(self, trials: Mapping[int, np.ndarray]) -> Iterator[tuple[int, NeighbourArcs, int]]:
        """Yield the arcs around trials, by the numbers of their fits, and their status."""
        if trials:
            windows, parameters = [self.windows[k] for k in trials], np.array(list(trials.values()))
            yield from zip(
                trials, *propagate_around(self.propagator, self.epochs, windows, parameters), strict=True
            )

    def _near(
        self, trials: Mapping[int, np.ndarray], known: Mapping[int, tuple[NeighbourArcs, Evaluation]]
    ) -> dict[int, Evaluation]:
        """Return the evaluations of those trials that are near what was propagated for the same fits."""
        if not trials or self.propagator.for_neighbours() is self.propagator:
            return {}
        windows, parameters = [self.windows[k] for k in trials], np.array(list(trials.values()))
        paths, _ = propagate_near(self.propagator, self.epochs, windows, parameters)
        estimates = {
            k: self.evaluation(k, known[k][0].moved(path)) for k, path in zip(trials, paths, strict=True)
        }
        return {k: one for k, one in estimates.items() if _are_near(one, known[k][1])}


def _are_near(one: Evaluation, other: Evaluation) -> bool:
    return bool(np.abs(one.residuals - other.residuals).max(initial=0.0) <= NEAR)


def _is_running(fit: Fit) -> bool:
    while fit.running and np.linalg.norm(fit.trial[3:6]) > FASTEST:
        fit.reject(TOO_FAST)
    return fit.running
