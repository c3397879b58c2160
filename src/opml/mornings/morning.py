"""One morning of one object: new tracks are fitted, earlier ephemerides judged, the best model flown.

Nothing that was measured, published or made after the morning touches it. What an earlier morning left is
never made again.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np
import pandas as pd

from opml.base.constants import DAY, HOUR
from opml.base.errors import InputError
from opml.catalog.fit import fixes
from opml.catalog.fit.estimation_settings import Estimation
from opml.catalog.fit.first.first_orbit import TimedState
from opml.catalog.flight import Flight
from opml.catalog.predict import spread
from opml.catalog.predict.prediction import predict_pairs
from opml.catalog.predict.spread import Weathers
from opml.ephemerides import corrected
from opml.ephemerides.known import Known
from opml.ephemerides.part import Grid, Part
from opml.interop.object_ids import UNKNOWN, ObjectId
from opml.learning.data import dataset
from opml.learning.data.cleaning import Cleaning
from opml.learning.models import learners
from opml.learning.models.contract import ResolvedSettings
from opml.mornings import beside_sgp4, candidates, fits, issued, judged
from opml.mornings.beside_sgp4 import Sgp4
from opml.mornings.fits import Recent
from opml.mornings.issued import Flown
from opml.mornings.judged import Verdict, verdict
from opml.mornings.outcomes import DO_NOT_USE, UNPROVEN
from opml.mornings.records import Paths, Records
from opml.orbits.manoeuvres import Manoeuvre
from opml.orbits.sheets import Station
from opml.tables import SCHEMAS, STATE

_LOOKED_AT = 4  # newest estimates among which one is found to start from

_MARGIN = DAY
"""Tracks so long before the longest window are read [s]: an estimate of a morning is up to a day old."""


_NOT_FLOWN = Verdict(UNPROVEN, "nothing was issued yet")


@dataclass(frozen=True)
class FlightModel:
    """How an object flies."""

    fits: Flight  # under what was measured of the weather by the time of each fit
    predictions: Flight  # under what was known of it by t_i
    flattened: Flight  # the same under the Earth's flattening alone, for the spread
    weathers: Weathers  # expected, and as they may come
    orientation: pd.DataFrame  # table `earth_orientation`


@dataclass(frozen=True)
class MorningPlan:
    """What is asked of every morning of an object."""

    models: Mapping[str, ResolvedSettings]  # resolved settings of learners that learn nothing, by name
    estimation: Estimation  # of the fits over the base window
    max_days: float  # length of an ephemeris
    step: float  # between its epochs [s]
    end: float  # of the run [s]
    epoch: str  # UTC text
    fits_above: float = 0.0  # height of mean elements below which none of these models is flown [m]

    @property
    def base(self) -> float:
        """The window [h] of the fits that ephemerides start from, and are compared with."""
        return self.estimation.window_hours

    @property
    def other_windows(self) -> list[float]:
        """Windows [h] of fits that models ask for beside these."""
        return [hours for hours in learners.arc_windows(self.models.values()) if hours != self.base]

    @property
    def reach(self) -> float:
        """How far back from a morning tracks are read [s]."""
        return max([self.base, *self.other_windows]) * HOUR + _MARGIN


@dataclass(frozen=True)
class Watched:
    """An object that is watched."""

    model: FlightModel
    plan: MorningPlan
    tracking: pd.DataFrame  # all that was measured, the table or one in its place
    stations: Sequence[Station]  # of the tracks
    manoeuvres: Sequence[Manoeuvre] = ()  # each counts from when it is known
    given: TimedState | None = None  # a state that the very first fits may start from
    identity: ObjectId = UNKNOWN  # what else than its name in the run tells the object
    sgp4: Sgp4 | None = None  # what anybody would have flown, where mean elements were taken

    def on(self, now: float) -> "Watched":
        """Return it with the models of a morning [s]: low down, fits lose against SGP4 and none is flown."""
        if self.sgp4 is None or self.sgp4.is_above(self.plan.fits_above, now=now):
            return self
        return replace(self, plan=replace(self.plan, models={}))

    def known_by(self, now: float) -> list[Manoeuvre]:
        """Return the manoeuvres that are known by a time [s]."""
        return [one for one in self.manoeuvres if one.counts_from <= now]


@dataclass(frozen=True)
class Left:
    """What a morning left."""

    records: Records  # of this morning alone
    recent: Recent  # the tracks of the last days that were over
    verdict: Verdict
    ephemeris: pd.DataFrame | None = None  # table `corrected`; None where none left
    basis: str = ""  # what its covariances rest on, in words


def morning(watched: Watched, records: Records, *, now: float) -> Left:
    """Return what a morning leaves.

    records: of earlier mornings
    now: when it is [s]

    What cannot be made of what was measured is told by the verdict: a morning that raised an error for it
    would be tried again for ever.
    """
    watched = watched.on(now)
    plan = watched.plan
    recent = fits.recent_tracks(
        watched.tracking, records.estimates_over(plan.base), now=now, reach=plan.reach
    )
    one = _Morning(_aware_of(watched, records.burns), records, recent, now)
    try:
        one.fit()
        one.issue(one.fly())
    except InputError as reason:
        one.verdict = one.verdict.or_not_for(str(reason))
    return one.outcome


@dataclass
class _Morning:
    """A morning as far as it came: each step adds what it made, or raises InputError where it makes nothing.

    estimates, judged, paths: of this morning
    starts: the estimate that ephemerides start from, a table of one row
    """

    watched: Watched  # with the burns that are known by now
    earlier: Records  # records of the mornings before
    recent: Recent
    now: float
    fitting: fits.Fitting = field(init=False)
    estimates: pd.DataFrame = field(default_factory=SCHEMAS["kept_estimates"].empty)
    judged: pd.DataFrame = field(default_factory=SCHEMAS["judged"].empty)
    burn: Manoeuvre | None = None  # that the estimates showed, with which they were made again
    starts: pd.DataFrame = field(default_factory=issued.no_start)
    paths: list[Paths] = field(default_factory=list)
    flown: Flown | None = None
    ephemeris: pd.DataFrame | None = None
    verdict: Verdict = _NOT_FLOWN

    def fit(self) -> None:
        """Estimate the tracks that are new; again behind a burn, where the estimates show one."""
        if not self.recent.tracks:
            raise InputError("no tracks of the last days")
        kept = self.earlier.estimates_over(self.watched.plan.base)
        self.fitting = _fitting(self.watched, self.recent)
        estimates = self.fitting.further(kept)
        self.judged = _judged(self.watched, estimates, self.recent, self.earlier)
        if "station" in self.watched.tracking and fits.are_far(self.judged):
            last = max((one.t for one in self.earlier.burns), default=-np.inf)
            self.burn = fits.newest_burn(self.fitting, kept, since=last)
        if self.burn:
            self.watched = _aware_of(self.watched, [self.burn])
            self.fitting = _fitting(self.watched, self.recent)
            estimates = self.fitting.further(kept)
        self.estimates = estimates

    def fly(self) -> Paths:
        """Return the ephemerides of all models from the newest estimate that they may start from."""
        known = _known(self.watched, self._so_far, self.recent, now=self.now)
        starts = known.estimates[known.may_depart()].tail(1)
        if starts.empty:
            raise InputError("no estimate that an ephemeris may start from")
        others = _others(self.fitting, self.watched.plan, self.earlier, starts)
        self.estimates = pd.concat([self.estimates, others])
        paths = Paths(_paths(self.watched, known, self._so_far, starts, now=self.now))
        self.starts = starts
        # An ephemeris from the estimate of an earlier morning is that morning's, and judged once.
        is_new = not self.earlier.issued["i"].isin(starts["track"]).any()
        self.paths = [paths] if is_new else []
        return paths

    def issue(self, paths: Paths) -> None:
        """Judge whether to trust an ephemeris, and choose the model that is flown."""
        plan, burns = self.watched.plan, self.watched.manoeuvres
        past = self._so_far.rows_unaffected_by_burns(plan.base, self.watched.known_by(self.now))
        judgement = verdict(past, self.starts, now=self.now, burns=burns, window=plan.base * HOUR)
        self.verdict = beside_sgp4.beside(judgement, past, now=self.now)
        flown = issued.choose_model(past, paths.models, now=self.now)
        self.ephemeris = issued.ephemeris(paths.table, flown, step=plan.step)
        self.flown = flown

    @property
    def outcome(self) -> Left:
        """What the morning leaves."""
        row = issued.row(self.now, self.starts, self.flown, self.verdict.word, burn=self.burn)
        basis = corrected.basis(self.flown.replay, self.now) if self.flown else ""
        records = Records(self.estimates, self.judged, row, self.paths)
        return Left(records, self.recent, self.verdict, self.ephemeris, basis)

    @property
    def _so_far(self) -> Records:
        """All records with what this morning fitted and judged; it has issued nothing yet."""
        row = issued.row(self.now, issued.no_start(), None, DO_NOT_USE, burn=self.burn)
        return self.earlier.and_then(Records(self.estimates, self.judged, row), since=self.now)


def _aware_of(watched: Watched, found: Sequence[Manoeuvre]) -> Watched:
    """Return what is watched, with burns that its tracks showed."""
    return replace(watched, manoeuvres=sorted([*watched.manoeuvres, *found], key=lambda one: one.t))


def _fitting(watched: Watched, recent: Recent) -> fits.Fitting:
    measured = fixes.measurements(
        recent.tracking, watched.model.orientation, watched.stations, watched.manoeuvres
    )
    return fits.Fitting(watched.model.fits, measured, recent, watched.plan.estimation, watched.given)


def _others(fitting: fits.Fitting, plan: MorningPlan, records: Records, starts: pd.DataFrame) -> pd.DataFrame:
    """Return the fits over other windows of the track that ephemerides start from, where none are kept."""
    kept = {hours: records.estimates_over(hours) for hours in plan.other_windows}
    lacking = {hours: rows for hours, rows in kept.items() if not rows["track"].isin(starts["track"]).any()}
    return fitting.over(starts, lacking) if lacking else SCHEMAS["kept_estimates"].empty()


def _paths(
    watched: Watched, known: Known, so_far: Records, starts: pd.DataFrame, *, now: float
) -> pd.DataFrame:
    """Return the ephemerides of all models; so_far: the records with those of the morning."""
    plan, model = watched.plan, watched.model
    asked, burns = learners.arc_windows(plan.models.values()), watched.known_by(now)
    whole = replace(known, others={hours: so_far.of_window(hours, burns) for hours in asked})
    part = Part(model.predictions, whole, starts, Grid(candidates.STEP, plan.max_days, plan.end))
    base = so_far.of_window(plan.base, burns)
    spreads = partial(spread.build, model.flattened, base, weathers=model.weathers)
    others = {} if watched.sgp4 is None else watched.sgp4.menu(now)
    return candidates.paths(part, plan.models, spreads, now=now, others=others)


def _judged(watched: Watched, made: pd.DataFrame, recent: Recent, records: Records) -> pd.DataFrame:
    """Return how far ephemerides of earlier mornings were off the new estimates."""
    plan = watched.plan
    off = judged.judge(
        records.paths,
        judged.later_states(made, recent),
        manoeuvres=watched.manoeuvres,
        window=plan.base * HOUR,
    )
    return issued.with_sigmas(off, records.issued)


def _known(watched: Watched, records: Records, recent: Recent, *, now: float) -> Known:
    """Return what is known of the object, of which its newest estimates may start ephemerides."""
    plan, flight = watched.plan, watched.model.predictions
    estimates = records.of_window(plan.base, watched.known_by(now))
    # Of an object that is seldom seen the newest estimates may be older than all that is read of its tracks.
    rows = estimates[estimates["track"].isin(recent.numbers)].tail(_LOOKED_AT + 1)
    tracking = recent.tracking.assign(track=recent.numbers[recent.tracking["track"]])
    made = partial(dataset.of_estimates, tracking=tracking, gm=flight.model.gm, cleaning=Cleaning())
    nothing = pd.DataFrame(columns=["i", "j", *STATE, "reason"])
    known = Known(
        rows,
        made(rows, nothing),
        plan.base,
        flight.model.gm,
        manoeuvres=watched.manoeuvres,
        epoch=plan.epoch,
    )
    pairs = _from_previous(known, longest=DAY * plan.max_days)
    # Where the newest may start one, nobody asks for the others.
    for flown in (pairs.tail(1), pairs) if len(pairs) else ():
        known = replace(known, at_estimates=made(rows, predict_pairs(flight, rows, flown)))
        if known.may_depart().any():
            break
    return known


def _from_previous(known: Known, *, longest: float) -> pd.DataFrame:
    """Return the pairs of an estimate before and one that may start an ephemeris, if the first reaches it.

    longest: arc [s]
    """
    table = known.at_estimates.assign(t_i=known.at_estimates["t_b"], t_j=known.estimates["t"].to_numpy())
    near = (table["b"] != dataset.NO_PREVIOUS) & (table["t_j"] - table["t_i"] <= longest)
    usable = table["converged"] & table["cd_inside"] & near
    return table[usable].rename_axis("j").reset_index().rename(columns={"b": "i"})[["i", "j", "t_i", "t_j"]]
