"""A catalogue's knowledge of an RSO: the tables at its tracks, and the making of more of them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
import pandas as pd

from opml.base.constants import HOUR
from opml.base.errors import InputError
from opml.catalog.predict import other_windows
from opml.learning.data import dataset
from opml.orbits.manoeuvres import Manoeuvre


@dataclass(frozen=True)
class KnownTables:
    """A catalogue's knowledge of an RSO.

    others: tables of fits of the same tracks over other windows, by these [h], as learners ask for them
    manoeuvres: those of any table, each with the time since which it is known
    """

    estimates: pd.DataFrame  # the table, of fits over window_hours
    at_estimates: pd.DataFrame  # from `dataset.of_estimates`
    window_hours: float
    gm: float  # [m3/s2]
    others: Mapping[float, pd.DataFrame] = field(default_factory=dict)
    manoeuvres: Sequence[Manoeuvre] = ()

    @property
    def window(self) -> float:
        """Length of the window of the fits [s]."""
        return HOUR * self.window_hours

    def other(self, hours: float) -> pd.DataFrame:
        """Return the fits over another window [h]; raise InputError where there are none."""
        if hours not in self.others:
            expected = "expected fits over another window, as the learner asks for"
            raise InputError(f"ephemeris: {expected}, got none")
        return self.others[hours]

    def estimates_without_burns(self, hours: float) -> pd.DataFrame:
        """Return the fits over another window [h] as `other_windows.exclude_burns` has them."""
        return other_windows.exclude_burns(self.other(hours), manoeuvres=self.manoeuvres, window=HOUR * hours)

    def may_depart(self) -> np.ndarray:
        """Return which estimates (n,) ephemerides may start from."""
        return dataset.may_depart(
            self.estimates, self.at_estimates, manoeuvres=self.manoeuvres, window=self.window
        )
