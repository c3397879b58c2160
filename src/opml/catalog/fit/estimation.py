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
from opml.catalog.fit.apriori import CD, SCALES, cd_residual, eccentricity_residuals
from opml.catalog.fit.estimate import Estimate
from opml.catalog.fit.estimation_settings import Estimation
from opml.catalog.fit.iterations import Iterations
from opml.catalog.fit.least_squares import Evaluation, Fit, Method
from opml.catalog.fit.measurements import Measurements, Window
from opml.catalog.fit.neighbour_arcs import propagate_around, propagate_parameters
from opml.catalog.fit.outliers import fit_without_outliers
from opml.catalog.fit.starts import Solution, StartParameters, is_usable, solutions, with_known_cd
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
    states: np.ndarray  # (tracks, 6) GCRF at the tracks' starts
    ages: np.ndarray  # (tracks,) how long before each start its orbit was known [s]
    settings: Estimation
    eccentricity_sigma: float | None = None  # of the eccentricity about 0; None where nothing is known

    @classmethod
    def of_starts(
        cls, propagator: Propagator, starts: pd.DataFrame, measured: Measurements, settings: Estimation
    ) -> Self:
        """Return the run of a table `starts`; its callers report the progress."""
        states, ages = starts[STATE].to_numpy(), starts["age"].to_numpy()
        return cls(measured, propagator.without_progress(), states, ages, settings)

    def method(self, free: np.ndarray) -> Method:
        """Return how the parameters that are free (7,) are fitted."""
        return Method(SCALES, free, self.settings.convergence)

    def free_parameters(self) -> np.ndarray:
        """Return which parameters (7,) are estimated: not Cd where no window can show it, as in high orbits.

        A short track leaves Cd as uncertain, but there the orbit has drag, and the fit says so.
        """
        known = int(np.isfinite(self.states).all(axis=1).argmax())
        begin = self.measured.epochs[self.measured.at[known]]
        start = np.append(self.states[known], self.propagator.rso.cd)
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

    def candidates(
        self, windows: Sequence[Window], usable: StartParameters | None, spare: StartParameters | None
    ) -> Iterator[np.ndarray]:
        """Yield parameters (windows, 7) to start from, the best first; not finite where there are none.

        usable, spare: from `newest`

        First those of the newest usable estimate, carried to each track's start; then the newer of the
        track's state and the spare estimate, then the older.
        """
        at = np.array([window.at for window in windows])
        tracks = [window.track for window in windows]
        first = np.column_stack([self.states[tracks], np.full(len(tracks), self.propagator.rso.cd)])
        if usable is not None:
            yield self.carry(*usable, at)
        if spare is None:
            yield first
            return
        kept, epochs = self.carry(*spare, at), self.measured.epochs
        is_newer = (epochs[at] - epochs[spare[0]] < self.ages[tracks])[:, None]
        yield np.where(is_newer, kept, first)
        yield np.where(is_newer, first, kept)

    def carry(self, begin: int, parameters: np.ndarray, at: np.ndarray) -> np.ndarray:
        """Return parameters (7,) at an epoch `begin` carried to epochs `at`: (n, 7), lost ones not finite."""
        epochs = self.measured.epochs[np.append(begin, at)]
        arcs = propagate_parameters(
            self.propagator, epochs, parameters[None], np.array([0]), np.array([len(at)])
        )
        return np.column_stack([arcs.path(0), np.full(len(at), parameters[CD])])

    def newest(
        self,
        solutions: Sequence[Solution],
        usable: StartParameters | None = None,
        spare: StartParameters | None = None,
    ) -> tuple[StartParameters | None, StartParameters | None]:
        """Return the newest usable and the newest spare start of solutions; without one, that given.

        usable: of an estimate whose Cd is known; spare: of one that has a state at least
        """
        cd, bounds, last_first = self.propagator.rso.cd, self.settings.cd_bounds, solutions[::-1]
        usable = next(((one.at, one.best) for one in last_first if is_usable(one, bounds)), usable)
        return usable, next((known for one in last_first if (known := with_known_cd(one, cd))), spare)

    def fit_windows(
        self, windows: Sequence[Window], candidates: Iterable[np.ndarray], methods: Sequence[Method]
    ) -> list[Estimate]:
        """Return estimates over `windows`, each from the best start that its arc can be propagated from.

        candidates: parameters (windows, 7) to start from, as `candidates` yields them
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
        trial, sigma = estimate.fit.trial, self.settings.cd_sigma
        if sigma is not None:
            evaluation = evaluation.and_also(cd_residual(trial, self.propagator.rso.cd, sigma))
        if self.eccentricity_sigma is not None:
            gm = self.propagator.model.gm
            evaluation = evaluation.and_also(eccentricity_residuals(trial, gm, self.eccentricity_sigma))
        return evaluation

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
    usable, spare = run.newest(earlier)
    for begin in range(0, len(windows), BATCH):
        batch = windows[begin : begin + BATCH]
        estimates = run.fit_windows(batch, run.candidates(batch, usable, spare), [method] * len(batch))
        usable, spare = run.newest([estimate.solution for estimate in estimates], usable, spare)
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
        run.candidates([window], *run.newest(solutions(rows, measured.at)))
        for run, window, rows in zip(runs, windows, earlier.values(), strict=True)
    ]
    methods = [run.method(run.free_parameters()) for run in runs]
    # The starts (windows, 7) of all windows, not finite where one has no more.
    starts = map(np.concatenate, zip_longest(*candidates, fillvalue=np.full((1, 7), np.nan)))
    estimates = runs[0].fit_windows(windows, starts, methods)
    rows = [run.row(estimate) for run, estimate in zip(runs, estimates, strict=True)]
    return pd.DataFrame(rows).assign(window_hours=list(earlier))
