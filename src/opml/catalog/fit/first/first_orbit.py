"""A first orbit for tracks that were measured, where no truth is known: the `starts` table.

It is carried from a known state, such as that of mean elements, or determined from the tracks: each track of
the first day with angles and ranges gives a state by three positions on a curve through it
(`three_positions`), which a fit to that track alone improves. From the track whose fit knows its semi-major
axis best, fits go on from track to track until they fill a window. Without ranges, `linked_tracks` are looked
for. All fits hold Cd at its a-priori value.
"""

import logging

import numpy as np
import pandas as pd

from opml.base.errors import InputError
from opml.catalog.fit import start_states
from opml.catalog.fit.estimate import Estimate
from opml.catalog.fit.estimation import Run
from opml.catalog.fit.estimation_settings import Estimation
from opml.catalog.fit.first.linked_tracks import orbit_of_angles
from opml.catalog.fit.first.three_positions import orbit_state
from opml.catalog.fit.first.track_fits import (
    axis_sigma,
    everywhere,
    first_windows,
    following,
    is_of_first_day,
    start_estimate,
    start_estimate_there,
)
from opml.catalog.fit.measurements import Measurements
from opml.catalog.propagator import Propagator
from opml.catalog.simulate.truth import initial_state
from opml.orbits.sheets import Rso

FARTHEST = 1000e3
"""Largest median distance of tracks from a known orbit [m] from which a fit converges."""

FEWEST = 5  # measurements of a track that an orbit is determined from
SHORTEST = 30.0  # shortest track that an orbit is determined from [s]

_log = logging.getLogger(__name__)

TimedState = tuple[float, np.ndarray]  # a time [s] and the GCRF state (6,) then [m, m/s]


def of_sheet(rso: Rso, gm: float) -> TimedState | None:
    """Return the osculating state of an RSO at the epoch; None where the RSO has no elements."""
    return (0.0, initial_state(rso, gm)) if np.isfinite(rso.a) else None


def starts(
    propagator: Propagator, measured: Measurements, *, known: TimedState | None, settings: Estimation
) -> pd.DataFrame:
    """Return the `starts` table of measured tracks: carried from a known state, or determined without one.

    Measurements that tell states themselves need neither.

    propagator: under the assumed model. Raises InputError as `starts_from_state` and `determined` do.
    """
    propagator = propagator.without_progress()
    if known is None and measured.states is not None:
        times = _times(measured)
        return start_states.starts_table(times, measured.states, known=times.to_numpy())
    if known is None:
        return determined(propagator, measured, settings=settings)
    return starts_from_state(propagator, measured, known)


def starts_from_state(propagator: Propagator, measured: Measurements, known: TimedState) -> pd.DataFrame:
    """Return the `starts` table of a known state, propagated with the assumed model to every track.

    Raises InputError where the first day's tracks are far from it.
    """
    rso, times, (t, start) = propagator.rso, _times(measured), known
    states = everywhere(propagator, times.to_numpy(), t, np.append(start, rso.cd))
    residuals = measured.distances(measured.first_row[:-1], states[:, :3])
    miss = float(
        np.median(np.where(np.isfinite(residuals), residuals, np.inf)[is_of_first_day(times.to_numpy())])
    )
    _log.info("first orbit: the given state is %.1f km from the first day's tracks", miss / 1e3)
    if not miss < FARTHEST:
        raise InputError(
            f"{rso.name}: expected tracks near the orbit of the given elements or state, "
            f"got tracks that are {miss / 1e3:.0f} km from it: another RSO, or another epoch"
        )
    return start_states.starts_table(times, states, known=t)


def determined(propagator: Propagator, measured: Measurements, *, settings: Estimation) -> pd.DataFrame:
    """Return the `starts` table of an orbit that is determined from the tracks alone.

    settings: of the fits. Raises InputError as `linked_tracks.orbit_of_angles` where no track of the first
    day has three positions.
    """
    times = _times(measured)
    states = np.full((len(times), 6), np.nan)
    run = Run(measured, propagator, states, np.empty(0), settings)
    alone = single_tracks(run)
    best = _grown(run, alone) if alone else orbit_of_angles(run)
    _log.info("first orbit: %d tracks fitted together", best.window.tracks)
    t = measured.epochs[best.window.at]
    states = everywhere(run.propagator, times.to_numpy(), t, best.fit.best)
    return start_states.starts_table(times, states, known=t)


def single_tracks(run: Run) -> list[Estimate]:
    """Return the fits that converged, each to one track of the first day, from three positions on it."""
    measured, gm, estimates = run.measured, run.propagator.model.gm, []
    for window in first_windows(measured):
        t, positions = measured.times(window.rows), measured.places(window.rows)
        is_known = np.isfinite(positions).all(axis=1)
        t, positions = t[is_known], positions[is_known]
        if len(np.unique(t)) < FEWEST or t[-1] - t[0] < SHORTEST:
            continue
        smooth = max(FEWEST, int(np.searchsorted(t, t[0] + measured.smooth_for, side="right")))
        estimates.append(start_estimate(run, window, *orbit_state(t[:smooth], positions[:smooth], gm)))
    run.fit(estimates)
    return [estimate for estimate in estimates if estimate.fit.converged]


def _grown(run: Run, alone: list[Estimate]) -> Estimate:
    """Return the last fit of a series, each to one track more and from the last that converged.

    It begins with the fit to a single track that knows the semi-major axis best.
    """
    gm = run.propagator.model.gm
    best = min(alone, key=lambda estimate: axis_sigma(estimate.fit, gm))
    t, axis = run.measured.epochs[best.window.at], axis_sigma(best.fit, gm)
    _log.info("first orbit: of track %d at %.0f s, semi-major axis to %.0f m", best.window.track, t, axis)
    for window in following(run, best.window):
        start = run.carry(best.window.at, best.fit.best, np.array([window.at]))[0]
        longer = start_estimate_there(run, window, start)
        run.fit([longer])
        best = longer if longer.fit.converged else best
    return best


def _times(measured: Measurements) -> pd.Series:
    """Return the epochs of the tracks' estimates [s], by their numbers: those of radars' begin then."""
    return pd.Series(measured.epochs[measured.at])
