"""Estimates of an RSO's state and drag coefficient by weighted batch least squares.

At the start of each track, all measurements of that track and of those that began in the window before it
are fitted under the assumed model (paper, sec. Estimation Models). A window may reach beyond the track, too:
such an estimate is smoothed and known later, which serves labels. The partial derivatives come from
neighbouring arcs: the nominal arc and seven that differ in one parameter fly as eight lanes of an ensemble,
so no variational equations are needed.
"""

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import pandas as pd

from opml.base.constants import HOUR
from opml.catalog.fit.least_squares import Evaluation, Fit, Method
from opml.catalog.fit.measurements import Measurements, Window
from opml.catalog.flight import Flight
from opml.dynamics.ensemble import REASONS, Arcs
from opml.tables import PARAMETER_COVARIANCES, PARAMETERS, STATE

BATCH = 16
"""Windows fitted side by side; each starts from the newest usable estimate before its batch.

No matter of the kernels' lanes, of which a window takes eight: more windows keep more threads busy, but start
from an older estimate.
"""

_CD = PARAMETERS.index("cd")
NUDGES = np.array([1.0, 1.0, 1.0, 1e-3, 1e-3, 1e-3, 1e-2])
"""Differences [m, m/s, -] of the neighbouring arcs: small against the orbit, large against rounding."""

_NEIGHBOURS = np.vstack([np.zeros(7), np.diag(NUDGES)])
"""The arcs of one evaluation, as differences from the nominal arc, which is the first."""

SCALES = np.array([1e3, 1e3, 1e3, 1.0, 1.0, 1.0, 1.0])
"""A-priori uncertainty [m, m/s, -] in which the damping measures a step."""

NO_START = "no orbit to start from"
"""Why a fit did not begin."""

LINEAR = 10e3
"""How far a state may be moved along its covariance [m], to where it would be had Cd been known."""

APRIORI_SIGMA = 0.5
"""Uncertainty of the sheet's Cd, as a part of it."""


@dataclass(frozen=True)
class Estimation:
    """Settings of the estimation.

    window_hours: measurements so long before a track are fitted with its own [h]
    max_iterations: of the least squares
    convergence: as in `least_squares.Method`
    start_position_sigma_m, start_velocity_sigma_mps: of the perturbed truth that a first fit starts from
    least_drag_m: displacement of a window per unit of Cd below which Cd is held at its a-priori value
    cd_bounds: Cd of an estimate that others may start from; None where its formal uncertainty decides
    after_hours: tracks that begin up to so long after the estimate are used, too [h]
    cd_sigma: standard deviation of Cd about its a-priori value; None where nothing is known beforehand
    light_time: measurements are read as received at their time, after the light's way down, not as geometric
    reject_sigma: numbers whose residuals are larger, in standard deviations, count no more; None: all count
    suspect_sigma: tracks farther from their predictions are held back, see `quarantine`; None: none is
    """

    window_hours: float
    max_iterations: int
    convergence: float
    start_position_sigma_m: float
    start_velocity_sigma_mps: float
    least_drag_m: float
    cd_bounds: tuple[float, float] | None = None
    after_hours: float = 0.0
    cd_sigma: float | None = None
    light_time: bool = False
    reject_sigma: float | None = None
    suspect_sigma: float | None = None


@dataclass(frozen=True)
class Estimate:
    """One track's estimate under way.

    kept: (numbers,) bool, which of the window's measured numbers count; None: all of them
    """

    window: Window
    fit: Fit
    kept: np.ndarray | None = None


_EDITS = 10
"""Times that outliers are looked for in a fit at most."""

_NORMAL = 0.6745
"""Median of the size of a normal deviate."""

Known = tuple[int, np.ndarray]
"""An epoch of a run's measurements, by its number, and the parameters (7,) of an orbit there."""


def _have_same_numbers(one: Estimate, other: Estimate) -> bool:
    """Return whether the same measured numbers count in two estimates of a window."""
    if one.kept is None or other.kept is None:
        return one.kept is other.kept
    return bool(np.array_equal(one.kept, other.kept))


def fly_parameters(
    flight: Flight, epochs: np.ndarray, parameters: np.ndarray, first: np.ndarray, last: np.ndarray
) -> Arcs:
    """Propagate arcs from parameters (arcs, 7) at epochs[first] to epochs[last]."""
    return flight.fly(epochs, parameters[:, :6], cd=parameters[:, _CD], first=first, last=last)


