"""Estimates of an RSO's state and drag coefficient by weighted batch least squares.

At the start of each track, all measurements of that track and of those that began in the window before it
are fitted under the assumed model (paper, sec. Estimation Models). A window may reach beyond the track, too:
such an estimate is smoothed and known later, which serves labels. The partial derivatives come from
neighbouring arcs: the nominal arc and seven that differ in one parameter are propagated as eight lanes of an
ensemble, so no variational equations are needed.
"""

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import zip_longest
from typing import Any, Self

import numpy as np
import pandas as pd

from opml.base.constants import HOUR
from opml.catalog.fit import biases
from opml.catalog.fit.apriori import CD, SCALES, Apriori
from opml.catalog.fit.estimate import Estimate
from opml.catalog.fit.estimation_settings import Estimation
from opml.catalog.fit.iterations import Iterations
from opml.catalog.fit.least_squares import Evaluation, Fit, Method
from opml.catalog.fit.measurements import Measurements, Window
from opml.catalog.fit.neighbour_arcs import propagate_around, propagate_parameters
from opml.catalog.fit.outliers import fit_without_outliers
from opml.catalog.fit.starts import Solution, Starts, solutions
from opml.catalog.propagator import Propagator
from opml.tables import PARAMETERS, STATE

BATCH = 16
"""Windows fitted side by side; each starts from the newest usable estimate before its batch.

No matter of the kernels' lanes, of which a window takes eight: more windows keep more threads busy, but start
from an older estimate.
"""

NO_START = "no orbit to start from"  # why a fit did not begin


