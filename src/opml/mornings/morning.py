"""One morning of one object: new tracks are fitted, earlier ephemerides judged, the best model selected.

Nothing that was measured, published or made after the morning touches it. What an earlier morning left is
never made again.
"""

from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from opml.base.constants import DAY, HOUR
from opml.base.errors import InputError
from opml.base.provenance import settings_digest
from opml.ephemerides.fit_sizes import formal_errors
from opml.ephemerides.paths import Paths
from opml.interop import oem
from opml.mornings import candidates, fits, issued, outcomes, verdicts
from opml.mornings.days import MorningResult, WatchedObject
from opml.mornings.fits import Recent
from opml.mornings.issued import SelectedModel
from opml.mornings.outcomes import DO_NOT_USE, UNPROVEN
from opml.mornings.records import Records, below
from opml.mornings.verdicts import Verdict
from opml.mornings.watched_object import Watched
from opml.orbits.manoeuvres import Manoeuvre
from opml.tables import SCHEMAS, STATE

_OF_EPHEMERIS = ("height_km", "inclination_deg", "expected")
_NOT_ISSUED = Verdict(UNPROVEN, "nothing was issued yet")


def tracked(watched: Watched) -> WatchedObject:
    """Return an object of tracks, fixes or ranges on its mornings."""
    tracking, measured = watched.tracking, {*watched.tracking.get("station", ())}

    def leave(records: Records, now: float) -> MorningResult:
        result = morning(watched, records, now=now)
        write = partial(result.write, watched.plan.epoch) if result.ephemeris is not None else None
        return MorningResult(result.records, result.verdict, result.figures, write)

    return WatchedObject(
        watched.plan,
        watched.plan.max_days,
        float(tracking.groupby("track")["t"].max().min()),
        float(tracking["t"].max()),
        {one.name: settings_digest(one.row) for one in watched.stations if one.name in measured},
        leave,
    )


def morning(watched: Watched, records: Records, *, now: float) -> "TrackMorning":
    """Return a morning that is over.

    records: of earlier mornings
    now: when it is [s]

    What cannot be made of what was measured is told by the verdict: a morning that raised an error for it
    would be tried again for ever.
    """
    result = TrackMorning(watched.aware_of(records.burns), records, now)
    try:
        result.fit()
        result.issue(result.select())
    except InputError as reason:
        if result.verdict.word != DO_NOT_USE:
            result.verdict = Verdict(DO_NOT_USE, str(reason))
    return result


