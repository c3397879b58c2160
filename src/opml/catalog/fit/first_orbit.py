"""A first orbit for tracks that were measured, where no truth is known: the `starts` table.

It is carried from a state that is given, such as one from mean elements, or determined from the tracks: each
of the first day gives a state by three positions on a curve through it (`three_positions`), which a fit to
that track alone improves. From the one that knows its semi-major axis best, fits go on from track to track
until they fill a window. All of them hold Cd at its a-priori value.
"""

import logging
from collections.abc import Sequence

import numpy as np
import pandas as pd

from opml.base.constants import DAY, HOUR
from opml.base.errors import InputError
from opml.catalog.fit import start_states
from opml.catalog.fit.estimation import Estimate, Estimation, Flight, Measured, Run
from opml.catalog.fit.least_squares import Fit
from opml.catalog.fit.three_positions import state
from opml.catalog.simulate.observing import place
from opml.catalog.simulate.truth import initial_state
from opml.dynamics.ensemble import Integrator
from opml.dynamics.kernels.surroundings import ForceModel
from opml.orbits.sheets import Rso, Station
from opml.tables import PARAMETERS

FARTHEST = 1000e3
"""How far tracks may be, in the median, from where a given state leads [m]; no fit finds back from there."""

FEWEST = 5
"""Measurements of a track that an orbit is determined from."""

SHORTEST = 30.0
"""Shortest track that an orbit is determined from [s]."""

_log = logging.getLogger(__name__)


def of_sheet(rso: Rso, gm: float) -> tuple[float, np.ndarray] | None:
    """Time [s] and GCRF state (6,) of an RSO's osculating elements at the epoch; None where it has none."""
    return (0.0, initial_state(rso, gm)) if np.isfinite(rso.a) else None


def starts(
    model: ForceModel,
    tracking: pd.DataFrame,
    earth_orientation: pd.DataFrame,
    stations: Sequence[Station],
    rso: Rso,
    *,
    given: tuple[float, np.ndarray] | None,
    settings: Estimation,
    integrator: Integrator,
    threads: int = 1,
) -> pd.DataFrame:
    """The `starts` table of measured tracks: carried from a time and state if given, determined else.

    model: the assumed one. Raises InputError as `carried` and `determined` do.
    """
    measured = model, tracking, earth_orientation, stations, rso
    if given is None:
        return determined(*measured, settings=settings, integrator=integrator, threads=threads)
    return carried(*measured, t=given[0], given=given[1], integrator=integrator)


def carried(
    model: ForceModel,
    tracking: pd.DataFrame,
    earth_orientation: pd.DataFrame,
    stations: Sequence[Station],
    rso: Rso,
    *,
    t: float,
    given: np.ndarray,
    integrator: Integrator,
) -> pd.DataFrame:
    """The `starts` table of a state (6,) in GCRF at `t` [s], flown under the assumed model to every track.

    Raises InputError where the first day's tracks are far from it.
    """
    flight, begins = Flight(model, rso, integrator, 1), tracking.groupby("track")["t"].min()
    states = _everywhere(flight, begins.to_numpy(), t, np.append(given, rso.cd))
    first = tracking.loc[tracking.groupby("track")["t"].idxmin()]
    measured = Measured(first, earth_orientation, stations)
    apart = np.linalg.norm(_places(measured, slice(None)) - states[:, :3], axis=1)
    miss = float(np.median(np.where(np.isfinite(apart), apart, np.inf)[_first_day(begins)]))
    _log.info("first orbit: the given state is %.1f km from the first day's tracks", miss / 1e3)
    if not miss < FARTHEST:
        raise InputError(
            f"{rso.name}: expected tracks near the orbit of the given elements or state, "
            f"got tracks that are {miss / 1e3:.0f} km from it: another RSO, or another epoch"
        )
    return start_states.table(begins, states, known=t)