@dataclass(frozen=True)
class Run:
    """All that the windows of a run share."""

    measured: Measurements
    propagator: Propagator
    starts: Starts
    settings: Estimation
    eccentricity_sigma: float | None = None  # of the eccentricity about 0; None where nothing is known

    @classmethod
    def of_starts(
        cls, propagator: Propagator, starts: pd.DataFrame, measured: Measurements, settings: Estimation
    ) -> Self:
        """Return the run of a table `starts`; its callers report the progress."""
        states, ages = starts[STATE].to_numpy(), starts["age"].to_numpy()
        return cls.of_states(propagator.without_progress(), states, measured, settings, ages=ages)

    @classmethod
    def of_states(
        cls,
        propagator: Propagator,
        states: np.ndarray,
        measured: Measurements,
        settings: Estimation,
        *,
        ages: np.ndarray,
    ) -> Self:
        """Return the run of states (tracks, 6) at the tracks' starts; ages: as in `Starts`."""
        return cls(
            measured, propagator, Starts(measured, propagator, states, ages, settings.cd_bounds), settings
        )

    def method(self, free: np.ndarray) -> Method:
        """Return how the parameters that are free (7,) are fitted."""
        return Method(SCALES, free, self.settings.convergence)

    def free_parameters(self) -> np.ndarray:
        """Return which parameters (7,) are estimated: not Cd where no window can show it, as in high orbits.

        A short track leaves Cd as uncertain, but there the orbit has drag, and the fit says so.
        """
        known = int(np.isfinite(self.starts.states).all(axis=1).argmax())
        begin = self.measured.epochs[self.measured.at[known]]
        start = np.append(self.starts.states[known], self.propagator.rso.cd)
        pair = np.stack([start, start + np.eye(7)[CD]])
        epochs = np.array([begin, begin + self._window])
        near = self.propagator.for_neighbours()  # drag is the same under all harmonics
        propagated = propagate_parameters(near, epochs, pair, np.zeros(2, int), np.ones(2, int)).states[:, :3]
        free = np.ones(7, bool)
        # An arc that re-enters has no displacement, and feels drag all the more.
        free[CD] = not np.linalg.norm(propagated[1] - propagated[0]) < self.settings.least_drag_m
        return free

    def window(self, track: int, *, without: Collection[int] = ()) -> Window:
        """Return the window of the settings at a track; `without`: tracks that are left out."""
        return self.measured.window(track, self._window, without=without)

    def fit_windows(
        self, windows: Sequence[Window], candidates: Iterable[np.ndarray], methods: Sequence[Method]
    ) -> list[Estimate]:
        """Return estimates over `windows`, each from the best start that its arc can be propagated from.

        candidates: parameters (windows, 7) to start from, as `Starts.in_turn` yields them
        methods: of each window
        """
        estimates = [
            Estimate(window, Fit(np.full(7, np.nan), method))
            for window, method in zip(windows, methods, strict=True)
        ]
        for starts in candidates:
            waiting = [
                k
                for k, estimate in enumerate(estimates)
                if not estimate.fit.started and np.all(np.isfinite(starts[k]))
            ]
            for k in waiting:
                estimates[k] = Estimate(windows[k], Fit(starts[k], methods[k]))
            for k, estimate in zip(waiting, self.complete([estimates[k] for k in waiting]), strict=True):
                estimates[k] = estimate
            if all(estimate.fit.started for estimate in estimates):
                break
        for estimate in estimates:
            if estimate.fit.running and not estimate.fit.started:
                estimate.fit.reject(NO_START)
        return estimates

    def complete(self, estimates: Sequence[Estimate]) -> Sequence[Estimate]:
        """Return estimates whose fits have ended, without outliers where the settings reject them."""
        if self.settings.reject_sigma is not None:
            limit = self.settings.reject_sigma
            return fit_without_outliers(
                estimates, self.measured, limit, fit=self.fit, residuals=self.residuals
            )
        self.fit(estimates)
        return estimates

    def fit(self, estimates: Sequence[Estimate]) -> None:
        """Iterate all fits side by side until they end, or the settings' number of iterations is reached."""
        windows, fits = [one.window for one in estimates], [one.fit for one in estimates]

        def evaluation(k: int, states: np.ndarray) -> Evaluation:
            return self._evaluation(estimates[k], states)

        iterations = Iterations(self.propagator, self.measured.epochs, windows, evaluation)
        iterations.run(fits, most=self.settings.max_iterations)

    def _evaluation(self, estimate: Estimate, states: np.ndarray) -> Evaluation:
        """Return the evaluation of a trial, from states (8, epochs, 6) of its arc and the neighbours."""
        light_time = self.settings.light_time
        evaluation = self.measured.evaluation(estimate.window, states, light_time=light_time)
        kept = slice(None) if estimate.kept is None else estimate.kept
        if estimate.kept is not None:
            evaluation = Evaluation(evaluation.residuals[kept], evaluation.jacobian[kept])
        if self.settings.bias_sigma is not None:
            instruments = self.measured.instruments(estimate.window.rows)[kept]
            evaluation = biases.whiten(evaluation, instruments, self.settings.bias_sigma)
        rso, gm = self.propagator.rso, self.propagator.model.gm
        apriori = Apriori(rso.cd, self.settings.cd_sigma, gm, self.eccentricity_sigma)
        return apriori.added_to(evaluation, estimate.fit.trial)

    def row(self, estimate: Estimate) -> dict[str, Any]:
        """Return an estimate as a row of the table."""
        return estimate.row(self.measured, tells_rejected=self.settings.reject_sigma is not None)

    def residuals(self, estimates: Sequence[Estimate]) -> list[np.ndarray]:
        """Return the weighted residuals (numbers,) of all in the window of each estimate, at its best."""
        light_time = self.settings.light_time
        return [
            self.measured.evaluation(one.window, states, light_time=light_time).residuals
            for one, states in zip(estimates, self._best_paths(estimates), strict=True)
        ]

    def path(self, estimate: Estimate) -> np.ndarray:
        """Return the states (epochs, 6) of an estimate's best at the epochs of its window."""
        [states] = self._best_paths([estimate])
        return states[0]

    def _best_paths(self, estimates: Sequence[Estimate]) -> list[np.ndarray]:
        """Return the states (8, epochs, 6) of the best of each estimate and its neighbours."""
        windows, best = [one.window for one in estimates], np.array([one.fit.best for one in estimates])
        trials = best.reshape(-1, len(PARAMETERS))
        arounds, _ = propagate_around(self.propagator, self.measured.epochs, windows, trials)
        return [around.states for around in arounds]

    @property
    def _window(self) -> float:
        return self.settings.window_hours * HOUR


