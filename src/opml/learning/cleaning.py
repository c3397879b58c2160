"""The paper's two data cleanings: bounds on the drag coefficient and Tukey's fences on e_y.

Source: the paper, section 'Building the SVM model for the Simulated RSO'.
"""

import numpy as np

from opml.errors import InputError


def drag_coefficient_inside(cd: np.ndarray, *, cd_min: float, cd_max: float) -> np.ndarray:
    """Which drag coefficients lie in [cd_min, cd_max] (bool, shape of cd; NaN does not)."""
    return (cd >= cd_min) & (cd <= cd_max)


def quartiles(values: np.ndarray) -> tuple[float, float]:
    """First and third quartile, as MATLAB (the paper's tool) takes them: Hazen's plotting positions."""
    q1, q3 = np.quantile(values, [0.25, 0.75], method="hazen")
    return float(q1), float(q3)


def tukey_fences(values: np.ndarray, *, fence: float) -> tuple[float, float]:
    """Interval [q1 - fence (q3 - q1), q3 + fence (q3 - q1)] outside which a value is an outlier.

    The paper prints q1 for both ends, a slip; Tukey's upper fence starts at q3 (Exploratory Data Analysis,
    1977). Raises InputError without values.
    """
    if np.size(values) == 0:
        raise InputError("Tukey's fences: expected at least one value of e_y to take quartiles of, got none")
    q1, q3 = quartiles(values)
    return q1 - fence * (q3 - q1), q3 + fence * (q3 - q1)
