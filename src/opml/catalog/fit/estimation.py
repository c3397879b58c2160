"""Estimates of an RSO's state and drag coefficient by weighted batch least squares.

At the start of each track, all measurements of that track and of those that began in the window before it
are fitted under the assumed model (paper, sec. Estimation Models). A window may reach beyond the track, too:
such an estimate is smoothed and known later, which serves labels. The partial derivatives come from
neighbouring arcs: the nominal arc and seven that differ in one parameter fly as eight lanes of an ensemble,
so no variational equations are needed.
"""

from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any, Self

import numpy as np
import pandas as pd

from opml.base.constants import HOUR
from opml.catalog.fit import biases
from opml.catalog.fit.estimate import Estimate
from opml.catalog.fit.estimation_settings import Estimation
from opml.catalog.fit.first.round_orbits import eccentricity
from opml.catalog.fit.iterations import Iterations
from opml.catalog.fit.least_squares import Evaluation, Fit, Method
from opml.catalog.fit.measurements import Measurements, Window
from opml.catalog.fit.neighbour_arcs import fly_around, fly_parameters
from opml.catalog.fit.solutions import Solution, StartParameters, solutions
from opml.catalog.flight import Flight
from opml.tables import PARAMETER_COVARIANCES, PARAMETERS, STATE

BATCH = 16
"""Windows fitted side by side; each starts from the newest usable estimate before its batch.

No matter of the kernels' lanes, of which a window takes eight: more windows keep more threads busy, but start
from an older estimate.
"""

_CD = PARAMETERS.index("cd")
SCALES = np.array([1e3, 1e3, 1e3, 1.0, 1.0, 1.0, 1.0])
"""A-priori uncertainty [m, m/s, -] in which the damping measures a step."""

NO_START = "no orbit to start from"
"""Why a fit did not begin."""

LINEAR = 10e3
"""How far a state may be moved along its covariance [m], to where it would be had Cd been known."""

APRIORI_SIGMA = 0.5
"""Uncertainty of the sheet's Cd, as a part of it."""


_EDITS = 10
"""Times that outliers are looked for in a fit at most."""

_NORMAL = 0.6745
"""Median of the size of a normal deviate."""


def _have_same_numbers(one: Estimate, other: Estimate) -> bool:
    """Return whether the same measured numbers count in two estimates of a window."""
    if one.kept is None or other.kept is None:
        return one.kept is other.kept
    return bool(np.array_equal(one.kept, other.kept))


