"""Rotation from GCRF to ITRF, its rate, and states in both, at many times."""

import numpy as np
import pandas as pd

from opml.base.compiled import decorators
from opml.base.constants import EARTH_RATE
from opml.dynamics.kernels.surroundings import orient

ORIENTATION = ["x_cip", "y_cip", "s_cio", "x_pole", "y_pole", "era_offset"]
"""Columns of the Earth orientation table, in the order the kernels read them."""

_, _entry = decorators(nogil=True, error_model="numpy")


def gcrf_to_itrf(earth_orientation: pd.DataFrame, t: np.ndarray) -> np.ndarray:
    """Return rotation matrices (n, 3, 3) at times t (n,) [s], from the Earth orientation table."""
    nodes = earth_orientation["t"].to_numpy()
    # Copies, whose type does not depend on where an array is from: the kernel is compiled once.
    orientation = np.array(earth_orientation[ORIENTATION], float, order="C")
    return _rotations(np.array(t, float), nodes[0], nodes[1] - nodes[0], orientation).reshape(-1, 3, 3)


def spin(earth_orientation: pd.DataFrame) -> np.ndarray:
    """Return the Earth's rotation vector (nodes, 3) in GCRF [rad/s], at the nodes of its orientation table.

    The Earth turns about the CIP at the rate of its rotation angle, while the CIP moves without turning
    about itself: w = rate p + p x dp/dt (IERS Conventions 2010, sec. 5.2.3). The motion of the pole in the
    Earth, below 1e-12 rad/s, is left out.
    """
    t, x, y = (earth_orientation[name].to_numpy() for name in ("t", "x_cip", "y_cip"))
    pole = np.stack([x, y, np.sqrt(1.0 - x * x - y * y)], axis=-1)
    rate = EARTH_RATE + np.gradient(earth_orientation["era_offset"].to_numpy(), t)
    return rate[:, None] * pole + np.cross(pole, np.gradient(pole, t, axis=0))


def states_to_gcrf(
    earth_orientation: pd.DataFrame, t: np.ndarray, positions: np.ndarray, velocities: np.ndarray
) -> np.ndarray:
    """Return the states (n, 6) in GCRF [m, m/s] of positions and velocities (n, 3) in ITRF at t (n,) [s].

    v_GCRF = R^T v_ITRF + w x r_GCRF, with the rotation R from GCRF to ITRF and the Earth's rotation vector w.
    """
    turns, rate = gcrf_to_itrf(earth_orientation, t), spin(earth_orientation)
    turning = np.stack([np.interp(t, earth_orientation["t"], rate[:, k]) for k in range(3)], axis=1)
    inertial = np.einsum("nji,nj->ni", turns, positions)
    moving = np.einsum("nji,nj->ni", turns, velocities) + np.cross(turning, inertial)
    return np.concatenate([inertial, moving], axis=1)


@_entry
def _rotations(t: np.ndarray, first: float, step: float, orientation: np.ndarray) -> np.ndarray:
    out = np.empty((t.shape[0], 9))
    for n in range(t.shape[0]):
        orient(t[n], first, step, orientation, out[n])
    return out
