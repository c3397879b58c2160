"""A first orbit for tracks that were measured, where no truth is known: the `starts` table.

It is carried from a known state, such as that of mean elements, or determined from the tracks: each track of
the first day gives a state by three positions on a curve through it (`three_positions`), which a fit to that
track alone improves. From the track whose fit knows its semi-major axis best, fits go on from track to track
until they fill a window. All fits hold Cd at its a-priori value.
"""

import logging

import numpy as np
import pandas as pd

from opml.base.constants import DAY, HOUR
from opml.base.errors import InputError
from opml.catalog.fit import start_states
from opml.catalog.fit.estimation import Estimate, Estimation, Run, fly_parameters
from opml.catalog.fit.least_squares import Fit
from opml.catalog.fit.measurements import Measurements
from opml.catalog.fit.three_positions import orbit_state
from opml.catalog.flight import Flight
from opml.catalog.simulate.truth import initial_state
from opml.orbits.sheets import Rso
from opml.tables import PARAMETERS

FARTHEST = 1000e3
"""How far tracks may be, in the median, from where a known state leads [m]; no fit finds back from there."""

FEWEST = 5
"""Measurements of a track that an orbit is determined from."""

SHORTEST = 30.0
"""Shortest track that an orbit is determined from [s]."""

_log = logging.getLogger(__name__)

TimedState = tuple[float, np.ndarray]
"""A time [s] and the GCRF state (6,) then [m, m/s]."""


def of_sheet(rso: Rso, gm: float) -> TimedState | None:
    """Return the osculating state of an RSO at the epoch; None where the RSO has no elements."""
    return (0.0, initial_state(rso, gm)) if np.isfinite(rso.a) else None


def starts(
    flight: Flight, measured: Measurements, *, known: TimedState | None, settings: Estimation
) -> pd.DataFrame:
    """Return the `starts` table of measured tracks: carried from a known state, or determined without one.

    Measurements that tell states themselves need neither.

    flight: under the assumed model. Raises InputError as `carried` and `determined` do.
    """
    flight = flight.without_progress()
    if known is None and measured.states is not None:
        times = _times(measured)
        return start_states.starts_table(times, measured.states, known=times.to_numpy())
    if known is None:
        return determined(flight, measured, settings=settings)
    return carried(flight, measured, known)


def carried(flight: Flight, measured: Measurements, known: TimedState) -> pd.DataFrame:
    """Return the `starts` table of a known state, flown under the assumed model to every track.

    Raises InputError where the first day's tracks are far from it.
    """
    rso, times, (t, start) = flight.rso, _times(measured), known
    states = everywhere(flight, times.to_numpy(), t, np.append(start, rso.cd))
    apart = measured.misses(measured.row_at, states[:, :3])
    miss = float(np.median(np.where(np.isfinite(apart), apart, np.inf)[_first_day(times)]))
    _log.info("first orbit: the given state is %.1f km from the first day's tracks", miss / 1e3)
    if not miss < FARTHEST:
        raise InputError(
            f"{rso.name}: expected tracks near the orbit of the given elements or state, "
            f"got tracks that are {miss / 1e3:.0f} km from it: another RSO, or another epoch"
        )
    return start_states.starts_table(times, states, known=t)


def determined(flight: Flight, measured: Measurements, *, settings: Estimation) -> pd.DataFrame:
    """Return the `starts` table of an orbit that is determined from the tracks alone.

    settings: of the fits. Raises InputError where no track of the first day gives an orbit.
    """
    rso, gm, times = flight.rso, flight.model.gm, _times(measured)
    run = Run(measured, flight, np.full((len(times), 6), np.nan), settings)
    alone = single_tracks(run)
    if not alone:
        raise InputError(
            f"{rso.name}: expected a track of at least {FEWEST} measurements over {SHORTEST:g} s, "
            "of two angles and the range, on the first day that gives an orbit, got none; "
            "give elements, or a TLE or OEM under starts"
        )
    best = min(alone, key=lambda estimate: axis_sigma(estimate.fit, gm))
    t, axis = measured.epochs[best.window.at], axis_sigma(best.fit, gm)
    _log.info("first orbit: of track %d at %.0f s, semi-major axis to %.0f m", best.window.track, t, axis)
    best = _grown(run, best)
    _log.info("first orbit: %d tracks fitted together", best.window.tracks)
    t = measured.epochs[best.window.at]
    states = everywhere(run.flight, times.to_numpy(), t, best.fit.best)
    return start_states.starts_table(times, states, known=t)


