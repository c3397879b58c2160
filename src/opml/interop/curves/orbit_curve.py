"""A curve in GCRF through the nodes of a real orbit, bridged by gravity, open where the orbit breaks."""

import logging
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from opml.base.errors import InputError
from opml.dynamics.attraction import Attraction
from opml.dynamics.frames import states_to_gcrf
from opml.interop import ccsds
from opml.interop.curves import orbit_breaks
from opml.interop.curves.gravity_interpolation import Bridges, bridge
from opml.interop.orbit_arcs import MOST_APART, Arc

ON_NODE = 1e-6  # largest distance of a time from a node whose state is taken unchanged [s]
ALIEN = 10.0  # usual difference [m/s] from the velocities of the positions that means another unit or frame
STRAYING = 0.05  # difference [m/s] below which a single velocity counts as right, whatever is usual
_TIMES_USUAL = 10.0  # least ratio of the difference to the usual one for a wrong single velocity
_EXACT = 1e-4  # usual difference [m/s] that counts as none
_MOST_LOGGED = 10
_SLACK = 1e-3  # [s], for times rounded to the millisecond

_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class OrbitCurve:
    """An orbit in GCRF through ascending nodes."""

    t: np.ndarray  # (n,) times of the nodes [s]
    states: np.ndarray  # (n, 6) of the nodes [m, m/s], not finite at a wrong node
    bridges: Bridges  # the orbit between the nodes
    breaks: list[orbit_breaks.Break]  # of the orbit
    distances: np.ndarray  # (m,) distances of the other nodes from the curve through every second one [m]
    left_out: tuple[int, int]  # numbers of positions and of velocities that do not fit

    def interpolate(self, t: np.ndarray) -> np.ndarray:
        """Return the states (m, 6) at times (m,) [s], not finite where unknown; at a node, its state."""
        states = self.bridges.states(t)
        after = np.clip(np.searchsorted(self.t, t), 1, len(self.t) - 1)
        nearest = np.where(t - self.t[after - 1] < self.t[after] - t, after - 1, after)
        on_node = np.abs(self.t[nearest] - t) <= ON_NODE
        states[on_node] = self.states[nearest[on_node]]
        return states


def fit_curve(arcs: Sequence[Arc], orientation: pd.DataFrame, attraction: Attraction) -> OrbitCurve:
    """Return the curve through arcs.

    arcs: one after the other, without overlap
    orientation: table `earth_orientation` over their times

    Intervals longer than MOST_APART and breaks stay open. Raises InputError where velocities are in another
    unit or frame than the positions.
    """
    t = np.concatenate([arc.t for arc in arcs])
    states = np.concatenate([rotate_to_gcrf(arc, orientation) for arc in arcs])
    near = np.diff(t) <= MOST_APART + _SLACK
    bridges = bridge(t, states[:, :3], attraction, wanted=near)
    breaks, jumping, broken = orbit_breaks.find(t, bridges.jumps)
    broken |= near & ~bridges.bridged
    bridges = bridges.drop(broken)
    # Velocities that the positions contradict are replaced by those of the bridges.
    strange = _strange_velocities(arcs, states[:, 3:], bridges)
    states[strange, 3:] = np.nan
    distances = _misses(t, states, attraction, smooth=bridges.bridged & ~jumping[:-1] & ~jumping[1:])
    has_velocity = np.isfinite(states[:, 3:])
    states[:, 3:] = np.where(has_velocity, states[:, 3:], bridges.mean_velocities())
    bridges = bridges.match_velocities(states[:, 3:], free=jumping & ~has_velocity[:, 0])
    # No interval confirms a node that is bridged on neither side.
    wrong = ~np.append(False, bridges.bridged) & ~np.append(bridges.bridged, False)
    states[wrong] = np.nan
    _log_wrong_nodes(arcs, wrong)
    return OrbitCurve(t, states, bridges, breaks, distances, (int(wrong.sum()), int(strange.sum())))


def rotate_to_gcrf(arc: Arc, orientation: pd.DataFrame) -> np.ndarray:
    """Return the states (n, 6) [m, m/s] of an arc in GCRF."""
    if arc.frame != "ITRF":
        turn = ccsds.FRAMES[arc.frame].T
        return np.concatenate([arc.positions @ turn, arc.velocities @ turn], axis=1)
    return states_to_gcrf(orientation, arc.t, arc.positions, arc.velocities)


def _strange_velocities(arcs: Sequence[Arc], velocities: np.ndarray, bridges: Bridges) -> np.ndarray:
    """Return which of the files' velocities (n, 3) [m/s] are worse than those of the bridges: (n,).

    These are all, where velocities usually differ from the nearer side of a bridged node by more than the
    two sides differ; otherwise single ones that stray. Raises InputError where velocities and positions are
    not of one orbit.
    """
    none = np.full((1, 3), np.nan)
    sides = np.stack([np.vstack([bridges.departures, none]), np.vstack([none, bridges.arrivals])])
    difference = np.fmin(*np.linalg.norm(velocities - sides, axis=2))
    strange: np.ndarray = np.isfinite(velocities[:, 0])
    usual = _median(difference)
    if usual > ALIEN:
        raise InputError(
            f"{arcs[0].path}: expected velocities that fit the positions, got {usual:.3g} m/s more or less "
            "(another unit or frame?)"
        )
    if usual <= max(_EXACT, _median(np.linalg.norm(bridges.jumps, axis=1))):
        strange &= difference > max(STRAYING, _TIMES_USUAL * usual)
    return strange


def _median(sizes: np.ndarray) -> float:
    """Return the median of the sizes (n,) that are finite and above 0; 0 without such sizes."""
    known = sizes[np.isfinite(sizes) & (sizes > 0.0)]
    return float(np.median(known)) if known.size else 0.0


def _misses(t: np.ndarray, states: np.ndarray, attraction: Attraction, smooth: np.ndarray) -> np.ndarray:
    """Return the distances (m,) [m] by which bridges between every second node miss the other nodes.

    smooth: (n - 1,) intervals without a break at either end
    """
    pairs = (len(t) - 1) // 2
    if not pairs:
        return np.empty(0)
    kept, omitted = states[: 2 * pairs + 1 : 2], states[1 : 2 * pairs : 2]
    both = smooth[: 2 * pairs : 2] & smooth[1 : 2 * pairs : 2]
    bridges = bridge(t[: 2 * pairs + 1 : 2], kept[:, :3], attraction, wanted=both)
    velocities = np.where(np.isfinite(kept[:, 3:]), kept[:, 3:], bridges.mean_velocities())
    bridges = bridges.match_velocities(velocities, free=np.zeros(len(kept), bool))
    distances = np.linalg.norm(bridges.states(t[1 : 2 * pairs : 2])[:, :3] - omitted[:, :3], axis=1)
    return np.asarray(distances[np.isfinite(distances)])


def _log_wrong_nodes(arcs: Sequence[Arc], wrong: np.ndarray) -> None:
    lines = np.concatenate([arc.lines for arc in arcs])
    arc_numbers = np.repeat(np.arange(len(arcs)), [len(arc.t) for arc in arcs])
    for node in np.flatnonzero(wrong)[:_MOST_LOGGED]:
        path = arcs[arc_numbers[node]].path
        _log.warning("%s: line %d: left out, no orbit leads to this position", path, lines[node])
