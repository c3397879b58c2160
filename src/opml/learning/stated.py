"""What a corrected ephemeris states of its positions: standard deviations by duration and time.

They come from past residuals behind rolling origins (`opml.learning.uncertainty`), which grow with the time
since the training ended. Where a training is too short for origins, they come from estimates held out of it
(`opml.learning.residuals`), and do not grow.
"""

from collections.abc import Callable

import numpy as np
import pandas as pd

from opml.files import FilePath
from opml.learning.residuals import sigmas
from opml.learning.uncertainty import Uncertainty
from opml.tables import read_kind, read_table

Stated = Callable[[np.ndarray, np.ndarray], np.ndarray]
"""Standard deviations (n, 3) in RSW [m] at durations (n,) and times (n,), both [s]."""


def read(path: FilePath, *, trained_until: float) -> Stated:
    """What a table `uncertainty` or `residuals` states of a model that learned up to a time [s].

    Raises InputError where the file is missing or damaged.
    """
    if read_kind(path) == "uncertainty":
        return of_uncertainty(read_table(path, "uncertainty"), trained_until=trained_until)
    return of_residuals(read_table(path, "residuals"))


def of_uncertainty(table: pd.DataFrame, *, trained_until: float) -> Stated:
    """What an `uncertainty` table states."""
    known = Uncertainty.from_table(table)

    def at(duration: np.ndarray, t: np.ndarray) -> np.ndarray:
        covariance = known.residual_covariance(duration, t - trained_until)
        deviations: np.ndarray = np.sqrt(covariance[:, range(3), range(3)])
        return deviations

    return at


def of_residuals(table: pd.DataFrame) -> Stated:
    """What a `residuals` table states, at whatever time."""
    return lambda duration, t: sigmas(table, duration)
