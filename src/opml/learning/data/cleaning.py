"""The paper's two data cleanings: bounds on the drag coefficient and Tukey's fences on e_y.

Source: the paper, section 'Building the SVM model for the Simulated RSO'.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from opml.base.errors import InputError


@dataclass(frozen=True)
class Cleaning:
    """What a dataset is cleaned by. By default nothing is dropped but rows that lack something.

    cd_bounds : least and highest drag coefficient of an estimate, None for any.
    fence : Tukey's fences on e_y, in interquartile ranges from the quartiles; None for none.
    fence_days : first and last day of t_j of the rows that set the fences, None for all rows.
    previous : t_b is that of the last `kept_estimate`, or of the `track` just before.
    """

    cd_bounds: tuple[float, float] | None = None
    fence: float | None = None
    fence_days: tuple[float, float] | None = None
    previous: str = "kept_estimate"

    @classmethod
    def from_settings(cls, settings: Mapping[str, Any]) -> Self:
        """The cleaning that settings ask for: cd_min, cd_max, fence, fence_days, previous, or some of them.

        One that is None asks for nothing. Raises InputError for one of cd_min and cd_max without the other.
        """
        bounds = [settings[name] for name in ("cd_min", "cd_max") if settings.get(name) is not None]
        if len(bounds) == 1:
            raise InputError(f"cleaning: cd_min, cd_max: expected both or none, got {bounds[0]} alone")
        days = settings.get("fence_days")
        return cls(
            cd_bounds=(bounds[0], bounds[1]) if bounds else None,
            fence=settings.get("fence"),
            fence_days=None if days is None else tuple(days),
            previous=settings.get("previous") or cls.previous,
        )

    def keeps(self, cd: np.ndarray) -> np.ndarray:
        """Which estimates are kept for their drag coefficients (bool, shape of cd)."""
        if self.cd_bounds is None:
            return np.ones(np.shape(cd), dtype=bool)
        low, high = self.cd_bounds
        return drag_coefficient_inside(cd, cd_min=low, cd_max=high)


OUTSIDE_FENCES = "outside Tukey fences"
"""Why a row is dropped that all but the fences would keep."""

PAPER_BOUNDS = (1.2, 3.2)
PAPER_FENCE = 3.0

PAPER = Cleaning(cd_bounds=PAPER_BOUNDS, fence=PAPER_FENCE)
"""The paper's, with fences from all rows that survive its bounds."""


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
