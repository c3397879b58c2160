"""The estimates of a morning: of the tracks that no earlier morning estimated."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd

from opml.base.constants import DAY
from opml.catalog.fit.estimation import estimate_further, estimate_over_windows
from opml.catalog.fit.estimation_settings import Estimation
from opml.catalog.fit.first import first_orbit
from opml.catalog.fit.first.first_orbit import TimedState
from opml.catalog.fit.measurements import Measurements
from opml.catalog.flight import Flight
from opml.mornings.tracks import NO_NUMBER, Recent
from opml.tables import SCHEMAS, STATE

LOST = 2.0 * DAY
"""After so long without an estimate that converged, an orbit is determined anew [s]."""


@dataclass(frozen=True)
class Fitting:
    """What the fits of a morning share.

    measured: the measurements of the recent tracks
    settings: of fits over the base window
    given: a state that the very first fits may start from
    """

    flight: Flight
    measured: Measurements
    recent: Recent
    settings: Estimation
    given: TimedState | None

    def further(self, kept: pd.DataFrame) -> pd.DataFrame:
        """Return the estimates over the base window of the tracks that those kept have not.

        Raises InputError where an orbit has to be determined and cannot be.
        """
        tracks = np.flatnonzero(~np.isin(self.recent.numbers, [*kept["track"], NO_NUMBER]))
        if not len(tracks):
            return SCHEMAS["kept_estimates"].empty()
        found = estimate_further(
            self.flight,
            self.starts(kept),
            self.measured,
            settings=self.settings,
            tracks=tracks.tolist(),
            earlier=self._numbered(kept),
        )
        hours = self.settings.window_hours
        return found.assign(track=self.recent.numbers[found["track"]], window_hours=hours)

    def over(self, start: pd.DataFrame, kept: Mapping[float, pd.DataFrame]) -> pd.DataFrame:
        """Return the estimates of one track over other windows.

        start: the track's estimate over the base window, which the fits start from
        kept: earlier estimates, by the window [h]
        """
        (track,) = np.flatnonzero(self.recent.numbers == start["track"].iloc[0])
        found = estimate_over_windows(
            self.flight,
            self._table(start.assign(track=track), age=0.0),
            self.measured,
            settings=self.settings,
            track=int(track),
            earlier={hours: self._numbered(rows) for hours, rows in kept.items()},
        )
        return found.assign(track=self.recent.numbers[found["track"]])

    def starts(self, kept: pd.DataFrame) -> pd.DataFrame:
        """Return the `starts` table: of earlier estimates, or determined where these are too old."""
        earlier = self._numbered(kept)
        newest = earlier["t"].to_numpy(float)[earlier["converged"].to_numpy(bool)].max(initial=-np.inf)
        if self.recent.at[-1] - newest > LOST:
            given = self.given if kept.empty else None
            return first_orbit.starts(self.flight, self.measured, known=given, settings=self.settings)
        return self._table(earlier, age=np.inf)

    def _table(self, estimates: pd.DataFrame, *, age: float) -> pd.DataFrame:
        """Return the `starts` table of estimates that converged; of other tracks nothing is known."""
        states = np.full((self.recent.tracks, len(STATE)), np.nan)
        known = estimates[estimates["converged"].to_numpy(bool)]
        states[known["track"].to_numpy(int)] = known[STATE].to_numpy()
        table = pd.DataFrame({"track": np.arange(len(states)), "t": self.recent.at, "age": age})
        return table.assign(**dict(zip(STATE, states.T, strict=True)))

    def _numbered(self, kept: pd.DataFrame) -> pd.DataFrame:
        """Return those of the kept estimates whose tracks are recent, numbered as these."""
        rows = kept[kept["track"].isin(self.recent.numbers)]
        return rows.assign(track=self.recent.places(rows["track"]))