def single_tracks(run: Run) -> list[Estimate]:
    """Return the fits that converged, each to one track of the first day, from three positions on it."""
    measured = run.measured
    begun = []
    for track in np.flatnonzero(_first_day(measured.epochs[measured.at])):
        window = measured.window(int(track), 0.0)
        t, positions = measured.epochs[measured.epoch_of_row[window.rows]], measured.places(window.rows)
        is_known = np.isfinite(positions).all(axis=1)
        t, positions = t[is_known], positions[is_known]
        if len(np.unique(t)) < FEWEST or t[-1] - t[0] < SHORTEST:
            continue
        smooth = max(FEWEST, int(np.searchsorted(t, t[0] + measured.smooth_for, side="right")))
        middle, there = orbit_state(t[:smooth], positions[:smooth], run.flight.model.gm)
        at = measured.epochs[[window.at]]
        start = everywhere(run.flight, at, middle, np.append(there, run.flight.rso.cd))[0]
        begun.append(Estimate(window, Fit(np.append(start, run.flight.rso.cd), run.method(_without_cd()))))
    run.fit(begun)
    return [estimate for estimate in begun if estimate.fit.converged]


def axis_sigma(fit: Fit, gm: float) -> float:
    """Return the formal uncertainty of a fit's semi-major axis [m]; infinite where the orbit is open."""
    position, velocity = fit.best[:3], fit.best[3:6]
    radius, speed2 = float(np.linalg.norm(position)), float(velocity @ velocity)
    energy = 2.0 / radius - speed2 / gm
    if not energy > 0.0:
        return np.inf
    gradient = 2.0 / energy**2 * np.concatenate([position / radius**3, velocity / gm])
    return float(np.sqrt(gradient @ fit.covariance[:6, :6] @ gradient))


def _grown(run: Run, best: Estimate) -> Estimate:
    """Return the last fit of a series, each to one track more and from the last that converged.

    The series ends a window after `best`.
    """
    times = run.measured.epochs[run.measured.at]
    first, length = best.window.track, run.settings.window_hours * HOUR
    for track in np.flatnonzero((times > times[first]) & (times <= times[first] + length)):
        window = run.measured.window(int(track), times[track] - times[first])
        start = run.carried(best.window.at, best.fit.best, np.array([window.at]))[0]
        following = Estimate(window, Fit(start, run.method(_without_cd())))
        run.fit([following])
        best = following if following.fit.converged else best
    return best


def everywhere(flight: Flight, times: np.ndarray, t: float, parameters: np.ndarray) -> np.ndarray:
    """Return states (n, 6) at ascending times (n,) of an arc with parameters (7,) at t, NaN where lost."""
    states = np.where(times[:, None] == t, parameters[:6], np.nan)
    for side in (np.flatnonzero(times > t), np.flatnonzero(times < t)[::-1]):
        if side.size:
            epochs = np.append(t, times[side])
            arcs = fly_parameters(flight, epochs, parameters[None], np.array([0]), np.array([side.size]))
            states[side] = arcs.path(0)
    return states


def _times(measured: Measurements) -> pd.Series:
    """Return the epochs of the tracks' estimates [s], by their numbers: those of radars' begin then."""
    return pd.Series(measured.epochs[measured.at])


def _first_day(times: np.ndarray | pd.Series) -> np.ndarray:
    """Return which times of tracks are within a day of the first."""
    all_times = np.asarray(times)
    return np.asarray(all_times <= all_times[0] + DAY)


def _without_cd() -> np.ndarray:
    """Return which parameters (7,) are free: all but Cd."""
    return np.array([name != "cd" for name in PARAMETERS])
