"""An estimate as fits hand it on: its window, its fit, and which of its numbers count."""

from dataclasses import dataclass

import numpy as np

from opml.catalog.fit.least_squares import Fit
from opml.catalog.fit.measurements import Window
from opml.catalog.fit.solutions import Solution


@dataclass(frozen=True)
class Estimate:
    """One track's estimate under way.

    kept: (numbers,) bool, which of the window's measured numbers count; None: all of them
    """

    window: Window
    fit: Fit
    kept: np.ndarray | None = None

    @property
    def solution(self) -> Solution:
        """What the fit came to."""
        return Solution(self.window.at, self.fit.best, self.fit.covariance, self.fit.converged)
