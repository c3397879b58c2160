"""Points before the epoch of mean elements, where SGP4 tells the orbit that the elements were fitted to."""

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike
from sgp4.api import Satrec

from opml.base import epochs
from opml.base.errors import InputError
from opml.interop.element_sets import mean_elements
from opml.tables import FIX_SIGMAS, STATE


def before(
    satellite: Satrec, *, epoch: str, reach: float, step: float, sigmas: ArrayLike
) -> tuple[float, pd.DataFrame]:
    """Return the epoch of mean elements [s], and points up to it: t, state in GCRF, sigmas in RSW.

    epoch: UTC text from which times count
    reach: from the first point to the epoch [s]
    step: between points [s]
    sigmas: (6,) of all points, or (n, 6) of each [m, m/s]; NaN where velocities do not count

    Raises InputError where SGP4 fails.
    """
    end = epochs.seconds_between(epoch, mean_elements.elements_epoch(satellite))
    t = end - step * np.arange(round(reach / step), -1, -1)
    states = mean_elements.states(satellite, epoch=epoch, t=t)
    failed = np.flatnonzero(np.isnan(states[:, 0]))
    if failed.size:
        raise InputError(f"mean elements: expected an orbit at {t[failed[0]]:.0f} s, got none by SGP4")
    points = pd.DataFrame(states, columns=STATE).assign(t=t)
    points[FIX_SIGMAS] = np.broadcast_to(sigmas, (len(t), len(FIX_SIGMAS)))
    return end, points