def in_turn(
    run: Run, method: Method, windows: Sequence[Window], *, earlier: Sequence[Solution] = ()
) -> Iterator[Estimate]:
    """Yield the fits over windows, batch after batch, each from what earlier ones show."""
    usable, spare = run.starts.newest(earlier, None, None)
    for begin in range(0, len(windows), BATCH):
        batch = windows[begin : begin + BATCH]
        estimates = run.fit_windows(batch, run.starts.in_turn(batch, usable, spare), [method] * len(batch))
        usable, spare = run.starts.newest([estimate.solution for estimate in estimates], usable, spare)
        yield from estimates


def with_noise(
    propagator: Propagator, starts: pd.DataFrame, measured: Measurements, *, settings: Estimation
) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Return the `estimates` table and the noise by the fits, see `biases`.

    The table has a row for each track, converged or with the reason why not.

    starts: the table, a state at each track's start for fits where no estimate is at hand
    """
    run = Run.of_starts(propagator, starts, measured, settings)
    windows = [run.window(track) for track in range(measured.tracks)]
    estimates: list[Estimate] = []
    for estimate in in_turn(run, run.method(run.free_parameters()), windows):
        estimates.append(estimate)
        if propagator.progress:
            propagator.progress(len(estimates) / len(windows))
    table = pd.DataFrame([run.row(estimate) for estimate in estimates])
    return table, biases.instrument_residuals(measured, estimates, run.residuals)


def estimate_further(
    propagator: Propagator,
    starts: pd.DataFrame,
    measured: Measurements,
    *,
    settings: Estimation,
    tracks: Sequence[int],
    earlier: pd.DataFrame,
) -> pd.DataFrame:
    """Return the rows of `estimates` of some tracks, ascending, as `with_noise` does of all.

    earlier: rows of tracks before these that were estimated already, which fits may start from
    """
    run = Run.of_starts(propagator, starts, measured, settings)
    windows = [run.window(track) for track in tracks]
    known = solutions(earlier, measured.at)
    fits = in_turn(run, run.method(run.free_parameters()), windows, earlier=known)
    return pd.DataFrame([run.row(estimate) for estimate in fits])


def estimate_over_windows(
    propagator: Propagator,
    starts: pd.DataFrame,
    measured: Measurements,
    *,
    settings: Estimation,
    track: int,
    earlier: Mapping[float, pd.DataFrame],
) -> pd.DataFrame:
    """Return the rows of `estimates` of a track over windows, each as `estimate_further` has it.

    Their arcs are propagated side by side, as fast as the longest.

    settings: of all windows but their length
    earlier: by the length of each window [h], rows of tracks before that fits over it may start from

    Besides, the window of each row, `window_hours`.
    """
    runs = [
        Run.of_starts(propagator, starts, measured, settings.evolve(window_hours=hours)) for hours in earlier
    ]
    windows = [run.window(track) for run in runs]
    candidates = [
        run.starts.in_turn([window], *run.starts.newest(solutions(rows, measured.at), None, None))
        for run, window, rows in zip(runs, windows, earlier.values(), strict=True)
    ]
    methods = [run.method(run.free_parameters()) for run in runs]
    # The starts (windows, 7) of all windows, not finite where one has no more.
    starts = map(np.concatenate, zip_longest(*candidates, fillvalue=np.full((1, 7), np.nan)))
    estimates = runs[0].fit_windows(windows, starts, methods)
    rows = [run.row(estimate) for run, estimate in zip(runs, estimates, strict=True)]
    return pd.DataFrame(rows).assign(window_hours=list(earlier))