@dataclass(frozen=True)
class Run:
    """All that the windows of a run share.

    flight: under the assumed model
    starts: (tracks, 6) GCRF states at the tracks' starts
    ages: (tracks,) how long before each start its orbit was known [s]
    eccentricity_sigma: standard deviation of the eccentricity about 0; None where nothing is known beforehand
    """

    measured: Measurements
    flight: Flight
    starts: np.ndarray
    settings: Estimation
    ages: np.ndarray = field(default_factory=lambda: np.empty(0))
    eccentricity_sigma: float | None = None

    @classmethod
    def of_starts(
        cls, flight: Flight, starts: pd.DataFrame, measured: Measurements, settings: Estimation
    ) -> Self:
        """Return the run of a table `starts`; its callers tell the progress."""
        quiet = flight.without_progress()
        return cls(measured, quiet, starts[STATE].to_numpy(), settings, starts["age"].to_numpy())

    def method(self, free: np.ndarray) -> Method:
        """Return how the parameters that are free (7,) are fitted."""
        return Method(SCALES, free, self.settings.convergence)

    def free_parameters(self) -> np.ndarray:
        """Return which parameters (7,) are estimated: not Cd where no window can show it, as in high orbits.

        A short track leaves Cd as uncertain, but there the orbit has drag, and the fit says so.
        """
        known = int(np.isfinite(self.starts).all(axis=1).argmax())
        begin = self.measured.epochs[self.measured.at[known]]
        start = np.append(self.starts[known], self.flight.rso.cd)
        pair = np.stack([start, start + np.eye(7)[_CD]])
        epochs = np.array([begin, begin + self._window])
        near = self.flight.for_neighbours()  # drag is the same under all harmonics
        flown = fly_parameters(near, epochs, pair, np.zeros(2, int), np.ones(2, int)).states[:, :3]
        free = np.ones(7, bool)
        # An arc that comes down on the way has no displacement, and feels drag all the more.
        free[_CD] = not np.linalg.norm(flown[1] - flown[0]) < self.settings.least_drag_m
        return free

    def window(self, track: int, *, without: Collection[int] = ()) -> Window:
        """Return the window of the settings at a track; `without`: tracks that are left out."""
        after = self.settings.after_hours * HOUR
        return self.measured.window(track, self._window, after, without=without)

    def fit_windows(
        self,
        windows: Sequence[Window],
        candidates: Iterable[np.ndarray],
        methods: Sequence[Method],
    ) -> list[Estimate]:
        """Return estimates over `windows`, each from the best start that its arc can be flown from.

        candidates: parameters (windows, 7) to start from, as `starts_in_turn` yields them
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

    def starts_in_turn(
        self, windows: Sequence[Window], usable: StartParameters | None, spare: StartParameters | None
    ) -> Iterator[np.ndarray]:
        """Yield parameters (windows, 7) to start from, the best first; not finite where there are none.

        usable: of the newest estimate whose Cd is known
        spare: of the newest estimate that has a state at least

        First those of a theory where that was measured, then those of the newest usable estimate, carried
        to each track's start; then the newer of the state in `starts` and the spare estimate; then the older.
        """
        at = np.array([window.at for window in windows])
        tracks = [window.track for window in windows]
        first = np.column_stack([self.starts[tracks], np.full(len(tracks), self.flight.rso.cd)])
        if self.measured.of_theory:
            yield first
        if usable is not None:
            yield self.propagate(*usable, at)
        if spare is None:
            yield first
            return
        kept, epochs = self.propagate(*spare, at), self.measured.epochs
        is_newer = (epochs[at] - epochs[spare[0]] < self.ages[tracks])[:, None]
        yield np.where(is_newer, kept, first)
        yield np.where(is_newer, first, kept)

    def complete(self, estimates: Sequence[Estimate]) -> Sequence[Estimate]:
        """Return estimates whose fits have ended, without outliers where the settings reject them."""
        if self.settings.reject_sigma is not None:
            return self.without_outliers(estimates)
        self.fit(estimates)
        return estimates

    def fit(self, estimates: Sequence[Estimate]) -> None:
        """Iterate all fits side by side until they end, or the settings' number of iterations is reached."""
        windows, fits = [one.window for one in estimates], [one.fit for one in estimates]

        def evaluation(k: int, states: np.ndarray) -> Evaluation:
            return self._evaluation(estimates[k], states)

        iterations = Iterations(self.flight, self.measured.epochs, windows, evaluation)
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
        evaluation = self.with_apriori_cd(evaluation, estimate.fit.trial)
        return self._with_apriori_shape(evaluation, estimate.fit.trial)

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
        nominal: np.ndarray = states[0]
        return nominal

    def _best_paths(self, estimates: Sequence[Estimate]) -> list[np.ndarray]:
        """Return the states (8, epochs, 6) of the best of each estimate and its neighbours."""
        windows, best = [one.window for one in estimates], np.array([one.fit.best for one in estimates])
        trials = best.reshape(-1, len(PARAMETERS))
        arounds, _ = fly_around(self.flight, self.measured.epochs, windows, trials)
        return [around.states for around in arounds]

    def without_outliers(self, estimates: Sequence[Estimate]) -> list[Estimate]:
        """Return estimates fitted without outliers, first those from the start, until these stay the same.

        Each time all numbers are judged anew, so that one that a bad orbit made an outlier comes back.
        """
        found = [self._judged(*pair) for pair in zip(estimates, self.residuals(estimates), strict=True)]
        changed = found
        for _ in range(_EDITS):
            self.fit(changed)
            begun = [k for k, one in enumerate(found) if one.fit.started]
            left = self.residuals([found[k] for k in begun])
            judged = {k: self._judged(found[k], one) for k, one in zip(begun, left, strict=True)}
            judged = {k: one for k, one in judged.items() if not _have_same_numbers(one, found[k])}
            if not judged:
                break
            changed = list(judged.values())
            found = [judged.get(k, one) for k, one in enumerate(found)]
        return found

    def _judged(self, estimate: Estimate, weighted: np.ndarray) -> Estimate:
        """Return an estimate that goes on from its best without outliers among weighted residuals (numbers,).

        It stays as it is where its arc tells no residuals.
        """
        if not np.isfinite(weighted).all():
            return estimate
        again = Fit(estimate.fit.best, estimate.fit.method)
        return Estimate(estimate.window, again, self._kept(estimate.window, weighted))

    def _kept(self, window: Window, weighted: np.ndarray) -> np.ndarray:
        """Return which weighted residuals (numbers,) are no outliers.

        Each observable has a scale of its own, its residuals' scatter by their median, but 1 at least.
        """
        _, observables = self.measured.layout(window.rows)
        kept, most = np.ones(len(weighted), bool), self.settings.reject_sigma or np.inf
        for observable in np.unique(observables):
            size = np.abs(weighted[observables == observable])
            kept[observables == observable] = size <= most * max(1.0, float(np.median(size)) / _NORMAL)
        return kept

    def with_apriori_cd(self, evaluation: Evaluation, trial: np.ndarray) -> Evaluation:
        """Return an evaluation at a trial (7,) with one more residual, if Cd is known beforehand."""
        if self.settings.cd_sigma is None:
            return evaluation
        weighted = np.eye(7)[_CD] / self.settings.cd_sigma
        residual = (self.flight.rso.cd - trial[_CD]) / self.settings.cd_sigma
        return Evaluation(
            np.append(evaluation.residuals, residual), np.vstack([evaluation.jacobian, weighted])
        )

    def _with_apriori_shape(self, evaluation: Evaluation, trial: np.ndarray) -> Evaluation:
        """Return an evaluation at a trial (7,) with three more residuals, if its eccentricity is known."""
        if self.eccentricity_sigma is None:
            return evaluation
        vector, derivative = eccentricity(trial[:6], self.flight.model.gm)
        weighted = np.hstack([derivative, np.zeros((3, 1))]) / self.eccentricity_sigma
        return Evaluation(
            np.append(evaluation.residuals, -vector / self.eccentricity_sigma),
            np.vstack([evaluation.jacobian, weighted]),
        )

    def is_usable(self, solution: Solution) -> bool:
        """Whether others may start from a solution: converged, with Cd within the bounds or well determined.

        A fit of one short track may converge on a Cd of thousands, from which no other would find back.
        """
        if not solution.converged:
            return False
        if self.settings.cd_bounds is None:
            return bool(solution.covariance[_CD, _CD] < SCALES[_CD] ** 2)
        low, high = self.settings.cd_bounds
        return bool(low <= solution.best[_CD] <= high)

    def row(self, estimate: Estimate) -> dict[str, Any]:
        """Return the estimate as a row of the table."""
        window, fit = estimate.window, estimate.fit
        rms = np.sqrt(fit.cost / self._count(estimate)) if np.isfinite(fit.cost) else np.nan
        return {
            "track": window.track,
            "t": self.measured.epochs[window.at],
            **dict(zip(PARAMETERS, fit.best, strict=True)),
            **dict(zip(PARAMETER_COVARIANCES, fit.covariance[np.tril_indices(7)], strict=True)),
            "iterations": fit.iterations,
            "converged": fit.converged,
            "reason": fit.reason,
            "tracks_used": window.tracks,
            "measurements_used": window.measurements,
            "weighted_rms": rms,
            **self._rejected(estimate),
        }

    def _count(self, estimate: Estimate) -> int:
        """Return how many numbers an estimate is made of."""
        if estimate.kept is None:
            return self.measured.count(estimate.window.rows)
        return int(np.count_nonzero(estimate.kept))

    def _rejected(self, estimate: Estimate) -> dict[str, int]:
        """Return how many numbers of the window and of the track do not count, where any are judged."""
        if self.settings.reject_sigma is None:
            return {}
        window, kept = estimate.window, estimate.kept
        if kept is None:
            return {"rejected": 0, "rejected_of_track": 0}
        first, last = self.measured.first_row[window.track : window.track + 2]
        rows = window.index[self.measured.layout(window.rows)[0]]
        return {
            "rejected": int(np.count_nonzero(~kept)),
            "rejected_of_track": int(np.count_nonzero(~kept & (rows >= first) & (rows < last))),
        }

    @property
    def _window(self) -> float:
        return self.settings.window_hours * HOUR

    def propagate(self, begin: int, parameters: np.ndarray, at: np.ndarray) -> np.ndarray:
        """Return parameters (7,) at an epoch `begin` carried to epochs `at`: (n, 7), lost ones not finite."""
        epochs = self.measured.epochs[np.append(begin, at)]
        arcs = fly_parameters(self.flight, epochs, parameters[None], np.array([0]), np.array([len(at)]))
        return np.column_stack([arcs.path(0), np.full(len(at), parameters[_CD])])

    def with_known_cd(self, solution: Solution) -> StartParameters | None:
        """Return what others may start from, had Cd been known beforehand at its a-priori value.

        A short fit may tell nothing of Cd, but the whole state. None where it did not converge, or its Cd is
        so far off that the state would not move in a straight line.
        """
        if not solution.converged:
            return None
        covariance, best = solution.covariance, solution.best
        missing = self.flight.rso.cd - best[_CD]
        if covariance[_CD, _CD] > 0.0:
            moved: np.ndarray = best + missing * covariance[:, _CD] / covariance[_CD, _CD]
        else:
            moved = best + missing * np.eye(7)[_CD]
        return (solution.at, moved) if np.linalg.norm((moved - best)[:3]) < LINEAR else None

    def newest(
        self, solutions: Sequence[Solution], usable: StartParameters | None, spare: StartParameters | None
    ) -> tuple[StartParameters | None, StartParameters | None]:
        """Return the newest usable and the newest spare start of solutions; without one, that given."""
        last_first = solutions[::-1]
        usable = next(((one.at, one.best) for one in last_first if self.is_usable(one)), usable)
        return usable, next((known for known in map(self.with_known_cd, last_first) if known), spare)