def fly_beside(flight: Flight, epochs: np.ndarray, parameters: np.ndarray) -> tuple[np.ndarray, int]:
    """Return (states of an arc and its neighbours, their worst status), as `fly_around`, forward in time.

    parameters: (7,) at the first epoch
    epochs: (n,) at which the states (8, n, 6) are wanted [s]
    """
    near = flight.for_neighbours()
    states, status = _fly_forward(near, epochs, parameters + _NEIGHBOURS)
    if near is flight:
        return states, status
    nominal, lost = _fly_forward(flight, epochs, parameters[None])
    return states + (nominal - states[:1]), max(status, lost)


def _fly_forward(flight: Flight, epochs: np.ndarray, parameters: np.ndarray) -> tuple[np.ndarray, int]:
    """Return (states (arcs, n, 6), worst status) of arcs from parameters (arcs, 7) through all epochs."""
    count = len(parameters)
    arcs = fly_parameters(flight, epochs, parameters, np.zeros(count, int), np.full(count, len(epochs) - 1))
    later = arcs.states.reshape(count, len(epochs) - 1, 6)
    return np.concatenate([parameters[:, None, :6], later], axis=1), int(arcs.status.max())


def fly_around(
    flight: Flight, epochs: np.ndarray, estimates: Sequence[Estimate]
) -> tuple[list[np.ndarray], np.ndarray]:
    """Return (states of each trial and its neighbours, their worst status).

    The states are (8, epochs, 6) GCRF [m, m/s] at the epochs of the window; the status is an index into
    REASONS.

    In a large field the trials alone fly under all of it. Two-day fits of Swarm A under 70x70 then have the
    same answers to 0.0004 of their sigma, in 43 % of the time.
    """
    windows = [estimate.window for estimate in estimates]
    trials = np.array([estimate.fit.trial for estimate in estimates])
    near = flight.for_neighbours()
    states, status = _fly_neighbours(near, epochs, trials, windows)
    if near is flight:
        return states, status
    nominal, lost = _fly_windows(flight, epochs, trials, windows)
    moved = [arcs + (path - arcs[0]) for arcs, path in zip(states, nominal, strict=True)]
    return moved, np.maximum(status, lost)


def _fly_neighbours(
    flight: Flight, epochs: np.ndarray, trials: np.ndarray, windows: Sequence[Window]
) -> tuple[list[np.ndarray], np.ndarray]:
    """Return states and status as `fly_around`, of trials (n, 7) and their neighbours under one field."""
    count = len(_NEIGHBOURS)
    lanes = (trials[:, None] + _NEIGHBOURS).reshape(-1, 7)
    paths, status = _fly_windows(flight, epochs, lanes, [window for window in windows for _ in range(count)])
    states = [np.stack(paths[k : k + count]) for k in range(0, len(paths), count)]
    return states, status.reshape(-1, count).max(axis=1)


def _fly_windows(
    flight: Flight, epochs: np.ndarray, parameters: np.ndarray, windows: Sequence[Window]
) -> tuple[list[np.ndarray], np.ndarray]:
    """Return (states (epochs, 6) of each window, status) of arcs from parameters (n, 7)."""
    first, at, last = (
        np.array([getattr(window, name) for window in windows]) for name in ("first", "at", "last")
    )
    newest = len(epochs) - 1
    forward = fly_parameters(flight, epochs, parameters, at, last)
    backward = fly_parameters(flight, epochs[::-1], parameters, newest - at, newest - first)
    paths = [
        np.vstack([backward.path(k)[::-1], parameters[k : k + 1, :6], forward.path(k)])
        for k in range(len(parameters))
    ]
    return paths, np.maximum(forward.status, backward.status)


