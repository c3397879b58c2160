"""Reader of the state that a first orbit starts from: a TLE or OMM propagated by SGP4, or an orbit."""

from dataclasses import replace

import numpy as np

from opml.base.files import FilePath
from opml.interop import ccsds, formats
from opml.interop.element_sets import mean_elements
from opml.interop.object_ids import ObjectId
from opml.interop.orbit_arcs import MOST_APART
from opml.interop.orbit_from_files import OrbitFiles, arcs_of_files
from opml.tables import STATE

_ANY = "2000-01-01T12:00:00"


def read(path: FilePath, *, epoch: str, t: float) -> tuple[float, np.ndarray]:
    """Read a state near a time: the state's own time [s] and the GCRF state (6,) [m, m/s].

    t: [s since `epoch`]

    Mean elements are propagated to `t` itself; from an orbit the nearest state is taken. Raises
    InputError, naming file and line or key, for a malformed file and for mean elements that are too old.
    """
    if formats.kind_of(path, formats.ORBIT, formats.ELEMENTS) == formats.ORBIT:
        return _nearest(OrbitFiles([path], epoch, 0.0), t)
    satellite, start = mean_elements.read(path), ccsds.utc_texts(epoch, np.array([t]))[0]
    mean_elements.check_age(satellite, start)
    return t, mean_elements.state(satellite, epoch=start)


def identity(path: FilePath) -> ObjectId:
    """Return what a file with a state shows about its object.

    Raises InputError, naming file and line or key, where it has no state to start from.
    """
    if formats.kind_of(path, formats.ORBIT, formats.ELEMENTS) == formats.ORBIT:
        return arcs_of_files(OrbitFiles([path], _ANY, 0.0))[0].identity
    mean_elements.read(path)  # refuses several
    (one,) = mean_elements.read_sets(path)
    return ObjectId.of(one.name, one.designator, str(one.number))


def _nearest(files: OrbitFiles, t: float) -> tuple[float, np.ndarray]:
    """Return the time of the node of an orbit that is nearest to a time [s], and the GCRF state (6,) then."""
    # Brings the compiled kernels with it, which no plan should wait for.
    from opml.interop import orbit_segments, truth_from_orbit

    arcs = arcs_of_files(files)
    times = np.concatenate([arc.t for arc in arcs])
    place = np.abs(times - t).argmin()
    if arcs[0].frame != "ITRF":
        segments = orbit_segments.of_arcs(arcs, epoch=files.epoch)
        return float(times[place]), np.concatenate([one.states for one in segments])[place]
    there = replace(files, epoch=ccsds.utc_texts(files.epoch, times[place : place + 1])[0])
    states, _ = truth_from_orbit.truth(there, step=MOST_APART)
    return float(times[place]), states[STATE].to_numpy()[0]
