"""The state that a first orbit starts from, from a file: a TLE or an OMM flown by SGP4, or an OEM's state."""

import numpy as np

from opml.base.files import FilePath
from opml.interop import ccsds, mean_elements, oem
from opml.interop.orbit_arcs import contents

_ANY = "2000-01-01T12:00:00"


def check(path: FilePath) -> None:
    """Raise InputError, naming file and line or key, where a file has no state to start from."""
    if oem.is_one(contents(path)):
        oem.read(path, epoch=_ANY)
    else:
        mean_elements.read(path)


def read(path: FilePath, *, epoch: str, t: float) -> tuple[float, np.ndarray]:
    """Read a state near `t` [s since the UTC text `epoch`]: its own time [s], GCRF state (6,) [m, m/s].

    Mean elements are flown to `t` itself; of an OEM it is the nearest state. Raises InputError, naming file
    and line or key, for what is malformed, and for mean elements that are too old.
    """
    if oem.is_one(contents(path)):
        segments = oem.read(path, epoch=epoch)
        times, states = (np.concatenate([getattr(one, name) for one in segments]) for name in ("t", "states"))
        nearest = int(np.abs(times - t).argmin())
        return float(times[nearest]), states[nearest]
    satellite, at = mean_elements.read(path), ccsds.utc_texts(epoch, np.array([t]))[0]
    mean_elements.check_age(satellite, at)
    return t, mean_elements.state(satellite, epoch=at)