@dataclass(frozen=True)
class Run:
    """All that the windows of a run share.

    flight: under the assumed model
    starts: (tracks, 6) GCRF states at the tracks' starts
    ages: (tracks,) how long before each start its orbit was known [s]
    """

    measured: Measurements
    flight: Flight
    starts: np.ndarray
    settings: Estimation
    ages: np.ndarray = field(default_factory=lambda: np.empty(0))

    def method(self, free: np.ndarray) -> Method:
        """Return how the parameters that are free (7,) are fitted."""
        return Method(SCALES, free, self.settings.convergence)

    def free_parameters(self) -> np.ndarray:
        """Return which parameters (7,) are estimated: not Cd where no window can show it, as in high orbits.

        A short track leaves Cd as uncertain, but there the orbit has drag, and the fit says so.
        """
        begin = self.measured.epochs[self.measured.at[0]]
        start = np.append(self.starts[0], self.flight.rso.cd)
        pair = np.stack([start, start + np.eye(7)[_CD]])
        epochs = np.array([begin, begin + self._window])
        flown = fly_parameters(self.flight, epochs, pair, np.zeros(2, int), np.ones(2, int)).states[:, :3]
        free = np.ones(7, bool)
        # An arc that comes down on the way has no displacement, and feels drag all the more.
        free[_CD] = not np.linalg.norm(flown[1] - flown[0]) < self.settings.least_drag_m
        return free

    def window(self, track: int, *, without: Collection[int] = ()) -> Window:
        """Return the window of the settings at a track; `without`: tracks that are left out."""
        after = self.settings.after_hours * HOUR
        return self.measured.window(track, self._window, after, without=without)

    def fitted(
        self,
        windows: Sequence[Window],
        usable: Known | None,
        spare: Known | None,
        method: Method,
    ) -> list[Estimate]:
        """Return estimates over `windows`, each from the best start that its arc can be flown from.

        usable: of the newest estimate whose Cd is known
        spare: of the newest estimate that has a state at least
        """
        estimates = [Estimate(window, Fit(np.full(7, np.nan), method)) for window in windows]
        for starts in self._starts_in_turn(windows, usable, spare):
            waiting = [
                k
                for k, estimate in enumerate(estimates)
                if not estimate.fit.started and np.all(np.isfinite(starts[k]))
            ]
            for k in waiting:
                estimates[k] = Estimate(windows[k], Fit(starts[k], method))
            for k, estimate in zip(waiting, self.ended([estimates[k] for k in waiting]), strict=True):
                estimates[k] = estimate
            if all(estimate.fit.started for estimate in estimates):
                break
        for estimate in estimates:
            if estimate.fit.running and not estimate.fit.started:
                estimate.fit.reject(NO_START)
        return estimates

    def _starts_in_turn(
        self, windows: Sequence[Window], usable: Known | None, spare: Known | None
    ) -> Iterator[np.ndarray]:
        """Yield parameters (windows, 7) to start from, the best first; not finite where there are none.

        First those of the newest usable estimate, carried to each track's start; then the newer of the state
        in `starts` and the spare estimate; then the older.
        """
        at = np.array([window.at for window in windows])
        if usable is not None:
            yield self.carried(*usable, at)
        tracks = [window.track for window in windows]
        first = np.column_stack([self.starts[tracks], np.full(len(tracks), self.flight.rso.cd)])
        if spare is None:
            yield first
            return
        kept, epochs = self.carried(*spare, at), self.measured.epochs
        is_newer = (epochs[at] - epochs[spare[0]] < self.ages[tracks])[:, None]
        yield np.where(is_newer, kept, first)
        yield np.where(is_newer, first, kept)

    def ended(self, estimates: Sequence[Estimate]) -> Sequence[Estimate]:
        """Return estimates whose fits have ended, without outliers where the settings reject them."""
        if self.settings.reject_sigma is not None:
            return self.edited(estimates)
        self.fit(estimates)
        return estimates

    def fit(self, estimates: Sequence[Estimate]) -> None:
        """Iterate all fits side by side until they end, or the settings' number of iterations is reached."""
        for _ in range(self.settings.max_iterations):
            running = [estimate for estimate in estimates if estimate.fit.running]
            if not running:
                break
            paths, status = fly_around(self.flight, self.measured.epochs, running)
            for estimate, states, lost in zip(running, paths, status, strict=True):
                if lost:
                    estimate.fit.reject(f"start arc {REASONS[lost]}")
                else:
                    estimate.fit.take(self._evaluation(estimate, states))

    def _evaluation(self, estimate: Estimate, states: np.ndarray) -> Evaluation:
        """Return the evaluation of a trial, from states (8, epochs, 6) of its arc and the neighbours."""
        light_time = self.settings.light_time
        evaluation = self.measured.evaluation(estimate.window, states, light_time=light_time)
        if estimate.kept is not None:
            evaluation = Evaluation(evaluation.residuals[estimate.kept], evaluation.jacobian[estimate.kept])
        return self.with_apriori_cd(evaluation, estimate.fit.trial)

    def residuals(self, estimates: Sequence[Estimate]) -> list[np.ndarray]:
        """Return the weighted residuals (numbers,) of all in the window of each estimate, at its best."""
        ended = [replace(one, fit=Fit(one.fit.best, one.fit.method)) for one in estimates]
        paths, _ = fly_around(self.flight, self.measured.epochs, ended)
        light_time = self.settings.light_time
        return [
            self.measured.evaluation(one.window, states, light_time=light_time).residuals
            for one, states in zip(ended, paths, strict=True)
        ]

    def edited(self, estimates: Sequence[Estimate]) -> list[Estimate]:
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
        _, observables = self.measured.held(window.rows)
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

    def is_usable(self, estimate: Estimate) -> bool:
        """Whether others may start from an estimate: converged, with Cd within the bounds or well determined.

        A fit of one short track may converge on a Cd of thousands, from which no other would find back.
        """
        if not estimate.fit.converged:
            return False
        if self.settings.cd_bounds is None:
            return bool(estimate.fit.covariance[_CD, _CD] < SCALES[_CD] ** 2)
        low, high = self.settings.cd_bounds
        return bool(low <= estimate.fit.best[_CD] <= high)

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
        rows = window.index[self.measured.held(window.rows)[0]]
        return {
            "rejected": int(np.count_nonzero(~kept)),
            "rejected_of_track": int(np.count_nonzero(~kept & (rows >= first) & (rows < last))),
        }

    @property
    def _window(self) -> float:
        return self.settings.window_hours * HOUR

    def carried(self, begin: int, parameters: np.ndarray, at: np.ndarray) -> np.ndarray:
        """Return parameters (7,) at an epoch `begin` carried to epochs `at`: (n, 7), lost ones not finite."""
        epochs = self.measured.epochs[np.append(begin, at)]
        arcs = fly_parameters(self.flight, epochs, parameters[None], np.array([0]), np.array([len(at)]))
        return np.column_stack([arcs.path(0), np.full(len(at), parameters[_CD])])

    def known(self, estimate: Estimate) -> Known:
        """Return what others may start from."""
        return estimate.window.at, estimate.fit.best

    def with_known_cd(self, estimate: Estimate) -> Known | None:
        """Return what others may start from, had Cd been known beforehand at its a-priori value.

        A short fit may tell nothing of Cd, but the whole state. None where it did not converge, or its Cd is
        so far off that the state would not move in a straight line.
        """
        if not estimate.fit.converged:
            return None
        covariance, best = estimate.fit.covariance, estimate.fit.best
        missing = self.flight.rso.cd - best[_CD]
        if covariance[_CD, _CD] > 0.0:
            moved: np.ndarray = best + missing * covariance[:, _CD] / covariance[_CD, _CD]
        else:
            moved = best + missing * np.eye(7)[_CD]
        return (estimate.window.at, moved) if np.linalg.norm((moved - best)[:3]) < LINEAR else None


