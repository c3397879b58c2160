"""Mean elements of an ephemeris, for tools that take nothing else: SGP4 fitted to all of it.

A fit to its first days alone is hardly nearer to them, and leaves the ephemeris after them.
"""

import logging
from datetime import datetime, timedelta

import numpy as np
from sgp4.api import Satrec

from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.interop import ccsds
from opml.interop.element_sets import element_fits, mean_elements
from opml.interop.oem import Segment

_TLE_TICK = 864
"""Microseconds in the last digit of a TLE's epoch; at its other half a low orbit would be 3 m off."""

_log = logging.getLogger(__name__)


def fit_elements(ephemeris: Segment, *, epoch: str) -> Satrec:
    """Return mean elements at the beginning of an ephemeris by which SGP4 comes nearest to it.

    Raises InputError where SGP4 does not come near it.
    """
    (begin,) = ccsds.utc_texts(epoch, ephemeris.t[:1])
    at = ephemeris.t[0] - 1e-6 * _microseconds_after_tick(begin)
    positions, velocities = element_fits.in_teme(ephemeris.states, epoch, ephemeris.t)
    known = np.concatenate([positions[0], velocities[0]])
    return element_fits.fit(ephemeris.t, positions, at=at, known=known, epoch=epoch)


def residual(satellite: Satrec, ephemeris: Segment, *, epoch: str) -> str:
    """Return a sentence, and log it, that says how far SGP4 from mean elements is from an ephemeris.

    Raises InputError where SGP4 fails before the end of the ephemeris.
    """
    t = ephemeris.t
    flown = mean_elements.states(satellite, epoch=epoch, t=t)
    distances = np.linalg.norm(flown[:, :3] - ephemeris.states[:, :3], axis=1)
    if not np.isfinite(distances).all():
        raise InputError(
            f"mean elements: expected an orbit for {t[-1] - t[0]:.0f} s, got one that ends by SGP4"
        )
    rms, days = np.sqrt(np.mean(distances**2)), (t[-1] - t[0]) / DAY
    sentence = (
        f"SGP4 is {rms:.0f} m rms from the ephemeris of {days:.3g} days, {distances.max():.0f} m at most."
    )
    _log.info("%s", sentence)
    return sentence


def _microseconds_after_tick(time: str) -> int:
    """Return by how much a UTC text is after the newest epoch that a TLE can hold [microseconds]."""
    moment = datetime.fromisoformat(time)
    midnight = moment.replace(hour=0, minute=0, second=0, microsecond=0)
    return (moment - midnight) // timedelta(microseconds=1) % _TLE_TICK
