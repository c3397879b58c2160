"""Arcs of a trial and its neighbours, which differ in one parameter each and tell the partial derivatives."""

from collections.abc import Sequence

import numpy as np

from opml.catalog.fit.measurements import Window
from opml.catalog.flight import Flight
from opml.dynamics.ensemble import Arcs
from opml.tables import PARAMETERS

_CD = PARAMETERS.index("cd")

NUDGES = np.array([1.0, 1.0, 1.0, 1e-3, 1e-3, 1e-3, 1e-2])
"""Differences [m, m/s, -] of the neighbouring arcs: small against the orbit, large against rounding."""

_NEIGHBOURS = np.vstack([np.zeros(7), np.diag(NUDGES)])
"""The arcs of one evaluation, as differences from the nominal arc, which is the first."""


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
    flight: Flight, epochs: np.ndarray, windows: Sequence[Window], trials: np.ndarray
) -> tuple[list[np.ndarray], np.ndarray]:
    """Return (states of each trial (n, 7) of a window and its neighbours, their worst status).

    The states are (8, epochs, 6) GCRF [m, m/s] at the epochs of the window; the status is an index into
    REASONS.

    In a large field the trials alone fly under all of it. Two-day fits of Swarm A under 70x70 then have the
    same answers to 0.0004 of their sigma, in 43 % of the time.
    """
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