def in_turn(run: Run, method: Method, windows: Sequence[Window]) -> Iterator[Estimate]:
    """Yield the fits over windows, batch after batch, each from what the batches before it tell."""
    usable: Known | None = None
    spare: Known | None = None
    for begin in range(0, len(windows), BATCH):
        estimates = run.fitted(windows[begin : begin + BATCH], usable, spare, method)
        newest = estimates[::-1]
        usable = next((run.known(estimate) for estimate in newest if run.is_usable(estimate)), usable)
        spare = next((known for known in map(run.with_known_cd, newest) if known), spare)
        yield from estimates


def estimate_all(
    flight: Flight, starts: pd.DataFrame, measured: Measurements, *, settings: Estimation
) -> pd.DataFrame:
    """Return the `estimates` table: one row per track, converged or with the reason why not.

    flight: under the assumed model
    starts: the table, a state at each track's start for fits where no estimate is at hand
    """
    run = Run(
        measured, flight.without_progress(), starts[STATE].to_numpy(), settings, starts["age"].to_numpy()
    )
    windows = [run.window(track) for track in range(measured.tracks)]
    rows: list[dict[str, Any]] = []
    for estimate in in_turn(run, run.method(run.free_parameters()), windows):
        rows.append(run.row(estimate))
        if flight.progress:
            flight.progress(len(rows) / measured.tracks)
    return pd.DataFrame(rows)
