"""TEME, the frame of SGP4's states, and its rotation to GCRF.

TEME turns with the mean equinox. The rotation to GCRF goes through the Earth's rotation: Greenwich mean
sidereal time of 1982 against the Earth rotation angle about the CIP of IAU 2006/2000A. UT1 enters both angles
and cancels, so UTC will do and no bulletin is needed. Source: Vallado, Crawford, Hujsak & Kelso 2006,
Revisiting Spacetrack Report #3 (AIAA 2006-6753), appendix C; IERS Conventions 2010, section 5.4.
"""

from functools import lru_cache

import erfa
import numpy as np

from opml.base import epochs
from opml.base.constants import DAY
from opml.environment.earth_orientation import lagrange_weights

_ZERO = "2000-01-01T12:00:00"  # UTC text from which nodes count

_STEP = 0.25 * DAY
"""Between the nodes of the slow angles [s]; Lagrange's polynomial through six has them to 1e-13 rad."""

_AROUND = np.arange(-2.0, 4.0)  # nodes about a time, from the one before it


def teme_to_gcrf(epoch: str, t: np.ndarray) -> np.ndarray:
    """Return the rotations (n, 3, 3) of TEME to GCRF; at 7e-12 rad/s they move no velocity."""
    number, part = np.divmod((epochs.seconds_between(_ZERO, epoch) + t) / _STEP, 1.0)
    before, place = np.unique(number, return_inverse=True)
    nodes = np.array([[_slow_angles(int(one)) for one in k + _AROUND] for k in before])
    weights = lagrange_weights(np.tile(_AROUND, (len(part), 1)), part)
    x, y, s, angle = np.einsum("nk,nka->an", weights, nodes[place])
    to_cirs = erfa.rz(angle, np.eye(3))
    return np.asarray(erfa.c2ixys(x, y, s).transpose(0, 2, 1) @ to_cirs)


def tod_to_gcrf(epoch: str, t: np.ndarray) -> np.ndarray:
    """Return the rotations (n, 3, 3) of the true equator and equinox of date to GCRF (IAU 2006/2000A)."""
    return np.asarray(erfa.pnm06a(*epochs.tt(epoch, t)).transpose(0, 2, 1))


@lru_cache(maxsize=20_000)
def _slow_angles(node: int) -> tuple[float, float, float, float]:
    """Return CIP x and y, CIO locator, and sidereal time less the Earth rotation angle at a node [rad]."""
    t = _STEP * node
    utc, tt = epochs.utc(_ZERO, t), epochs.tt(_ZERO, t)
    x, y, s = erfa.xys06a(*tt)
    return float(x), float(y), float(s), float(erfa.anpm(erfa.gmst82(*utc) - erfa.era00(*utc)))
