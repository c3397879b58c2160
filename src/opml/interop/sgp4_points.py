"""Points before the epoch of mean elements, where SGP4 tells the orbit that the elements were fitted to."""

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike
from sgp4.api import SGP4_ERRORS, Satrec

from opml.base import epochs
from opml.base.errors import InputError
from opml.interop import mean_elements
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
    points = pd.DataFrame(states(satellite, epoch=epoch, t=t), columns=STATE).assign(t=t)
    points[FIX_SIGMAS] = np.broadcast_to(sigmas, (len(t), len(FIX_SIGMAS)))
    return end, points


def states(satellite: Satrec, *, epoch: str, t: np.ndarray) -> np.ndarray:
    """Return osculating GCRF states (n, 6) [m, m/s] at times t (n,) [s since the UTC text], by SGP4.

    Raises InputError where SGP4 fails (decayed, elements out of range).
    """
    errors, positions, velocities = satellite.sgp4_array(*map(np.atleast_1d, epochs.utc(epoch, t)))
    failed = np.flatnonzero(errors)
    if failed.size:
        reason = SGP4_ERRORS[int(errors[failed[0]])]
        raise InputError(f"mean elements: expected an orbit at {t[failed[0]]:.0f} s, got {reason}")
    turns = mean_elements.teme_to_gcrf(epoch, t)
    parts = np.stack([positions, velocities], axis=1)
    turned: np.ndarray = 1e3 * np.einsum("nij,nkj->nki", turns, parts).reshape(-1, len(STATE))
    return turned
