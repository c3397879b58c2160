"""Fits to the tracks of a first day, from which a first orbit grows; all hold Cd at its a-priori value."""

from collections.abc import Iterator

import numpy as np

from opml.base.constants import DAY, HOUR
from opml.catalog.fit.estimate import Estimate
from opml.catalog.fit.estimation import Run
from opml.catalog.fit.least_squares import Fit
from opml.catalog.fit.measurements import Measurements, Window
from opml.catalog.fit.neighbour_arcs import propagate_parameters
from opml.catalog.propagator import Propagator
from opml.tables import PARAMETERS

WITHOUT_CD = np.array([name != "cd" for name in PARAMETERS])  # which parameters (7,) are free


def is_of_first_day(times: np.ndarray) -> np.ndarray:
    """Return which times (n,) of tracks [s] are within a day of the first."""
    return np.asarray(times <= times[0] + DAY)


def first_windows(measured: Measurements) -> list[Window]:
    """Return the windows of the first day's tracks, each of one track alone."""
    first = np.flatnonzero(is_of_first_day(measured.epochs[measured.at]))
    return [measured.window(int(track), 0.0) for track in first]


def following(run: Run, first: Window) -> Iterator[Window]:
    """Yield the windows from a track to each one that follows, up to a window's length later."""
    times = run.measured.epochs[run.measured.at]
    begin, length = times[first.track], run.settings.window_hours * HOUR
    for track in np.flatnonzero((times > begin) & (times <= begin + length)):
        yield run.measured.window(int(track), times[track] - begin)


def start_estimate(run: Run, window: Window, t: float, state: np.ndarray) -> Estimate:
    """Return the estimate of a window that starts from a state (6,) at a time [s]."""
    at, cd = run.measured.epochs[[window.at]], run.propagator.rso.cd
    start = everywhere(run.propagator, at, t, np.append(state, cd))[0]
    return start_estimate_there(run, window, np.append(start, cd))


def start_estimate_there(run: Run, window: Window, start: np.ndarray) -> Estimate:
    """Return the estimate of a window that starts from parameters (7,) at its epoch."""
    return Estimate(window, Fit(start, run.method(WITHOUT_CD)))


def axis_sigma(fit: Fit, gm: float) -> float:
    """Return the formal uncertainty of a fit's semi-major axis [m]; infinite where the orbit is open."""
    gradient = _axis_gradient(fit.best, gm)
    return float(np.sqrt(gradient @ fit.covariance[:6, :6] @ gradient)) if gradient.any() else np.inf


def axis_line(fit: Fit, gm: float) -> np.ndarray:
    """Return how parameters (7,) change with the semi-major axis, by one of its formal uncertainties.

    Along this line the measurements of a fit are left as well as they can. The orbit has to be closed.
    """
    along = fit.covariance[:, :6] @ _axis_gradient(fit.best, gm)
    return along / axis_sigma(fit, gm)


def _axis_gradient(parameters: np.ndarray, gm: float) -> np.ndarray:
    """Return the derivatives (6,) of the semi-major axis, 0 where the orbit is open."""
    position, velocity = parameters[:3], parameters[3:6]
    radius, speed2 = float(np.linalg.norm(position)), float(velocity @ velocity)
    energy = 2.0 / radius - speed2 / gm
    if not energy > 0.0:
        return np.zeros(6)
    return 2.0 / energy**2 * np.concatenate([position / radius**3, velocity / gm])


def everywhere(propagator: Propagator, times: np.ndarray, t: float, parameters: np.ndarray) -> np.ndarray:
    """Return states (n, 6) at ascending times (n,) of an arc with parameters (7,) at t, NaN where lost."""
    states = np.where(times[:, None] == t, parameters[:6], np.nan)
    for side in (np.flatnonzero(times > t), np.flatnonzero(times < t)[::-1]):
        if side.size:
            epochs = np.append(t, times[side])
            arcs = propagate_parameters(
                propagator, epochs, parameters[None], np.array([0]), np.array([side.size])
            )
            states[side] = arcs.path(0)
    return states