def determined(
    model: ForceModel,
    tracking: pd.DataFrame,
    earth_orientation: pd.DataFrame,
    stations: Sequence[Station],
    rso: Rso,
    *,
    settings: Estimation,
    integrator: Integrator,
    threads: int = 1,
) -> pd.DataFrame:
    """The `starts` table of an orbit that is determined from the tracks alone.

    settings: of the fits. Raises InputError where no track of the first day gives an orbit.
    """
    begins = tracking.groupby("track")["t"].min()
    run = Run(
        Measured(tracking, earth_orientation, stations, light_time=settings.light_time),
        Flight(model, rso, integrator, threads),
        np.full((len(begins), 6), np.nan),
        settings,
    )
    alone = single_tracks(run)
    if not alone:
        raise InputError(
            f"{rso.name}: expected a track of at least {FEWEST} measurements over {SHORTEST:g} s "
            "on the first day that gives an orbit, got none; give elements, or a TLE or OEM under starts"
        )
    best = min(alone, key=lambda one: axis_sigma(one.fit, model.gm))
    t, axis = run.measured.epochs[best.window.at], axis_sigma(best.fit, model.gm)
    _log.info("first orbit: of track %d at %.0f s, semi-major axis to %.0f m", best.window.track, t, axis)
    best = _grown(run, best)
    _log.info("first orbit: %d tracks fitted together", best.window.tracks)
    t = run.measured.epochs[best.window.at]
    states = _everywhere(run.flight, begins.to_numpy(), t, best.fit.best)
    return start_states.table(begins, states, known=t)


def single_tracks(run: Run) -> list[Estimate]:
    """Fits that converged, each to one track of the first day, from three positions on it."""
    measured = run.measured
    begun = []
    for track in np.flatnonzero(_first_day(measured.epochs[measured.begins])):
        window = measured.window(int(track), 0.0)
        t, positions = measured.epochs[measured.epoch_of_row[window.rows]], _places(measured, window.rows)
        if len(np.unique(t)) < FEWEST or t[-1] - t[0] < SHORTEST:
            continue
        middle, found = state(t, positions, run.flight.model.gm)
        start = _everywhere(run.flight, t[:1], middle, np.append(found, run.flight.rso.cd))[0]
        begun.append(Estimate(window, Fit(np.append(start, run.flight.rso.cd), run.method(_without_cd()))))
    run.fit(begun)
    return [one for one in begun if one.fit.converged]


def axis_sigma(fit: Fit, gm: float) -> float:
    """Formal uncertainty of a fit's semi-major axis [m]; infinite where the orbit is not closed."""
    position, velocity = fit.best[:3], fit.best[3:6]
    radius, speed2 = float(np.linalg.norm(position)), float(velocity @ velocity)
    energy = 2.0 / radius - speed2 / gm
    if not energy > 0.0:
        return np.inf
    gradient = 2.0 / energy**2 * np.concatenate([position / radius**3, velocity / gm])
    return float(np.sqrt(gradient @ fit.covariance[:6, :6] @ gradient))


def _grown(run: Run, best: Estimate) -> Estimate:
    """The fit after those of the next tracks, each from the last that converged, up to a window later."""
    begins = run.measured.epochs[run.measured.begins]
    first, length = best.window.track, run.settings.window_hours * HOUR
    for track in np.flatnonzero((begins > begins[first]) & (begins <= begins[first] + length)):
        window = run.measured.window(int(track), begins[track] - begins[first])
        start = run.carried(best.window.at, best.fit.best, np.array([window.at]))[0]
        following = Estimate(window, Fit(start, run.method(_without_cd())))
        run.fit([following])
        best = following if following.fit.converged else best
    return best


def _everywhere(flight: Flight, times: np.ndarray, t: float, parameters: np.ndarray) -> np.ndarray:
    """States (n, 6) at ascending times (n,) of an arc with parameters (7,) at t, not finite where lost."""
    states = np.where(times[:, None] == t, parameters[:6], np.nan)
    for side in (np.flatnonzero(times > t), np.flatnonzero(times < t)[::-1]):
        if side.size:
            epochs = np.append(t, times[side])
            arcs = flight.fly(epochs, parameters[None], np.array([0]), np.array([side.size]))
            states[side] = arcs.of(0)
    return states


def _places(measured: Measured, rows: slice) -> np.ndarray:
    """Positions (n, 3) in GCRF [m] of rows of measurements."""
    itrf = place(measured.values[rows], measured.positions[rows], measured.to_horizon[rows])
    turned: np.ndarray = np.einsum("nij,ni->nj", measured.rotations[measured.epoch_of_row[rows]], itrf)
    return turned


def _first_day(begins: np.ndarray | pd.Series) -> np.ndarray:
    """Which tracks begin within a day of the first."""
    times = np.asarray(begins)
    return np.asarray(times <= times[0] + DAY)


def _without_cd() -> np.ndarray:
    """Which parameters (7,) are free: all but Cd."""
    return np.array([name != "cd" for name in PARAMETERS])