@dataclass
class TrackMorning:
    """A morning as far as it came: each step adds what it made, or raises InputError where it makes nothing.

    estimates, judged, paths: of this morning
    starts: the estimate that ephemerides start from, a table of one row
    whole: all records with all that this morning fitted and judged
    """

    watched: Watched  # with the burns that are known by now
    earlier: Records  # records of the mornings before
    now: float
    recent: Recent = field(init=False)
    fitting: fits.Fitting = field(init=False)
    whole: Records = field(init=False)
    estimates: pd.DataFrame = field(default_factory=SCHEMAS["kept_estimates"].empty)
    judged: pd.DataFrame = field(default_factory=SCHEMAS["judged"].empty)
    burn: Manoeuvre | None = None  # that the estimates showed, with which they were made again
    starts: pd.DataFrame = field(default_factory=issued.no_start)
    paths: list[Paths] = field(default_factory=list)
    selected: SelectedModel | None = None
    ephemeris: pd.DataFrame | None = None
    verdict: Verdict = _NOT_ISSUED

    def fit(self) -> None:
        """Estimate the tracks that are new; again behind a burn, where the estimates show one."""
        plan = self.watched.plan
        kept = self.earlier.estimates_over(plan.base)
        self.recent = fits.recent_tracks(self.watched.tracking, kept, now=self.now, reach=plan.reach)
        if not self.recent.tracks:
            raise InputError("no tracks of the last days")
        self.fitting = fits.Fitting(self.watched, self.recent)
        estimates = self.fitting.further(kept)
        self.judged = verdicts.judge(self.watched, estimates, self.recent, self.earlier)
        if "station" in self.watched.tracking and fits.are_far(self.judged):
            last = max((one.t for one in self.earlier.burns), default=-np.inf)
            self.burn = self.fitting.newest_burn(kept, since=last)
        if self.burn:
            self.watched = self.watched.aware_of([self.burn])
            self.fitting = fits.Fitting(self.watched, self.recent)
            estimates = self.fitting.further(kept)
        self.estimates = estimates

    def select(self) -> Paths:
        """Return the ephemerides of all models from the newest estimate that they may start from."""
        row = issued.row(self.now, issued.no_start(), None, DO_NOT_USE, burn=self.burn)
        so_far = self.earlier.and_then(Records(self.estimates, self.judged, row), since=self.now)
        starts = candidates.newest_start(self.now, self.watched, so_far, self.recent)
        if starts.empty:
            raise InputError("no estimate that an ephemeris may start from")
        others = self.fitting.over(self.watched.plan.other_windows, starts, self.earlier)
        self.estimates = pd.concat([self.estimates, others])
        self.whole = replace(so_far, estimates=below([so_far.estimates, others], "kept_estimates"))
        paths = candidates.of_morning(self.watched, self.whole, starts, now=self.now)
        self.starts = starts
        # An ephemeris from the estimate of an earlier morning is that morning's, and judged once.
        is_new = not self.earlier.issued["i"].isin(starts["track"]).any()
        self.paths = [paths] if is_new else []
        return paths

    def issue(self, paths: Paths) -> None:
        """Judge whether to trust an ephemeris, and choose the model that is selected."""
        plan, burns = self.watched.plan, self.watched.manoeuvres
        past = self.whole.rows_unaffected_by_burns(plan.base, self.watched.known_by(self.now))
        self.verdict = verdicts.verdict(past, self.starts, now=self.now, burns=burns, window=plan.base * HOUR)
        formal = formal_errors(
            self.whole.estimates,
            pd.Series({paths.start: paths.drag_after(DAY)}),
            base=plan.base,
            rso=self.watched.model.fits.rso,
            light=plan.light,
        )
        selected = issued.select(
            past, plan.models, formal.loc[paths.start], self.earlier.formal, now=self.now
        )
        at = issued.epochs(paths.table, plan.step)
        self.ephemeris = paths.ephemeris(selected.model, selected.sizes, at=at)
        self.selected = selected

    @property
    def records(self) -> Records:
        """Records for later mornings."""
        row = issued.row(self.now, self.starts, self.selected, self.verdict.word, burn=self.burn)
        return Records(self.estimates, self.judged, row, self.paths)

    @property
    def figures(self) -> dict[str, Any]:
        """Start of its ephemeris, its orbit, and errors to expect days after the estimate."""
        fits = self.estimates
        base = fits[fits["window_hours"] == self.watched.plan.base]
        counts = {"tracks": len(base), "converged": int(base["converged"].sum()), "late": self.recent.late}
        if self.ephemeris is None:
            return counts | {name: outcomes.NOTHING[name] for name in _OF_EPHEMERIS}
        t, begin = self.ephemeris["t"].to_numpy(), float(self.ephemeris["t_i"].iloc[0])
        leads = np.arange(1.0, np.round((t[-1] - begin) / DAY, 2) + 1e-9)
        variances = [self.ephemeris[f"cov_{axis}_{axis}"] for axis in "xyz"]
        sigmas = np.stack([np.interp(begin + DAY * leads, t, np.sqrt(one)) for one in variances], axis=1)
        orbit = outcomes.orbit(self.ephemeris[STATE].to_numpy()[0])
        return counts | orbit | {"expected": outcomes.expected(leads, sigmas)}

    def write(self, epoch: str, path: Path, name: str) -> None:
        """Write the ephemeris as a message of an object of a name."""
        assert self.ephemeris is not None
        assert self.selected is not None
        segments = oem.segments_of(self.ephemeris, "corrected", replace(self.watched.identity, name=name))
        oem.write(path, segments, epoch=epoch, comment=f"covariances {self.selected.basis}")
