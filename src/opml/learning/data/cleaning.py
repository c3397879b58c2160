"""What is dropped from a dataset: the paper's two data cleanings, and rows that cross a manoeuvre.

The paper's are bounds on the drag coefficient and Tukey's fences on e_y.
Source: the paper, section 'Building the SVM model for the Simulated RSO'.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from opml.base.errors import InputError
from opml.orbits.manoeuvres import Manoeuvre, contain_any


@dataclass(frozen=True)
class Cleaning:
    """How a dataset is cleaned. By default only rows are dropped that lack something.

    cd_bounds: least and highest drag coefficient of an estimate, None for any
    fence: Tukey's fences on e_y, in interquartile ranges from the quartiles, None for no fences
    fence_days: first and last day of t_j of the rows that set the fences, None for all rows
    previous: t_b is the time of the last `kept_estimate`, or of the `track` just before
    manoeuvres: each with the time since which it is known
    window: how long before an estimate its oldest measurement may be [s]
    """

    cd_bounds: tuple[float, float] | None = None
    fence: float | None = None
    fence_days: tuple[float, float] | None = None
    previous: str = "kept_estimate"
    manoeuvres: tuple[Manoeuvre, ...] = ()
    window: float = 0.0

    @classmethod
    def from_settings(cls, settings: Mapping[str, Any]) -> Self:
        """Return the cleaning of settings: any of cd_min, cd_max, fence, fence_days, previous.

        A setting that is None cleans nothing. Raises InputError for cd_min without cd_max, or the reverse.
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
        """Return which estimates are kept for their drag coefficients (bool, shape of cd)."""
        if self.cd_bounds is None:
            return np.ones(np.shape(cd), dtype=bool)
        low, high = self.cd_bounds
        return drag_coefficient_inside(cd, cd_min=low, cd_max=high)

    def crosses(self, begin: np.ndarray, t: np.ndarray, known: np.ndarray) -> np.ndarray:
        """Return which rows (n,) have a manoeuvre in them, as far as anybody knew.

        begin: (n,) time of their earlier estimate, whose window lies before it [s]
        t: (n,) time of their prediction's estimate; of manoeuvres up to it those count that were known then
        known: (n,) when their error is known, and with it manoeuvres in between
        """
        crossed: np.ndarray = contain_any(begin, t, self.manoeuvres, window=self.window)
        crossed |= contain_any(t, known, self.manoeuvres)
        return crossed


OUTSIDE_FENCES = "outside Tukey fences"
"""Why a row is dropped that only the fences drop."""

PAPER_BOUNDS = (1.2, 3.2)
PAPER_FENCE = 3.0

PAPER_CLEANING = Cleaning(cd_bounds=PAPER_BOUNDS, fence=PAPER_FENCE)
"""The cleaning of the paper, with fences from all rows that survive its bounds."""


def drag_coefficient_inside(cd: np.ndarray, *, cd_min: float, cd_max: float) -> np.ndarray:
    """Return which drag coefficients lie in [cd_min, cd_max] (bool, shape of cd; NaN does not)."""
    return (cd >= cd_min) & (cd <= cd_max)


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
