"""Mean elements fitted to positions: SGP4 by least squares, in mean motion, eccentricity, angles and B*.

What the fit leaves is mostly SGP4's own error. A fit to the first days of an ephemeris alone is hardly nearer
to them, and leaves the ephemeris after them.
"""

import logging
import math
from collections.abc import Callable
from datetime import datetime, timedelta

import numpy as np
from scipy.optimize import least_squares
from sgp4.api import Satrec

from opml.base.constants import DAY, EARTH_GM
from opml.base.errors import InputError
from opml.interop import ccsds
from opml.interop.element_sets import mean_elements
from opml.interop.element_sets.element_set import satellite
from opml.interop.element_sets.teme import teme_to_gcrf
from opml.interop.ephemeris import Ephemeris
from opml.orbits.elements import coe_from_cartesian, mean_from_true_anomaly

_FIRST_ARC = 0.2 * DAY  # length of the arc [s] that the osculating elements are good enough to start on

_MINUTE = 60.0
_LOST = 1e6  # residual [km] where SGP4 fails

_TLE_TICK = 864
"""Microseconds in the last digit of a TLE's epoch; at its other half a low orbit would be 3 m off."""

_log = logging.getLogger(__name__)


def in_teme(states: np.ndarray, epoch: str, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return positions and velocities (n, 3) in TEME [km, km/s] of states (n, 6) in GCRF [m, m/s]."""
    turns = teme_to_gcrf(epoch, t)
    positions, velocities = (
        np.einsum("nji,nj->ni", turns, part) / 1e3 for part in (states[:, :3], states[:, 3:])
    )
    return positions, velocities


def fit(t: np.ndarray, positions: np.ndarray, *, at: float, known: np.ndarray, epoch: str) -> Satrec:
    """Return the set that comes nearest to positions.

    t: (n,) [s since `epoch`], ascending
    positions: (n, 3) in TEME [km]
    at: epoch of the set, the first or the last time [s]
    known: (6,) state then in TEME, where the fit starts [km, km/s]

    Raises InputError where SGP4 does not come near them.
    """
    (time,) = ccsds.utc_texts(epoch, np.array([at]))
    since = t - at
    start = _osculating(known)
    near = np.abs(since) < _FIRST_ARC
    osculating = _nearest(start, lambda x: _misses(np.append(x, 0.0), time, since[near], positions[near]))
    mean = _nearest(np.append(osculating, 0.0), lambda x: _misses(x, time, since, positions))
    rms = math.sqrt(np.mean(np.sum(_misses(mean, time, since, positions) ** 2, axis=1)))
    if not rms < _LOST:
        raise InputError(f"mean elements: expected an orbit that SGP4 can propagate about {time}, got none")
    return _satellite(mean, time)


def _osculating(state: np.ndarray) -> np.ndarray:
    """Return the first six parameters of a state (6,) [km, km/s]. Raises InputError for no ellipse."""
    a, e, i, argp, raan, nu = coe_from_cartesian(1e3 * state, EARTH_GM).tolist()
    if not 0.0 <= e < 1.0:
        raise InputError(f"mean elements: expected an eccentricity below 1, got {e:.3g}")
    motion = _MINUTE * math.sqrt(EARTH_GM / a**3)
    longitude = argp + float(mean_from_true_anomaly(nu, e))
    return np.array([motion, e * math.cos(argp), e * math.sin(argp), i, raan, longitude])


def _nearest(start: np.ndarray, misses: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
    return np.asarray(least_squares(lambda x: misses(x).ravel(), start, method="lm", x_scale="jac").x)


def _misses(parameters: np.ndarray, time: str, since: np.ndarray, positions: np.ndarray) -> np.ndarray:
    """Return the distances (n, 3) [km] of SGP4 from positions (n, 3) at times (n,) [s] from a UTC text on."""
    satellite = _satellite(parameters, time)
    days = satellite.jdsatepochF + since / DAY
    errors, propagated, _ = satellite.sgp4_array(np.full(len(since), satellite.jdsatepoch), days)
    return np.where(errors[:, None] == 0, propagated - positions, _LOST)


def _satellite(parameters: np.ndarray, epoch: str) -> Satrec:
    """Return the satellite of parameters.

    parameters: (7,) mean motion [rad/min], e cos w, e sin w, inclination, node, w + M [rad], B*
    """
    motion, x, y, inclination, node, longitude, bstar = parameters.tolist()
    perigee = math.atan2(y, x)
    angles = (angle % (2.0 * math.pi) for angle in (node, perigee, longitude - perigee))
    return satellite(epoch, [motion, math.hypot(x, y), inclination, *angles, bstar])


def fit_ephemeris(ephemeris: Ephemeris, *, epoch: str) -> Satrec:
    """Return mean elements at the beginning of an ephemeris by which SGP4 comes nearest to it.

    Raises InputError where SGP4 does not come near it.
    """
    (begin,) = ccsds.utc_texts(epoch, ephemeris.t[:1])
    at = ephemeris.t[0] - 1e-6 * _microseconds_after_tick(begin)
    positions, velocities = in_teme(ephemeris.states, epoch, ephemeris.t)
    known = np.concatenate([positions[0], velocities[0]])
    return fit(ephemeris.t, positions, at=at, known=known, epoch=epoch)


def residual(satellite: Satrec, ephemeris: Ephemeris, *, epoch: str) -> str:
    """Return a sentence, and log it, that says how far SGP4 from mean elements is from an ephemeris.

    Raises InputError where SGP4 fails before the end of the ephemeris.
    """
    t = ephemeris.t
    propagated = mean_elements.states(satellite, epoch=epoch, t=t)
    distances = np.linalg.norm(propagated[:, :3] - ephemeris.states[:, :3], axis=1)
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
