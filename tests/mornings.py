"""Replayed mornings made up for tests: errors of a known size on known days."""

import numpy as np
import pandas as pd

from opml.base.constants import DAY
from opml.tables import DOUBT, SIGMA_STATE, SPREAD

RATE = 1.13e-3
"""Rate at which a position turns [rad/s]."""

SIZES = {"e_x": 10.0, "e_z": 30.0}
"""Standard deviations of the radial and the cross-track error [m]."""


def replays(*, days=20, a_morning=4, along=100.0, seed=0, first=0):
    """A `replay` table: predictions to each of the next seven days, e_y normal and `along` [m] wide a day."""
    rng = np.random.default_rng(seed)
    t_i = np.repeat(first + np.arange(days * a_morning) / a_morning, 7) * DAY
    duration = np.tile(np.arange(1.0, 8.0), days * a_morning) * DAY - 0.1 * DAY
    count, t_j = len(t_i), t_i + duration
    errors = {name: size * rng.normal(size=count) for name, size in SIZES.items()}
    errors["e_y"] = along * duration / DAY * rng.normal(size=count)
    velocities = {
        "e_vx": -RATE * errors["e_y"] + 2e-2 * rng.normal(size=count),
        "e_vy": -RATE * errors["e_x"] + 5e-3 * rng.normal(size=count),
        "e_vz": 3e-2 * rng.normal(size=count),
    }
    times = {"t_i": t_i, "t_j": t_j, "t_known": t_j, "morning": DAY * np.floor(t_i / DAY)}
    pairs = {"i": np.repeat(np.arange(days * a_morning), 7), "j": np.arange(count)}
    return pd.DataFrame(
        pairs
        | times
        | {"duration": duration, "rate": RATE, "before": 50.0 * errors["e_y"]}
        | errors
        | velocities
        | dict.fromkeys([*DOUBT, *SPREAD, *SIGMA_STATE], 0.0)
    )
