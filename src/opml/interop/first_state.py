"""Reader of the state that a first orbit starts from: a TLE or an OMM flown by SGP4, or an OEM's state."""

import numpy as np

from opml.base.files import FilePath
from opml.interop import ccsds, oem
from opml.interop.element_sets import mean_elements
from opml.interop.orbit_arcs import contents

_ANY = "2000-01-01T12:00:00"


def check(path: FilePath) -> None:
    """Raise InputError, naming file and line or key, where a file has no state to start from."""
    if oem.matches(contents(path)):
        oem.read(path, epoch=_ANY)
    else:
        mean_elements.read(path)


def read(path: FilePath, *, epoch: str, t: float) -> tuple[float, np.ndarray]:
    """Read a state near a time: the state's own time [s] and the GCRF state (6,) [m, m/s].

    epoch: UTC text
    t: [s since `epoch`]

    Mean elements are flown to `t` itself; from an OEM the nearest state is taken. Raises InputError, naming
    file and line or key, for a malformed file and for mean elements that are too old.
    """
    if oem.matches(contents(path)):
        segments = oem.read(path, epoch=epoch)
        times = np.concatenate([segment.t for segment in segments])
        states = np.concatenate([segment.states for segment in segments])
        nearest = int(np.abs(times - t).argmin())
        return float(times[nearest]), states[nearest]
    satellite, start = mean_elements.read(path), ccsds.utc_texts(epoch, np.array([t]))[0]
    mean_elements.check_age(satellite, start)
    return t, mean_elements.state(satellite, epoch=start)
