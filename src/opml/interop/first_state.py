"""Reader of the state that a first orbit starts from: a TLE or OMM propagated by SGP4, or an orbit."""

from dataclasses import replace

import numpy as np

from opml.base.files import FilePath
from opml.interop import ccsds, oem
from opml.interop.element_sets import mean_elements
from opml.interop.object_ids import ObjectId
from opml.interop.orbit_arcs import MOST_APART, contents
from opml.interop.orbit_from_files import OrbitFiles, arcs_of_files, is_orbit
from opml.tables import STATE

_ANY = "2000-01-01T12:00:00"


def read(path: FilePath, *, epoch: str, t: float) -> tuple[float, np.ndarray]:
    """Read a state near a time: the state's own time [s] and the GCRF state (6,) [m, m/s].

    t: [s since `epoch`]

    Mean elements are propagated to `t` itself; from an OEM, SP3 or CPF the nearest state is taken. Raises
    InputError, naming file and line or key, for a malformed file and for mean elements that are too old.
    """
    content = contents(path)
    if oem.matches(content):
        segments = oem.read(path, epoch=epoch)
        times = np.concatenate([segment.t for segment in segments])
        states = np.concatenate([segment.states for segment in segments])
        nearest = int(np.abs(times - t).argmin())
        return float(times[nearest]), states[nearest]
    if is_orbit(content):
        return _nearest(OrbitFiles([path], epoch, 0.0), t)
    satellite, start = mean_elements.read(path), ccsds.utc_texts(epoch, np.array([t]))[0]
    mean_elements.check_age(satellite, start)
    return t, mean_elements.state(satellite, epoch=start)


def identity(path: FilePath) -> ObjectId:
    """Return what a file with a state shows about its object.

    Raises InputError, naming file and line or key, where it has no state to start from.
    """
    content = contents(path)
    if oem.matches(content):
        return oem.read(path, epoch=_ANY)[0].identity
    if is_orbit(content):
        return arcs_of_files(OrbitFiles([path], _ANY, 0.0))[0].identity
    mean_elements.read(path)  # refuses several
    (one,) = mean_elements.read_sets(path)
    return ObjectId.of(one.name, one.designator, str(one.number))


def _nearest(files: OrbitFiles, t: float) -> tuple[float, np.ndarray]:
    """Return the time of the node of an orbit that is nearest to a time [s], and the GCRF state (6,) then."""
    # Brings the compiled kernels with it, which no plan should wait for.
    from opml.interop import truth_from_orbit

    times = np.concatenate([arc.t for arc in arcs_of_files(files)])
    nearest = float(times[np.abs(times - t).argmin()])
    there = replace(files, epoch=ccsds.utc_texts(files.epoch, np.array([nearest]))[0])
    states, _ = truth_from_orbit.truth(there, step=MOST_APART)
    return nearest, states[STATE].to_numpy()[0]