def in_turn(
    run: Run, method: Method, windows: Sequence[Window], *, earlier: Sequence[Solution] = ()
) -> Iterator[Estimate]:
    """Yield the fits over windows, batch after batch, each from what earlier ones tell."""
    usable, spare = run.newest(earlier, None, None)
    for begin in range(0, len(windows), BATCH):
        batch = windows[begin : begin + BATCH]
        estimates = run.fit_windows(batch, run.starts_in_turn(batch, usable, spare), [method] * len(batch))
        usable, spare = run.newest([estimate.solution for estimate in estimates], usable, spare)
        yield from estimates


def estimate_all(
    flight: Flight, starts: pd.DataFrame, measured: Measurements, *, settings: Estimation
) -> pd.DataFrame:
    """Return the `estimates` table: one row per track, converged or with the reason why not.

    flight: under the assumed model
    starts: the table, a state at each track's start for fits where no estimate is at hand
    """
    return with_noise(flight, starts, measured, settings=settings)[0]


def with_noise(
    flight: Flight, starts: pd.DataFrame, measured: Measurements, *, settings: Estimation
) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Return the `estimates` table as `estimate_all`, and what the fits tell of the noise, see `biases`."""
    run = Run.of_starts(flight, starts, measured, settings)
    windows = [run.window(track) for track in range(measured.tracks)]
    estimates: list[Estimate] = []
    for estimate in in_turn(run, run.method(run.free_parameters()), windows):
        estimates.append(estimate)
        if flight.progress:
            flight.progress(len(estimates) / len(windows))
    table = pd.DataFrame([run.row(estimate) for estimate in estimates])
    return table, biases.instrument_residuals(measured, estimates, run.residuals)


def estimate_further(
    flight: Flight,
    starts: pd.DataFrame,
    measured: Measurements,
    *,
    settings: Estimation,
    tracks: Sequence[int],
    earlier: pd.DataFrame,
) -> pd.DataFrame:
    """Return the rows of `estimates` of some tracks, ascending, as `estimate_all` does of all.

    earlier: rows of tracks before these that were estimated already, which fits may start from
    """
    run = Run.of_starts(flight, starts, measured, settings)
    windows = [run.window(track) for track in tracks]
    known = solutions(earlier, measured.at)
    found = in_turn(run, run.method(run.free_parameters()), windows, earlier=known)
    return pd.DataFrame([run.row(estimate) for estimate in found])
