"""An orbit from three positions: Gibbs's method, and that of Herrick and Gibbs where they are close.

Positions are (3,) in an inertial frame [m], in the order of time; the velocity is that at the second one
[m/s]. Radars' noise makes three single positions poor ones, so a curve is laid through a whole track first.
Source: Vallado, Fundamentals of Astrodynamics and Applications, 4th ed., algorithms 54 and 55; Curtis,
Orbital Mechanics for Engineering Students, algorithm 5.1.
"""

import numpy as np

from opml.base.constants import EARTH_RATE

SMALL_ANGLE = np.radians(5.0)
"""Angle between neighbouring positions below which Gibbs's method feels noise more than the other method."""

_DEGREE = 4
_KNOTS = np.array([-0.8, 0.0, 0.8])
"""Times of the three positions on the curve, from -1 at its beginning to 1 at its end."""


def gibbs(positions: np.ndarray, gm: float) -> np.ndarray:
    """Return the velocity (3,) at the second of three positions (3, 3) of a Kepler orbit, without times."""
    r1, r2, r3 = positions
    d1, d2, d3 = np.linalg.norm(positions, axis=1)
    n = d1 * np.cross(r2, r3) + d2 * np.cross(r3, r1) + d3 * np.cross(r1, r2)
    d = np.cross(r1, r2) + np.cross(r2, r3) + np.cross(r3, r1)
    s = (d2 - d3) * r1 + (d3 - d1) * r2 + (d1 - d2) * r3
    scale = np.sqrt(gm / (np.linalg.norm(n) * np.linalg.norm(d)))
    return scale * (np.cross(d, r2) / d2 + s)


def herrick_gibbs(positions: np.ndarray, t: np.ndarray, gm: float) -> np.ndarray:
    """Return the velocity (3,) at the second of three positions (3, 3) at t (3,) [s], by Taylor's series."""
    r1, r2, r3 = positions
    c1, c2, c3 = gm / (12.0 * np.linalg.norm(positions, axis=1) ** 3)
    t31, t32, t21 = t[2] - t[0], t[2] - t[1], t[1] - t[0]
    return (
        -t32 * (1.0 / (t21 * t31) + c1) * r1
        + (t32 - t21) * (1.0 / (t21 * t32) + c2) * r2
        + t21 * (1.0 / (t32 * t31) + c3) * r3
    )


def velocity(positions: np.ndarray, t: np.ndarray, gm: float) -> np.ndarray:
    """Return the velocity (3,) at the second of three positions (3, 3), by the method for their angles."""
    ahead, behind = positions[:-1], positions[1:]
    cosine = np.sum(ahead * behind, axis=1) / np.linalg.norm(ahead, axis=1) / np.linalg.norm(behind, axis=1)
    if np.arccos(np.clip(cosine, -1.0, 1.0)).min() < SMALL_ANGLE:
        return herrick_gibbs(positions, t, gm)
    return gibbs(positions, gm)


def orbit_state(t: np.ndarray, positions: np.ndarray, gm: float) -> tuple[float, np.ndarray]:
    """Return time [s] and state (6,) in the middle of a track of noisy positions (n, 3) at t (n,).

    At least 3 times have to be distinct.
    """
    times, three = smoothed(t, positions)
    return float(times[1]), np.append(three[1], velocity(three, times, gm))


def smoothed(t: np.ndarray, positions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return three times (3,) [s] within t (n,), and where a curve through positions (n, 3) is then.

    The curve is a polynomial of degree 4 at most, fitted by least squares.
    """
    middle, half = 0.5 * (t[0] + t[-1]), 0.5 * (t[-1] - t[0])
    degree = min(_DEGREE, len(np.unique(t)) - 1)
    curve = np.polynomial.polynomial.polyfit((t - middle) / half, positions, degree)
    three = np.polynomial.polynomial.polyval(_KNOTS, curve).T
    return middle + half * _KNOTS, three


def unturned(t: np.ndarray, positions: np.ndarray) -> np.ndarray:
    """Return positions (n, 3) in ITRF at times t (n,) [s] in a frame that stands still, the ITRF of t = 0."""
    angle = EARTH_RATE * t
    x, y, z = positions.T
    return np.stack(
        [np.cos(angle) * x - np.sin(angle) * y, np.sin(angle) * x + np.cos(angle) * y, z], axis=-1
    )
