"""Segments of orbits in GCRF, of all objects in a file of any format of orbits."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from opml.base.files import FilePath
from opml.environment import earth_orientation, nodes
from opml.interop import ccsds, formats
from opml.interop.curves.orbit_curve import rotate_to_gcrf
from opml.interop.oem import Segment
from opml.interop.orbit_arcs import EVERY, Arc, contents
from opml.orbits.elements import rsw_rotation, tnw_rotation


def read(path: FilePath, *, epoch: str) -> list[Segment]:
    """Read the segments of all objects in a file.

    Raises InputError, naming file and line, as the reader of its format does, and for no orbit.
    """
    arcs = formats.read(path, contents(path), formats.ORBIT, epoch=epoch, satellite=EVERY)
    newest = float(arcs[0].t[0])
    return [replace(one, known=newest) if one.known is None else one for one in of_arcs(arcs, epoch=epoch)]


def of_arcs(arcs: list[Arc], *, epoch: str) -> list[Segment]:
    """Return arcs in GCRF, velocities NaN where a file has none; epoch: from which their times count."""
    return [
        Segment(
            arc.satellite,
            arc.t,
            _in_gcrf(arc, epoch),
            arc.covariance_t,
            arc.covariances,
            arc.covariance_frame,
            identity=arc.identity,
            known=arc.known,
            density=arc.density,
        )
        for arc in arcs
    ]


def _in_gcrf(arc: Arc, epoch: str) -> np.ndarray:
    """Return the GCRF states (n, 6) of an arc."""
    (begin,) = ccsds.utc_texts(epoch, arc.t[:1])
    orientation = earth_orientation.tabulate(begin, nodes(begin, float(arc.t[-1] - arc.t[0])))
    return rotate_to_gcrf(replace(arc, t=arc.t - arc.t[0]), orientation)


def covariances_in_rsw(
    segment: Segment, states_at: Callable[[np.ndarray], np.ndarray]
) -> tuple[np.ndarray, np.ndarray]:
    """Return times (m,) [s] and covariances (m, 6, 6) in RSW [m, m/s] of a segment.

    states_at: its GCRF states (n, 6) at times (n,), NaN where unknown: there, covariances are left out
    """
    t, covariances = segment.covariance_t, segment.covariances
    axes = np.broadcast_to(np.asarray(segment.covariance_frame, dtype=str), len(t))
    if np.all(axes == "RSW"):
        return t, covariances
    states = states_at(t)
    known = np.isfinite(states).all(axis=1)
    turns, axes = rsw_rotation(states[known]), axes[known]
    turns[axes == "TNW"] @= tnw_rotation(states[known][axes == "TNW"]).transpose(0, 2, 1)
    turns[axes == "RSW"] = np.eye(3)
    both = np.kron(np.eye(2), turns)
    return t[known], both @ covariances[known] @ both.transpose(0, 2, 1)
