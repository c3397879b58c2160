"""Estimates of an RSO's state and drag coefficient by weighted batch least squares.

At the start of each track, all measurements of that track and of those that began in the window
before it are fitted under the assumed model (paper, sec. Estimation Models). The partial derivatives
come from neighbouring arcs: the nominal one and seven that differ in one parameter fly as eight
lanes of an ensemble, so no variational equations are needed.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from opml.catalog.observing import observe, site
from opml.catalog.tracking import QUANTITIES
from opml.catalog.truth import STATE
from opml.dynamics.ensemble import REASONS, Integrator, propagate
from opml.dynamics.frames import gcrf_to_itrf
from opml.dynamics.surroundings import Tables
from opml.elements import wrap_half_turn
from opml.seeds import derive
from opml.sheets import Rso, Station

PARAMETERS = [*STATE, "cd"]
COVARIANCES = [f"cov_{a}_{b}" for k, a in enumerate(PARAMETERS) for b in PARAMETERS[: k + 1]]

BATCH = 16
"""Windows fitted side by side; each starts from the newest usable estimate before its batch."""

_NUDGES = np.array([1.0, 1.0, 1.0, 1e-3, 1e-3, 1e-3, 1e-2])
"""Differences [m, m/s, -] of the neighbouring arcs: small against the orbit, large against rounding."""

_SCALES = np.array([1e3, 1e3, 1e3, 1.0, 1.0, 1.0, 1.0])
"""A-priori uncertainty [m, m/s, -] in which the damping measures a step."""

_FELT = np.array([True] * 6 + [False])
"""The parameters that every orbit shows; the drag coefficient is the last."""

_FIRST_DAMPING = 1e-3
_LEAST_DAMPING = 1e-12
_MOST_DAMPING = 1e12

NOT_CONVERGED = "not converged"
UNDERDETERMINED = "fewer measurements than parameters"
NO_FIT = "no step lowers the residuals"


@dataclass
class _Fit:
    """One window's least squares under way."""

    track: int
    first: int  # epoch of the oldest measurement, an index into the run's epochs
    at: int  # epoch of the estimate
    last: int  # epoch of the newest measurement
    rows: slice  # the window's measurements
    tracks: int
    best: np.ndarray  # parameters with the lowest cost so far
    trial: np.ndarray
    cost: float = np.inf
    normal: np.ndarray | None = None
    gradient: np.ndarray | None = None
    left: float = 0.0  # what the full step moves, in formal uncertainties
    damping: float = _FIRST_DAMPING
    iterations: int = 0  # of flying trials
    converged: bool = False
    reason: str = NOT_CONVERGED
    running: bool = True


def estimate_all(
    tables: Tables,
    truth: pd.DataFrame,
    tracking: pd.DataFrame,
    earth_orientation: pd.DataFrame,
    stations: Sequence[Station],
    rso: Rso,
    *,
    settings: Mapping[str, float],
    integrator: Integrator,
    seed: int,
    threads: int = 1,
    progress: Callable[[float], None] | None = None,
) -> pd.DataFrame:
    """The `estimates` table: one row a track, converged or with the reason why not.

    tables: the assumed model, from `forces.build`; truth: only to start where no estimate is at
    hand; tracking: the measurements; stations: `sheets.Station`s; rso: `sheets.Rso`; settings:
    window_hours, max_iterations, convergence (part of the formal uncertainty that a last step may
    still move), start_position_sigma_m and start_velocity_sigma_mps of the perturbed truth,
    least_drag_m (displacement of a window per unit of Cd below which Cd is left at its a-priori
    value), cd_min and cd_max of an estimate that others may start from.
    """
    problem = _Problem(tables, tracking, earth_orientation, stations, rso, integrator, threads)
    problem.hold_unfelt_drag(truth, settings)
    rows, usable = [], None
    for begin in range(0, problem.tracks, BATCH):
        members = range(begin, min(begin + BATCH, problem.tracks))
        starts = problem.starts(members, usable, truth, settings, seed)
        fits = [problem.window(track, start, settings) for track, start in zip(members, starts, strict=True)]
        for _ in range(settings["max_iterations"]):
            running = [fit for fit in fits if fit.running]
            if not running:
                break
            problem.iterate(running, settings["convergence"])
        for fit in fits:
            rows.append(problem.row(fit))
            if fit.converged and settings["cd_min"] <= fit.best[6] <= settings["cd_max"]:
                usable = fit
        if progress:
            progress(members[-1] / problem.tracks)
    return pd.DataFrame(rows)


