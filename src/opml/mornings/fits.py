"""The estimates of a morning: of the tracks that are over, that no earlier morning estimated.

The tracks have numbers that stay theirs. Estimates ascend in time: a track that comes after later ones were
estimated gets none of its own; fits of the tracks to come take its measurements.

Burns that nobody named are looked for where the newest estimates are far off what was predicted. A storm or a
track of another object puts estimates off, too. Whether a burn does, the tracks themselves tell
(`opml.catalog.associate.quarantine`), all of the last days in turn.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pandas as pd

from opml.base.constants import DAY
from opml.catalog.associate import quarantine
from opml.catalog.fit import fixes
from opml.catalog.fit.estimation import estimate_further, estimate_over_windows
from opml.catalog.fit.estimation_settings import Estimation
from opml.catalog.fit.first import first_orbit
from opml.catalog.fit.measurements import Measurements
from opml.catalog.propagator import Propagator
from opml.mornings.records import Records
from opml.mornings.watched_object import Watched
from opml.orbits.manoeuvres import Manoeuvre
from opml.tables import SCHEMAS, STATE

NO_NUMBER = -1  # the number of a track that gets no estimate


@dataclass(frozen=True)
class Recent:
    """The tracks of the last days that are over."""

    tracking: pd.DataFrame  # their measurements, of tracks numbered from 0
    numbers: np.ndarray  # (tracks,) the number of each in the records of an object, or NO_NUMBER
    at: np.ndarray
    ends: np.ndarray  # (tracks,) when each is over, or was made [s]

    @property
    def tracks(self) -> int:
        """Number of the tracks."""
        return len(self.numbers)

    @property
    def late(self) -> int:
        """Number of those that came after later ones had been estimated."""
        return int(np.sum(self.numbers == NO_NUMBER))


def recent_tracks(tracking: pd.DataFrame, kept: pd.DataFrame, *, now: float, reach: float) -> Recent:
    """Return the tracks that are over by `now` [s] and whose estimates are at most `reach` [s] old.

    tracking: that table, or another in its place
    kept: track and t of the estimates of earlier mornings
    """
    by_track = tracking.groupby("track", sort=True)
    at, ends = by_track["t"].min(), by_track["t"].max()
    is_kept = at.isin(kept["t"])
    is_recent = (ends <= now) & (at > now - reach)
    rows = tracking[tracking["track"].isin(at.index[is_recent])]
    known = dict(zip(kept["t"], kept["track"], strict=True))
    following = int(kept["track"].max()) + 1 if len(kept) else 0
    is_new = is_recent & ~is_kept & ~(at <= kept["t"].max())
    numbers = np.where(is_new, following + is_new.cumsum() - 1, at.map(known).fillna(NO_NUMBER)).astype(int)
    return Recent(
        rows.assign(track=np.searchsorted(at.index[is_recent], rows["track"])),
        numbers[is_recent],
        at[is_recent].to_numpy(),
        ends[is_recent].to_numpy(),
    )


FAR = 6.0  # standard deviations off from which on estimates may be of another orbit
_NEWEST = 3  # estimates that are off in the median
_FRESH = 2.0 * DAY  # ephemerides that are compared with them are no older [s]

_APART = 0.25 * DAY
"""Time between two burns that are told apart [s]: the same one may be found a little later."""
LOST = 2.0 * DAY  # after so long without an estimate that converged, an orbit is determined anew [s]


@dataclass(frozen=True)
class Fitting:
    """The fits of a morning to an object's recent tracks; a state that is given starts the very first."""

    watched: Watched
    recent: Recent

    @cached_property
    def _shared(self) -> tuple[Propagator, Measurements]:
        """Propagator and measurements of all fits."""
        watched = self.watched
        measured = fixes.measurements(
            self.recent.tracking, watched.model.orientation, watched.stations, watched.manoeuvres
        )
        return watched.model.fits, measured

    @property
    def _settings(self) -> Estimation:
        """Settings of fits over the base window."""
        return self.watched.plan.estimation

    def further(self, kept: pd.DataFrame) -> pd.DataFrame:
        """Return the estimates over the base window of the tracks that those kept have not.

        Raises InputError where an orbit has to be determined and cannot be.
        """
        tracks = np.flatnonzero(~np.isin(self.recent.numbers, [*kept["track"], NO_NUMBER]))
        if not len(tracks):
            return SCHEMAS["kept_estimates"].empty()
        propagator, measured = self._shared
        estimates = estimate_further(
            propagator,
            self.starts(kept),
            measured,
            settings=self._settings,
            tracks=tracks.tolist(),
            earlier=self._numbered(kept),
        )
        return self._kept(estimates.assign(window_hours=self._settings.window_hours))

    def over(self, windows: Sequence[float], start: pd.DataFrame, records: Records) -> pd.DataFrame:
        """Return the estimates of one track over other windows [h], where none are kept.

        start: the track's estimate over the base window, which the fits start from
        """
        kept = {hours: records.estimates_over(hours) for hours in windows}
        lacking = {
            hours: self._numbered(rows)
            for hours, rows in kept.items()
            if not rows["track"].isin(start["track"]).any()
        }
        if not lacking:
            return SCHEMAS["kept_estimates"].empty()
        (track,) = np.flatnonzero(self.recent.numbers == start["track"].iloc[0])
        propagator, measured = self._shared
        estimates = estimate_over_windows(
            propagator,
            self._table(start.assign(track=track), age=0.0),
            measured,
            settings=self._settings,
            track=int(track),
            earlier=lacking,
        )
        return self._kept(estimates)

    def newest_burn(self, kept: pd.DataFrame, *, since: float) -> Manoeuvre | None:
        """Return the newest burn that the tracks of the last days show, which windows of fits begin behind.

        kept: estimates of earlier mornings, whose states the fits may start from
        since: when the last burn was that is known [s]
        """
        propagator, measured = self._shared
        suspicious = self._settings.evolve(suspect_sigma=FAR)
        estimates = quarantine.estimate_all(propagator, self.starts(kept), measured, settings=suspicious)
        times = estimates.loc[estimates["burn_t"] > since + _APART, "burn_t"]
        return Manoeuvre(float(times.iloc[-1]), restarts=True) if len(times) else None

    def _kept(self, estimates: pd.DataFrame) -> pd.DataFrame:
        """Return new estimates as the table `kept_estimates`, of tracks by their numbers in the records."""
        numbered = estimates.assign(track=self.recent.numbers[estimates["track"]])
        return numbered[SCHEMAS["kept_estimates"].names]

    def starts(self, kept: pd.DataFrame) -> pd.DataFrame:
        """Return the `starts` table: of earlier estimates, or determined where these are too old."""
        earlier = self._numbered(kept)
        newest = earlier["t"].to_numpy(float)[earlier["converged"].to_numpy(bool)].max(initial=-np.inf)
        if self.recent.at[-1] - newest > LOST:
            given = self.watched.given if kept.empty else None
            return first_orbit.starts(*self._shared, known=given, settings=self._settings)
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
        places = {number: place for place, number in enumerate(self.recent.numbers)}
        return rows.assign(track=rows["track"].map(places).astype(int))


def are_far(judged: pd.DataFrame) -> bool:
    """Return whether the newest estimates are far off the newest ephemerides before them.

    judged: rows of that table of one morning
    """
    selected = judged[np.isfinite(judged["sigma_y"]) & (judged["duration"] < _FRESH)]
    nearest = selected.loc[selected.groupby("j")["duration"].idxmin()].nlargest(_NEWEST, "t_j")
    return len(nearest) == _NEWEST and bool(np.median(sigmas_off(nearest)) > FAR)


def sigmas_off(rows: pd.DataFrame) -> np.ndarray:
    """Return how far off (n,) along the track ephemerides were, in the standard deviations of that."""
    return np.asarray(rows["e_y"].abs() / np.hypot(rows["sigma_y"], rows["doubt_y"]), float)
