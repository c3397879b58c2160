"""A catalogue's knowledge of an RSO: the tables at its tracks, and the making of more of them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Self

import numpy as np
import pandas as pd

from opml.base.constants import HOUR
from opml.base.errors import InputError
from opml.base.section import JobSettings
from opml.catalog.predict import other_windows
from opml.learning.data import dataset
from opml.learning.data.cleaning import Cleaning
from opml.learning.models.learners import JobLearner, arc_windows
from opml.orbits.manoeuvres import Manoeuvre, read_manoeuvres, when_burns_are_known
from opml.tables import read_measured, read_metadata, read_table


class KnownSettings(JobSettings):
    """Settings that made a catalogue's tables; learners are resolved."""

    cleaning: Cleaning
    window_hours: float
    cd_bounds: tuple[float, float] | None
    long_window_hours: float
    resonances: list[tuple[int, int]]
    learners: list[JobLearner]


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
    long_window_hours: float = 0.0  # of the mechanism's long arcs
    bounds: tuple[float, float] | None = None  # on Cd, None for any
    resonances: Sequence[tuple[int, int]] = ()  # pairs (k, m)
    manoeuvres: Sequence[Manoeuvre] = ()

    @classmethod
    def read(cls, files: Any, settings: KnownSettings) -> Self:
        """Read what the tables of a job hold.

        files: the job's input; where it has them, `long_estimates` and `arc_estimates` as the learners ask

        Raises InputError where a table is missing, damaged or does not belong to the others.
        """
        estimates = read_table(files.estimates, "estimates")
        gm = read_metadata(files.gravity_field)["gm"]
        at_estimates = dataset.of_estimates(
            estimates,
            read_table(files.predictions, "predictions"),
            read_measured(files.tracking),
            gm=gm,
            cleaning=settings.cleaning,
        )
        long_hours = settings.long_window_hours
        others = dict(zip(arc_windows(settings.learners), files.get("arc_estimates", []), strict=True))
        if long_estimates := files.get("long_estimates"):
            others[long_hours] = long_estimates
        return cls(
            estimates,
            at_estimates,
            settings.window_hours,
            gm,
            others={hours: read_table(path, "estimates") for hours, path in others.items()},
            long_window_hours=long_hours,
            bounds=settings.cd_bounds,
            resonances=settings.resonances,
            manoeuvres=read_manoeuvres(files.manoeuvres) if files.manoeuvres else [],
        )

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

    def own(self) -> pd.DataFrame:
        """Return the fits as `other_windows.exclude_burns` has them."""
        return other_windows.exclude_burns(self.estimates, manoeuvres=self.manoeuvres, window=self.window)

    def marked(self, rows: pd.DataFrame) -> pd.DataFrame:
        """Return rows of predictions with when a manoeuvre that they cross became known, where there is one.

        rows: with t_i and t_j, of a table that leaves out what goes across a manoeuvre that was known
        """
        t_i, t_j = rows["t_i"].to_numpy(), rows["t_j"].to_numpy()
        spans = ((t_i - self.window, t_i), (t_i, t_j))
        since = np.minimum(*(when_burns_are_known(*span, self.manoeuvres) for span in spans))
        return rows.assign(burn_known=since) if np.isfinite(since).any() else rows

    def may_depart(self) -> np.ndarray:
        """Return which estimates (n,) ephemerides may start from."""
        return dataset.may_depart(
            self.estimates, self.at_estimates, manoeuvres=self.manoeuvres, window=self.window
        )