class _Problem:
    """Measurements, stations and dynamics of a run, and the steps of its least squares."""

    def __init__(self, tables, tracking, earth_orientation, stations, rso, integrator, threads):
        self.tables, self.rso, self.integrator, self.threads = tables, rso, integrator, threads
        self.epochs, self.epoch_of_row = np.unique(tracking["t"].to_numpy(), return_inverse=True)
        self.rotations = gcrf_to_itrf(earth_orientation, self.epochs)
        self.measured = tracking[QUANTITIES].to_numpy()
        places = {station.name: (*site(station), station) for station in stations}
        of_row = [places[name] for name in tracking["station"]]
        self.positions = np.array([place[0] for place in of_row])
        self.to_horizon = np.array([place[1] for place in of_row])
        self.sigmas = np.array(
            [[s.sigma_azimuth, s.sigma_elevation, s.sigma_range] for s in (place[2] for place in of_row)]
        )
        self.free = np.ones(7, bool)
        track = tracking["track"].to_numpy()
        self.first_row = np.searchsorted(track, np.arange(track[-1] + 2))
        self.tracks = len(self.first_row) - 1
        self.begins = self.epoch_of_row[self.first_row[:-1]]
        self.ends = self.epoch_of_row[self.first_row[1:] - 1]

    def hold_unfelt_drag(self, truth, settings):
        """Leave Cd out of the steps where an orbit is too high for a window of drag to show it.

        A short track leaves Cd as uncertain as that, but there the orbit has drag, and the fit says so.
        """
        begin = self.epochs[self.begins[0]]
        state = truth.set_index("t")[STATE].loc[begin].to_numpy()
        pair = np.stack([np.append(state, self.rso.cd), np.append(state, self.rso.cd + 1.0)])
        epochs = np.array([begin, begin + settings["window_hours"] * 3600.0])
        flown = self._propagate(epochs, pair, np.zeros(2, int), np.ones(2, int)).states[:, :3]
        if np.linalg.norm(flown[1] - flown[0]) < settings["least_drag_m"]:
            self.free = _FELT

    def window(self, track, start, settings):
        """The fit at the start of a track: its measurements and those of the tracks in the window before."""
        begin = self.epochs[self.begins[track]]
        oldest = np.searchsorted(self.epochs[self.begins], begin - settings["window_hours"] * 3600.0)
        return _Fit(
            track=track,
            first=self.begins[oldest],
            at=self.begins[track],
            last=self.ends[track],
            rows=slice(self.first_row[oldest], self.first_row[track + 1]),
            tracks=track + 1 - oldest,
            best=start,
            trial=start,
        )

    def starts(self, members, usable, truth, settings, seed):
        """Parameters to start the fits from: the newest usable estimate, carried to each track's start.

        Where there is none, or it does not last, the perturbed truth stands in for an initial orbit
        determination, with the drag coefficient at its a-priori value.
        """
        at = self.begins[list(members)]
        carried = np.full((len(at), 6), np.nan)
        if usable is not None:
            epochs = np.concatenate([[self.epochs[usable.at]], self.epochs[at]])
            arcs = self._propagate(epochs, usable.best[None], np.array([0]), np.array([len(at)]))
            carried = arcs.of(0)
        states = truth.set_index("t")[STATE]
        sigmas = np.repeat([settings["start_position_sigma_m"], settings["start_velocity_sigma_mps"]], 3)
        starts = []
        for track, epoch, state in zip(members, at, carried, strict=True):
            if np.all(np.isfinite(state)):
                starts.append(np.append(state, usable.best[6]))
            else:
                noise = derive(seed, "start", self.rso.name, str(track)).normal(size=6) * sigmas
                starts.append(np.append(states.loc[self.epochs[epoch]].to_numpy() + noise, self.rso.cd))
        return starts

    def iterate(self, fits, convergence):
        """Try each fit's next parameters: keep them where the residuals fall, else damp the step more."""
        residuals, jacobians, status = self._linearise(fits)
        for k, fit in enumerate(fits):
            fit.iterations += 1
            cost = np.sum(residuals[k] ** 2) if residuals[k] is not None else np.inf
            if cost <= fit.cost and np.isfinite(cost):
                fit.best, fit.cost = fit.trial, cost
                fit.normal = jacobians[k].T @ jacobians[k]
                fit.gradient = jacobians[k].T @ residuals[k]
                fit.damping = max(0.1 * fit.damping, _LEAST_DAMPING)
            elif fit.normal is None:
                fit.running, fit.reason = False, f"start arc {REASONS[status[k]]}"
                continue
            else:
                fit.damping *= 10.0
            self._step(fit, convergence)

    def _step(self, fit, convergence):
        """Set the fit's next trial by a damped step, or end it."""
        if fit.rows.stop - fit.rows.start < 3:
            fit.running, fit.reason = False, UNDERDETERMINED
            return
        if fit.damping > _MOST_DAMPING:
            fit.running, fit.reason = False, NO_FIT
            return
        # What is left to go is the full step's length, as damping alone can make a step short.
        full = self._solve(fit, _LEAST_DAMPING)
        before, fit.left = fit.left, np.sqrt(fit.gradient @ full)
        if fit.left < convergence:
            fit.running, fit.converged, fit.reason = False, True, ""
            return
        step = self._solve(fit, fit.damping)
        fit.trial = fit.best + step
        # Steps shrink ever faster near the end. Where this one, by the rate of the last and with what damping
        # takes off it, ends below the limit, flying it would only confirm it.
        short = np.sqrt(max(0.0, (full - step) @ fit.normal @ (full - step)))
        if fit.left**2 < (convergence - short) * before:
            fit.best, fit.cost = fit.trial, max(0.0, fit.cost - fit.left**2)
            fit.running, fit.converged, fit.reason = False, True, ""

    def _solve(self, fit, damping):
        """The damped step (7,) from the best parameters; a parameter that is held does not move."""
        free, scales = self.free, _SCALES[self.free]
        damped = fit.normal[np.ix_(free, free)] * np.outer(scales, scales) + damping * np.eye(free.sum())
        step = np.zeros(7)
        step[free] = scales * np.linalg.solve(damped, scales * fit.gradient[free])
        return step

    def _propagate(self, epochs, parameters, first, last):
        return propagate(
            self.tables,
            epochs,
            parameters[:, :6],
            first=first,
            last=last,
            ballistic=parameters[:, 6] * self.rso.area_to_mass,
            reflection=np.full(len(parameters), self.rso.cr * self.rso.area_to_mass),
            integrator=self.integrator,
            threads=self.threads,
        )

    def _linearise(self, fits):
        """Weighted residuals, Jacobians and status of the fits' trials; None where an arc was lost."""
        lanes = np.concatenate([fit.trial + np.vstack([np.zeros(7), np.diag(_NUDGES)]) for fit in fits])
        at = np.repeat([fit.at for fit in fits], 8)
        newest = len(self.epochs) - 1
        forward = self._propagate(self.epochs, lanes, at, np.repeat([fit.last for fit in fits], 8))
        backward = self._propagate(
            self.epochs[::-1], lanes, newest - at, newest - np.repeat([fit.first for fit in fits], 8)
        )
        residuals, jacobians, status = [], [], []
        for k, fit in enumerate(fits):
            members = range(8 * k, 8 * k + 8)
            states = np.stack(
                [np.vstack([backward.of(m)[::-1], lanes[m : m + 1, :6], forward.of(m)]) for m in members]
            )
            lost = np.maximum(forward.status[list(members)], backward.status[list(members)])
            status.append(lost.max())
            if lost.any() or not np.all(np.isfinite(states)):
                residuals.append(None)
                jacobians.append(None)
                continue
            residual, jacobian = self._residuals(fit, states)
            residuals.append(residual)
            jacobians.append(jacobian)
        return residuals, jacobians, status

    def _residuals(self, fit, states):
        """Weighted residuals (3 rows,) and their Jacobian (3 rows, 7) from the states of eight lanes."""
        epoch = self.epoch_of_row[fit.rows]
        positions = np.einsum("nij,lnj->lni", self.rotations[epoch], states[:, epoch - fit.first, :3])
        place = self.positions[fit.rows], self.to_horizon[fit.rows]
        residual = self.measured[fit.rows] - observe(positions[0], *place)
        residual[:, 0] = wrap_half_turn(residual[:, 0])
        # Each neighbour and its mirror image about the nominal arc: by then a nudge has grown to a hundred
        # metres, over which the measurements bend, and the bend cancels.
        shift = positions[1:] - positions[0]
        change = observe(positions[0] + shift, *place) - observe(positions[0] - shift, *place)
        change[..., 0] = wrap_half_turn(change[..., 0])
        weighted = 0.5 * change / self.sigmas[fit.rows] / _NUDGES[:, None, None]
        return (residual / self.sigmas[fit.rows]).ravel(), weighted.reshape(7, -1).T

    def _covariance(self, fit):
        """Formal covariance (7, 7) of a fit; a parameter that was held has none."""
        if fit.normal is None:
            return np.full((7, 7), np.nan)
        covariance = np.zeros((7, 7))
        free, scales = np.ix_(self.free, self.free), np.outer(_SCALES[self.free], _SCALES[self.free])
        covariance[free] = np.linalg.inv(fit.normal[free] * scales + _LEAST_DAMPING * np.eye(self.free.sum()))
        covariance[free] *= scales
        return covariance

    def row(self, fit):
        """The fit as a row of the table."""
        count = fit.rows.stop - fit.rows.start
        lower = self._covariance(fit)[np.tril_indices(7)]
        return {
            "track": fit.track,
            "t": self.epochs[fit.at],
            **dict(zip(PARAMETERS, fit.best, strict=True)),
            **dict(zip(COVARIANCES, lower, strict=True)),
            "iterations": fit.iterations,
            "converged": fit.converged,
            "reason": fit.reason,
            "tracks_used": fit.tracks,
            "measurements_used": count,
            "weighted_rms": np.sqrt(fit.cost / (3.0 * count)) if np.isfinite(fit.cost) else np.nan,
        }
