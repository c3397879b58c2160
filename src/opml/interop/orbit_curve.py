"""A curve through the nodes of a real orbit: GCRF, bridged by gravity, broken where the orbit breaks."""

import logging
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from opml.base.errors import InputError
from opml.dynamics.attraction import Attraction
from opml.dynamics.frames import gcrf_to_itrf, spin
from opml.interop import ccsds, orbit_breaks
from opml.interop.bridging import Bridges, bridge
from opml.interop.orbit_arcs import MOST_APART, Arc

ON_NODE = 1e-6
"""How far from a node a time may lie where the node's state is taken as it stands [s]."""

ALIEN = 10.0
"""Usual difference [m/s] between velocities and those that the positions tell, of another unit or frame."""

STRAYING = 0.05
"""Difference [m/s] below which a single velocity counts as right whatever the others are."""

_TIMES_USUAL = 10.0  # above both this many times what is usual, a single velocity is left out
_EXACT = 1e-4  # usual difference [m/s] that is as good as none
_MOST_TOLD = 10
_SLACK = 1e-3  # [s], for times rounded to the millisecond

_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Curve:
    """An orbit in GCRF, through nodes that ascend.

    t (n,) [s]; states (n, 6) [m, m/s], not finite for a node that is wrong; found: the breaks; missed (m,):
    what nodes that were left out are missed by [m]; left_out: how many positions and velocities do not fit.
    """

    t: np.ndarray
    states: np.ndarray
    bridges: Bridges
    found: list[orbit_breaks.Break]
    missed: np.ndarray
    left_out: tuple[int, int]

    def at(self, t: np.ndarray) -> np.ndarray:
        """States (m, 6) at times (m,) [s], not finite where unknown; at a node its own as it stands."""
        states = self.bridges.states(t)
        after = np.clip(np.searchsorted(self.t, t), 1, len(self.t) - 1)
        nearest = np.where(t - self.t[after - 1] < self.t[after] - t, after - 1, after)
        own = np.abs(self.t[nearest] - t) <= ON_NODE
        states[own] = self.states[nearest[own]]
        return states


def through(arcs: Sequence[Arc], orientation: pd.DataFrame, attraction: Attraction) -> Curve:
    """The curve through arcs that follow each other; orientation: the Earth orientation table of their times.

    Nothing is bridged over more than MOST_APART or over a break. Raises InputError where velocities are in
    another unit or frame than they should be.
    """
    t = np.concatenate([arc.t for arc in arcs])
    states = np.concatenate([in_gcrf(arc, orientation) for arc in arcs])
    near = np.diff(t) <= MOST_APART + _SLACK
    bridges = bridge(t, states[:, :3], attraction, wanted=near)
    found, jumping, broken = orbit_breaks.find(t, bridges.jumps)
    broken |= near & ~bridges.bridged
    bridges = bridges.without(broken)
    strange = _strange_velocities(arcs, states[:, 3:], bridges)
    states[strange, 3:] = np.nan
    missed = _missed(t, states, attraction, smooth=bridges.bridged & ~jumping[:-1] & ~jumping[1:])
    given = np.isfinite(states[:, 3:])
    states[:, 3:] = np.where(given, states[:, 3:], bridges.mean_velocities())
    bridges = bridges.through(states[:, 3:], free=jumping & ~given[:, 0])
    wrong = _alone(bridges.bridged)
    states[wrong] = np.nan
    _tell(arcs, wrong)
    return Curve(t, states, bridges, found, missed, (int(wrong.sum()), int(strange.sum())))


def in_gcrf(arc: Arc, orientation: pd.DataFrame) -> np.ndarray:
    """States (n, 6) [m, m/s] of an arc in GCRF.

    v_GCRF = R^T v_ITRF + w x r_GCRF, with the rotation R from GCRF to ITRF and the Earth's rotation vector w.
    """
    if arc.frame != "ITRF":
        turn = ccsds.FRAMES[arc.frame].T
        return np.concatenate([arc.positions @ turn, arc.velocities @ turn], axis=1)
    turns = gcrf_to_itrf(orientation, arc.t)
    rate = spin(orientation)
    turning = np.stack([np.interp(arc.t, orientation["t"], rate[:, k]) for k in range(3)], axis=1)
    positions = np.einsum("nji,nj->ni", turns, arc.positions)
    velocities = np.einsum("nji,nj->ni", turns, arc.velocities) + np.cross(turning, positions)
    return np.concatenate([positions, velocities], axis=1)


def _strange_velocities(arcs: Sequence[Arc], velocities: np.ndarray, bridges: Bridges) -> np.ndarray:
    """Which velocities (n, 3) [m/s] of the files tell less than the positions do: (n,).

    All of them, where they usually differ from those before and after a node by more than these two do from
    each other; else single ones. Raises InputError where they are not of the positions' orbit at all.
    """
    none = np.full((1, 3), np.nan)
    sides = np.stack([np.vstack([bridges.departures, none]), np.vstack([none, bridges.arrivals])])
    apart = np.fmin(*np.linalg.norm(velocities - sides, axis=2))
    given: np.ndarray = np.isfinite(velocities[:, 0])
    usual = _median(apart)
    if usual > ALIEN:
        raise InputError(
            f"{arcs[0].path}: expected velocities that fit the positions, got {usual:.3g} m/s more or less "
            "(another unit or frame?)"
        )
    if usual <= max(_EXACT, _median(np.linalg.norm(bridges.jumps, axis=1))):
        given &= apart > max(STRAYING, _TIMES_USUAL * usual)
    return given


def _median(sizes: np.ndarray) -> float:
    """Median of those sizes (n,) that are finite and not 0; 0 where there are none."""
    known = sizes[np.isfinite(sizes) & (sizes > 0.0)]
    return float(np.median(known)) if known.size else 0.0


def _missed(t: np.ndarray, states: np.ndarray, attraction: Attraction, smooth: np.ndarray) -> np.ndarray:
    """Distances (m,) [m] by which bridges between every second node miss the nodes that are left out.

    smooth: intervals (n - 1,) that have no break at an end.
    """
    pairs = (len(t) - 1) // 2
    if not pairs:
        return np.empty(0)
    kept, left = states[: 2 * pairs + 1 : 2], states[1 : 2 * pairs : 2]
    both = smooth[: 2 * pairs : 2] & smooth[1 : 2 * pairs : 2]
    bridges = bridge(t[: 2 * pairs + 1 : 2], kept[:, :3], attraction, wanted=both)
    velocities = np.where(np.isfinite(kept[:, 3:]), kept[:, 3:], bridges.mean_velocities())
    bridges = bridges.through(velocities, free=np.zeros(len(kept), bool))
    missed = np.linalg.norm(bridges.states(t[1 : 2 * pairs : 2])[:, :3] - left[:, :3], axis=1)
    known: np.ndarray = missed[np.isfinite(missed)]
    return known


def _alone(bridged: np.ndarray) -> np.ndarray:
    """Which nodes (n,) stand alone, bridged on neither side: nothing tells that they are right."""
    alone: np.ndarray = ~np.append(False, bridged) & ~np.append(bridged, False)
    return alone


def _tell(arcs: Sequence[Arc], wrong: np.ndarray) -> None:
    """Log the first few nodes that are left out."""
    lines = np.concatenate([arc.lines for arc in arcs])
    arc_of = np.repeat(np.arange(len(arcs)), [len(arc.t) for arc in arcs])
    for node in np.flatnonzero(wrong)[:_MOST_TOLD]:
        path = arcs[arc_of[node]].path
        _log.warning("%s: line %d: left out, no orbit leads to this position", path, lines[node])
