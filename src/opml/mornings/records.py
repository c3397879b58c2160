"""Records of an object, kept from morning to morning."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import ClassVar, Self

import numpy as np
import pandas as pd

from opml.base.constants import HOUR
from opml.ephemerides.fit_sizes import FORMAL
from opml.ephemerides.paths import Paths
from opml.orbits.manoeuvres import Manoeuvre, are_unaware
from opml.tables import SCHEMAS


@dataclass(frozen=True)
class Records:
    """Tables and ephemerides that mornings left."""

    TABLES: ClassVar = ("kept_estimates", "judged", "issued")

    estimates: pd.DataFrame  # with the window of each, `window_hours`
    judged: pd.DataFrame  # what later estimates or sets judged, with the `model` of each
    issued: pd.DataFrame  # a row a morning
    paths: Sequence[Paths] = ()  # of mornings whose ephemerides tracks to come may reach

    @classmethod
    def empty(cls) -> Self:
        """Return the records of an object without a morning."""
        return cls(*(SCHEMAS[name].empty() for name in cls.TABLES))

    @property
    def tables(self) -> dict[str, pd.DataFrame]:
        """Its tables, by the names of their schemas."""
        return dict(zip(self.TABLES, (self.estimates, self.judged, self.issued), strict=True))

    @property
    def burns(self) -> list[Manoeuvre]:
        """The burns that mornings found, which windows of fits begin anew behind."""
        times = self.issued["burn_t"].dropna()
        return [Manoeuvre(float(t), restarts=True) for t in times]

    @property
    def formal(self) -> pd.DataFrame:
        """Formal errors of the ephemerides that were issued, by the track that they start from."""
        return self.issued.dropna(subset="c").drop_duplicates("i", keep="last").set_index("i")[FORMAL]

    def estimates_over(self, hours: float) -> pd.DataFrame:
        """Return the estimates over a window [h] in the order of tracks.

        They are made in another where the newest track's fit failed and a morning began at the one before.
        """
        rows = self.estimates[self.estimates["window_hours"] == hours].sort_values("track", kind="stable")
        return rows.drop(columns="window_hours").reset_index(drop=True)

    def of_window(self, hours: float, manoeuvres: Sequence[Manoeuvre] = ()) -> pd.DataFrame:
        """Return the estimates over a window [h]; a fit across a burn, found later, has not converged.

        manoeuvres: that are known, beside those that mornings found
        """
        rows = self.estimates_over(hours)
        return rows.assign(
            converged=rows["converged"] & ~self._across(rows["t"], rows["t"], hours, manoeuvres)
        )

    def rows_unaffected_by_burns(self, hours: float, manoeuvres: Sequence[Manoeuvre] = ()) -> pd.DataFrame:
        """Return the rows of `judged` whose estimates, over a window [h], know of all burns on their way.

        manoeuvres: as for `of_window`
        """
        return self.judged[~self._across(self.judged["t_i"], self.judged["t_j"], hours, manoeuvres)]

    def _across(
        self, begin: pd.Series, end: pd.Series, hours: float, manoeuvres: Sequence[Manoeuvre]
    ) -> np.ndarray:
        """Return which spans hold a burn, or begin with a fit across it that was made before it was found."""
        found, before = self.issued["burn_t"].notna(), self.issued["morning"].shift(fill_value=-np.inf)
        burns = map(Manoeuvre, self.issued.loc[found, "burn_t"], before[found])
        spans = begin.to_numpy(float), end.to_numpy(float)
        return are_unaware(*spans, [*burns, *manoeuvres], window=HOUR * hours)

    def and_then(self, more: "Records", *, since: float) -> Self:
        """Return the records with those of the next morning; since: ephemerides up to then [s] go."""
        return replace(
            self,
            estimates=below([self.estimates, more.estimates], "kept_estimates"),
            judged=below([self.judged, more.judged], "judged"),
            issued=below([self.issued, more.issued], "issued"),
            paths=[paths for paths in (*self.paths, *more.paths) if paths.made_at > since],
        )


def below(tables: Sequence[pd.DataFrame], name: str) -> pd.DataFrame:
    """Return tables of a schema below each other."""
    filled = [table for table in tables if len(table)]
    return pd.concat(filled, ignore_index=True) if filled else SCHEMAS[name].empty()
