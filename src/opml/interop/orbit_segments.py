"""Ephemerides in GCRF, of all objects in a file of any format of orbits."""

from dataclasses import replace

import numpy as np

from opml.base.files import FilePath
from opml.environment import earth_orientation, nodes
from opml.interop import ccsds, formats
from opml.interop.curves.orbit_curve import rotate_to_gcrf
from opml.interop.ephemeris import Ephemeris
from opml.interop.orbit_arcs import EVERY, Arc, contents


def read(path: FilePath, *, epoch: str) -> list[Ephemeris]:
    """Read the ephemerides of all objects in a file.

    Raises InputError, naming file and line, as the reader of its format does, and for no orbit.
    """
    arcs = formats.read(path, contents(path), formats.ORBIT, epoch=epoch, satellite=EVERY)
    newest = float(arcs[0].t[0])
    return [replace(one, known=newest) if one.known is None else one for one in of_arcs(arcs, epoch=epoch)]


def of_arcs(arcs: list[Arc], *, epoch: str) -> list[Ephemeris]:
    """Return arcs in GCRF, velocities NaN where a file has none; epoch: from which their times count."""
    return [
        Ephemeris(
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
