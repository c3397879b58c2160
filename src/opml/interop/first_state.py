"""Reader of the state that a first orbit starts from: a TLE or OMM propagated by SGP4, or an orbit."""

import numpy as np

from opml.base import epochs
from opml.base.files import FilePath
from opml.interop import ccsds, formats
from opml.interop.element_sets import mean_elements
from opml.interop.ephemeris import EPOCH
from opml.interop.object_ids import ObjectId
from opml.interop.orbit_from_files import OrbitFiles, arcs_of_files


def read(path: FilePath, *, epoch: str, t: float) -> tuple[float, np.ndarray]:
    """Read a state near a time: the state's own time [s] and the GCRF state (6,) [m, m/s].

    t: [s since `epoch`]

    Mean elements are propagated to `t` itself; from an orbit the nearest state is taken. Raises
    InputError, naming file and line or key, for a malformed file and for mean elements that are too old.
    """
    if formats.kind_of(path, formats.ORBIT, formats.ELEMENTS) == formats.ORBIT:
        # Brings the compiled kernels with it, which no plan should wait for.
        from opml.interop import known_orbits

        orbit, since = known_orbits.read([path]), epochs.seconds_between(EPOCH, epoch)
        nearest = orbit.t[np.abs(orbit.t - since - t).argmin()]
        return float(nearest - since), orbit.at(np.array([nearest]))[0]
    satellite, start = mean_elements.read(path), ccsds.utc_texts(epoch, np.array([t]))[0]
    mean_elements.check_age(satellite, start)
    return t, mean_elements.state(satellite, epoch=start)


def identity(path: FilePath) -> ObjectId:
    """Return what a file with a state shows about its object.

    Raises InputError, naming file and line or key, where it has no state to start from.
    """
    if formats.kind_of(path, formats.ORBIT, formats.ELEMENTS) == formats.ORBIT:
        return arcs_of_files(OrbitFiles([path], EPOCH, 0.0))[0].identity
    mean_elements.read(path)  # refuses several
    (one,) = mean_elements.read_sets(path)
    return ObjectId.of(one.name, one.designator, str(one.number))
