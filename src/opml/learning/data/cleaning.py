"""Rows that are dropped from a dataset: the paper's two data cleanings, and rows that cross a manoeuvre.

The paper's are bounds on the drag coefficient and Tukey's fences on e_y.
Source: the paper, section 'Building the SVM model for the Simulated RSO'.
"""

from typing import Literal

import numpy as np

from opml.base.errors import InputError
from opml.base.section import Section, absent, setting
from opml.base.setting_types import Absent, Days, Positive

Previous = Literal["kept_estimate", "track"]


class Cleaning(Section):
    """Rows that are dropped; none by default."""

    cd_min: Absent[float] = absent("least drag coefficient of an estimate that is used; any by default")
    cd_max: Absent[float] = absent("largest drag coefficient of an estimate that is used; any by default")
    fence: Absent[Positive] = absent("Tukey's fences on e_y, from the quartiles; none by default", unit="IQR")
    fence_days: Absent[Days] = absent("window of t_j whose rows set the fences")
    previous: Previous = setting(
        "t_b is that of the previous `kept_estimate`, or of the previous `track`", default="kept_estimate"
    )

    @property
    def cd_bounds(self) -> tuple[float, float] | None:
        """Least and highest drag coefficient of an estimate; None for any; InputError for one alone."""
        match [bound for bound in (self.cd_min, self.cd_max) if bound is not None]:
            case [low, high]:
                return low, high
            case [alone]:
                raise InputError(f"cleaning: cd_min, cd_max: expected both or none, got {alone:g} alone")
        return None

    def keeps(self, cd: np.ndarray) -> np.ndarray:
        """Return which estimates are kept for their drag coefficients (bool, shape of cd)."""
        if self.cd_bounds is None:
            return np.ones(np.shape(cd), dtype=bool)
        low, high = self.cd_bounds
        return (cd >= low) & (cd <= high)


OUTSIDE_FENCES = "outside Tukey fences"  # why a row is dropped that only the fences drop


def quartiles(values: np.ndarray) -> tuple[float, float]:
    """Return first and third quartile by Hazen's plotting positions, as MATLAB (the paper's tool) does."""
    q1, q3 = np.quantile(values, [0.25, 0.75], method="hazen")
    return float(q1), float(q3)


def tukey_fences(values: np.ndarray, *, fence: float) -> tuple[float, float]:
    """Return the ends of [q1 - fence (q3 - q1), q3 + fence (q3 - q1)], outside which a value is an outlier.

    The paper prints q1 at both ends, which is a slip: Tukey's upper fence starts at q3 (Exploratory Data
    Analysis, 1977). Raises InputError without values.
    """
    if np.size(values) == 0:
        raise InputError("Tukey's fences: expected at least one value of e_y to take quartiles of, got none")
    q1, q3 = quartiles(values)
    return q1 - fence * (q3 - q1), q3 + fence * (q3 - q1)
