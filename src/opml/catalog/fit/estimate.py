"""An estimate as fits hand it on: its window, its fit, and which of its numbers count."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from opml.catalog.fit.least_squares import Fit
from opml.catalog.fit.measurements import Measurements, Window
from opml.catalog.fit.starts import Solution
from opml.tables import PARAMETER_COVARIANCES, PARAMETERS


@dataclass(frozen=True)
class Estimate:
    """A track's estimate, not yet complete."""

    window: Window
    fit: Fit
    kept: np.ndarray | None = None  # (numbers,) bool, which measured numbers count; None: all of them

    @property
    def solution(self) -> Solution:
        """The fit's result."""
        return Solution(self.window.at, self.fit.best, self.fit.covariance, self.fit.converged)

    def row(self, measured: Measurements, *, tells_rejected: bool) -> dict[str, Any]:
        """Return the estimate as a row of the table, with the number of rejected numbers where needed."""
        window, fit = self.window, self.fit
        count = measured.count(window.rows) if self.kept is None else int(np.count_nonzero(self.kept))
        rms = np.sqrt(fit.cost / count) if np.isfinite(fit.cost) else np.nan
        return {
            "track": window.track,
            "t": measured.epochs[window.at],
            **dict(zip(PARAMETERS, fit.best, strict=True)),
            **dict(zip(PARAMETER_COVARIANCES, fit.covariance[np.tril_indices(7)], strict=True)),
            "iterations": fit.iterations,
            "converged": fit.converged,
            "reason": fit.reason,
            "tracks_used": window.tracks,
            "measurements_used": window.measurements,
            "weighted_rms": rms,
            **(self._rejected(measured) if tells_rejected else {}),
        }

    def _rejected(self, measured: Measurements) -> dict[str, int]:
        """Return how many numbers of the window and of the track do not count."""
        window, kept = self.window, self.kept
        if kept is None:
            return {"rejected": 0, "rejected_of_track": 0}
        first, last = measured.first_row[window.track : window.track + 2]
        rows = window.index[measured.layout(window.rows)[0]]
        return {
            "rejected": int(np.count_nonzero(~kept)),
            "rejected_of_track": int(np.count_nonzero(~kept & (rows >= first) & (rows < last))),
        }
