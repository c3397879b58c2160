"""Arcs of a trial and its neighbours, which differ in one parameter each and give the partial derivatives."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from opml.catalog.fit.measurements import Window
from opml.catalog.propagator import Propagator, neighbour_paths
from opml.dynamics.ensemble import Arcs

NUDGES = np.array([1.0, 1.0, 1.0, 1e-3, 1e-3, 1e-3, 1e-2])
"""Differences [m, m/s, -] of the neighbouring arcs: small against the orbit, large against rounding."""

_NEIGHBOURS = np.vstack([np.zeros(7), np.diag(NUDGES)])
"""The arcs of one evaluation, as differences from the nominal arc, which is the first."""


def propagate_parameters(
    propagator: Propagator, epochs: np.ndarray, parameters: np.ndarray, first: np.ndarray, last: np.ndarray
) -> Arcs:
    """Propagate arcs from parameters (arcs, 7) at epochs[first] to epochs[last]."""
    return propagator.propagate(epochs, parameters[:, :6], cd=parameters[:, -1], first=first, last=last)


@dataclass(frozen=True)
class NeighbourArcs:
    """The arcs of a trial and its neighbours, through the epochs of a window."""

    states: np.ndarray  # (8, epochs, 6) GCRF [m, m/s], those of the trial first
    near: np.ndarray  # (epochs, 6) the trial's own under the neighbours' part of the field

    def moved(self, near: np.ndarray) -> np.ndarray:
        """Return the states (8, epochs, 6) of another trial near by; near: as that of this one."""
        # All eight shift by what parts the two trials: their differences, the partial derivatives, stay.
        path = self.states[0]
        return self.states + (neighbour_paths(path, self.near, near[None]) - path)


def propagate_around(
    propagator: Propagator, epochs: np.ndarray, windows: Sequence[Window], trials: np.ndarray
) -> tuple[list[NeighbourArcs], np.ndarray]:
    """Return (arcs of each trial (n, 7) of a window and its neighbours, their worst status).

    The status is an index into REASONS.

    In a large field the trials alone are propagated with all of it. Two-day fits of Swarm A under 70x70 then
    have the same answers to 0.002 of their sigma, in a third of the time.
    """
    near = propagator.for_neighbours()
    count = len(_NEIGHBOURS)
    lanes = (trials[:, None] + _NEIGHBOURS).reshape(-1, 7)
    paths, status = _propagate_windows(
        near, epochs, [window for window in windows for _ in range(count)], lanes
    )
    states = [np.stack(paths[k : k + count]) for k in range(0, len(paths), count)]
    worst = status.reshape(-1, count).max(axis=1)
    arounds = [NeighbourArcs(arcs, arcs[0]) for arcs in states]
    if near is propagator:
        return arounds, worst
    whole, lost = _propagate_windows(propagator, epochs, windows, trials)
    moved = [
        replace(one, states=neighbour_paths(path, one.near, one.states))
        for one, path in zip(arounds, whole, strict=True)
    ]
    return moved, np.maximum(worst, lost)


def propagate_near(
    propagator: Propagator, epochs: np.ndarray, windows: Sequence[Window], trials: np.ndarray
) -> tuple[list[np.ndarray], np.ndarray]:
    """Return (states (epochs, 6), status) of each trial alone, as `NeighbourArcs.near`."""
    return _propagate_windows(propagator.for_neighbours(), epochs, windows, trials)


def _propagate_windows(
    propagator: Propagator, epochs: np.ndarray, windows: Sequence[Window], parameters: np.ndarray
) -> tuple[list[np.ndarray], np.ndarray]:
    """Return (states (epochs, 6) of each window, status) of arcs from parameters (n, 7)."""
    first, at, last = (
        np.array([getattr(window, name) for window in windows]) for name in ("first", "at", "last")
    )
    # An estimate is within its window: arcs go from it to both ends, backwards along epochs in reverse.
    newest = len(epochs) - 1
    forward = propagate_parameters(propagator, epochs, parameters, at, last)
    backward = propagate_parameters(propagator, epochs[::-1], parameters, newest - at, newest - first)
    paths = [
        np.vstack([backward.path(k)[::-1], parameters[k : k + 1, :6], forward.path(k)])
        for k in range(len(parameters))
    ]
    return paths, np.maximum(forward.status, backward.status)
