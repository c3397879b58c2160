"""Points before the epoch of mean elements, where SGP4 tells the orbit that the elements were fitted to."""

from dataclasses import dataclass

import numpy as np
import pandas as pd

from opml.interop.element_sets.histories import states_of
from opml.tables import STATE


@dataclass(frozen=True)
class SetSampling:
    """Which points stand for a set of mean elements."""

    reach: float  # from the first point to the last [s]
    step: float  # between points [s]

    def times(self, end: float) -> np.ndarray:
        """Return the times (n,) of the points of a set up to its last one, `end` [s]."""
        return end - self.step * np.arange(round(self.reach / self.step), -1, -1)


def before(row: pd.Series, end: float, *, epoch: str, sampling: SetSampling) -> pd.DataFrame:
    """Return the points of a set of mean elements up to a time, where SGP4 has them: t, state in GCRF.

    row: of a table `element_sets`
    end: the set's epoch, or soon behind it [s]

    Shortly before a re-entry SGP4 may fail within hours.
    """
    t = sampling.times(end)
    states = states_of(row, epoch=epoch, t=t)
    failed = np.flatnonzero(np.isnan(states[:, 0]))
    first = failed[-1] + 1 if failed.size else 0
    return pd.DataFrame(states[first:], columns=STATE).assign(t=t[first:])
