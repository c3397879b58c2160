"""Prediction of an object from its public element sets, with covariances.

    predicted = prediction.predict(["sets.tle"], days=7.0)
    predicted.state("2026-07-18T00:00:00"), predicted.covariance("2026-07-18T00:00:00")
    predicted.to_oem("mine.oem")

It is the orbit inside its sets, under full forces; where they have none, the improved set, by SGP4.
"""

import os
from collections.abc import Callable, Iterable, Iterator, MutableMapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial

import numpy as np
import pandas as pd
from sgp4.api import Satrec

from opml.base.constants import DAY, HOUR
from opml.base.errors import InputError
from opml.base.files import FilePath
from opml.base.progress import Progress
from opml.dynamics.ensemble import Arcs
from opml.dynamics.shared_blocks import SharedBlocks
from opml.element_sets import corrector, improve, improved_sizes, trained_model, weighting
from opml.element_sets.improve import Improved, PublicData
from opml.element_sets.inside import inside_now, orbit_prediction
from opml.element_sets.inside.inside_forces import ON_ALL_CORES, Forces
from opml.element_sets.inside.orbit_prediction import OrbitInside
from opml.element_sets.inside.past_orbits import Calibration
from opml.interop import ccsds
from opml.interop.element_sets import known_sets, mean_elements, rewriting, sgp4_errors
from opml.interop.element_sets.burns_in_sets import burns_among
from opml.interop.element_sets.element_set import LOW, ElementSet, changed, elements_epoch, seconds_since
from opml.interop.object_ids import ObjectId
from opml.interop.predicted_orbit import LEADS, PredictedOrbit, check_days, sampled
from opml.orbits.manoeuvres import Manoeuvre
from opml.orbits.rsw_covariance import ErrorModel

BURNED = 20.0  # days before the date whose burns count: those of the mornings that tell sizes of errors

_SIDE_BY_SIDE = 128  # objects: their arcs fill blocks, and a hundred megabytes
_DAY = len("2016-09-28")


@dataclass(frozen=True, eq=False, repr=False)
class Prediction(PredictedOrbit):
    """An object from the date on when its newest set was known.

    past: as `improve.Improved.past`, of an object whose set nothing improves those of SGP4

    published: the newest set; how: row of the table `improved_sets`, better: the set as it is written; sizes:
    by lead [d] r, s, w, standard deviations of the prediction, and sgp4, that of the published set along the
    track [m]; manoeuvres: those that its sets show [s since the date]; inside: the orbit inside the sets, or
    why SGP4 propagates the improved set.
    """

    published: Satrec
    how: pd.Series
    better: rewriting.Better
    sizes: pd.DataFrame
    manoeuvres: Sequence[Manoeuvre]
    inside: OrbitInside | str

    def expected(self) -> pd.DataFrame:
        """Return the table `expected_errors`: of the prediction in RSW, and of SGP4 along the track [m]."""
        rows = super().expected()
        return rows.assign(sgp4_along_track=self.sizes["sgp4"].reindex(rows["lead"]).to_numpy())

    @property
    def burns(self) -> list[str]:
        """When its sets show that it burned in the last BURNED days, UTC."""
        return burns_before(self.manoeuvres, self.date)

    @property
    def model(self) -> str:
        """The name of what was used: inside, or of an improved set learned, density or sgp4."""
        if isinstance(self.inside, OrbitInside):
            return "inside"
        return "sgp4" if self.how["applied"] == weighting.UNCHANGED else str(self.how["applied"])


def _way(how: pd.Series, inside: OrbitInside | str) -> str:
    """Return the method that was used, in words."""
    of = f" from {how['population']}" if how["population"] else ""
    if isinstance(inside, OrbitInside):
        along = f", along the track corrected as learned{of}" if inside.is_corrected else ""
        return f"orbit inside its sets, propagated under full forces{along}"
    names = {
        weighting.LEARNED: f"set improved by forecast density and a correction learned{of}",
        weighting.DENSITY: "set improved by forecast density",
        weighting.UNCHANGED: "set as published",
    }
    return names[how["applied"]]


def _reasons(how: pd.Series, inside: OrbitInside | str) -> list[str]:
    """Return why that was used, in words."""
    last = f"by the errors of its last {weighting.PAST} mornings"
    weight = f"weight among the options: {100.0 * how['weight']:.0f} %, {last}"
    return [inside.reason if isinstance(inside, OrbitInside) else inside, str(how["why"]) or weight]


def _past_in_words(past: pd.DataFrame, *, is_inside: bool) -> str:
    """Return past errors of SGP4 and of such predictions along the track, at the longest lead."""
    judged = past[past["lead"] > 0]
    if judged.empty:
        return ""
    rows = judged[judged["lead"] == judged["lead"].max()]
    sgp4, own = (rows[name].abs().median() / 1e3 for name in ("error", "left"))
    mornings = f"{improved_sizes.ALONG_MORNINGS} mornings"
    name, since = ("orbit inside", f"{inside_now.PAST:g} days") if is_inside else ("improved set", mornings)
    return (
        f"median error along the track after {rows['lead'].iloc[0]:g} d, in its last {since} "
        f"(n = {len(rows)}): SGP4 {sgp4:.2f} km, {name} {own:.2f} km"
    )


def _cautions(
    how: pd.Series, basis: str, hindsight: str, *, burns: Sequence[str], thrusts: int, is_inside: bool
) -> Iterator[str]:
    """Yield what the date hides, what sigmas rest on where no past does, and why they are wide.

    is_inside: of the orbit inside the sets, whose sigmas are of the sets since the last burn
    """
    wide = "" if is_inside else "wide: "
    if hindsight:
        yield hindsight
    if basis.endswith(improved_sizes.FEW_JUDGED):
        yield basis
    if burns:
        shown = f"its sets show burns, the last of {len(burns)} in {BURNED:g} days on {burns[-1][:_DAY]}"
        yield f"{shown}: later ones alone count" if is_inside else f"{wide}{shown}"
    if thrusts and not is_inside:
        yield f"{wide}{thrusts} of its sets of {BURNED:g} days have a B* below 0, as it thrusts"
    if how["jump"] > corrector.JUMP:
        yield f"{wide}the newest set misses those before it {how['jump']:.0f} times as far as usual"


def _by_sgp4(satellite: Satrec, identity: ObjectId, date: str, t: np.ndarray) -> np.ndarray:
    """Return states (n, 6) of a set at times (n,) [s since the date]; raise InputError where it decays."""
    states = mean_elements.states(satellite, epoch=date, t=t)
    if not np.isfinite(states).all():
        end = t[~np.isfinite(states).all(axis=1)].min()
        most = f"at most --days {np.floor(100.0 * end / DAY) / 100.0:g}" if end > HOUR else "a newer set"
        (utc,) = ccsds.utc_texts(date, end[None])
        raise InputError(f"predict: {identity} decays by SGP4 before {utc}: give {most}")
    return states


def predict(
    sets: FilePath | Sequence[FilePath],
    *,
    days: float = 7.0,
    object: str | int | None = None,
    date: str | None = None,
    weather: FilePath = "OBSERVED",
    catalogue: Iterable[FilePath] = (),
    trained: FilePath | None = None,
    latency: float | None = None,
    progress: Progress = lambda line: None,
) -> Prediction:
    """Predict an object from its public element sets.

    sets: a file or folder, or several, of TLEs or OMMs
    days: how long, 7 at most, as far as errors are known
    object: name, designator or number, where the files have several objects
    date: UTC text; None: when the newest set was known
    weather: OBSERVED, the packaged weather, or a CSSI file
    catalogue: files and folders of other objects' sets, with which the corrector compares
    trained: a model of `opml train`; None: that of the package
    latency: days from epoch to publication of sets that do not say it; None: the usual ones with a date

    Raises InputError for unreadable files, an object that is not there, or decays before the end, days out of
    range and weather that ends too early.
    """
    check_days(days)
    paths = [sets] if isinstance(sets, (str, os.PathLike)) else list(sets)
    history = known_sets.of_object(paths, None if object is None else str(object))
    if latency is None:
        latency = 0.0 if date is None else known_sets.LATENCY
    date = known_since(history[-1]) if date is None else date
    morning = PublicMorning.read(
        [*paths, *catalogue], date=date, weather=weather, trained=trained, latency=latency, progress=progress
    )
    return morning.predict(history, days=days)


@dataclass(frozen=True, eq=False)
class PublicMorning:
    """All sets that were public on a date, improved: what its objects are predicted from.

    weather: OBSERVED, the packaged weather, or a CSSI file; latency: days from epoch to publication of sets
    that do not say when they were made; propagator: as of `Forces`; kept: calibrations of orbits inside sets,
    as `inside_now.find` takes and leaves them: with those of the morning before the next takes a third
    """

    known: PublicData
    better: Improved
    weather: FilePath
    latency: float
    propagator: Callable[..., Arcs] = ON_ALL_CORES
    kept: MutableMapping[str, Calibration] = field(default_factory=dict)

    @classmethod
    def read(
        cls,
        paths: Iterable[FilePath],
        *,
        date: str,
        weather: FilePath,
        trained: FilePath | None = None,
        latency: float = known_sets.LATENCY,
        progress: Progress = lambda line: None,
    ) -> "PublicMorning":
        """Read it from files and folders of sets; raises as `predict` does."""
        known = improve.read(paths, date=date, weather=str(weather), latency=latency)
        return cls(
            known, improve.improve(known, trained_model.read(trained), progress=progress), weather, latency
        )

    def predict_side_by_side(
        self, histories: Sequence[Sequence[ElementSet]], *, days: float = LEADS[-1]
    ) -> Iterator[Prediction | InputError]:
        """Predict objects in a third of the time; yield what `predict` returns, or the error it raises."""
        blocks = SharedBlocks()
        shared = replace(self, propagator=partial(blocks.propagate, threads=os.cpu_count() or 1))

        def attempt(history: Sequence[ElementSet]) -> Prediction | InputError:
            try:
                return shared.predict(history, days=days)
            except InputError as reason:
                return reason

        for first in range(0, len(histories), _SIDE_BY_SIDE):
            part = histories[first : first + _SIDE_BY_SIDE]
            yield from blocks.run([partial(attempt, history) for history in part])

    def predict(self, history: Sequence[ElementSet], *, days: float = LEADS[-1]) -> Prediction:
        """Predict an object.

        history: its sets by epoch, some of them public on the date
        days: how long; after the last of LEADS errors are those of that

        Raises InputError where it decays before the end, for sets of two objects, and for weather that ends
        too early.
        """
        date, newest = self.better.date, history[-1]
        public = known_sets.since(date, history, latency=self.latency, until=0.0)
        if not public:
            raise InputError(f"{known_sets.identity(newest)}: expected a set public on {date}, got none")
        (place,) = np.flatnonzero(self.better.table["number"] == newest.number)
        how = self.better.table.iloc[place]
        if how["why"] == improve.SEVERAL:
            got = "got them a thousand kilometres apart after a day: have two objects its number?"
            raise InputError(f"{newest.path}: expected sets of one orbit of {newest.number}, {got}")
        manoeuvres = burns_among(public, epoch=date)
        thrusts = 0  # sets with a B* below 0, as no drag makes it
        if how["height"] < LOW:
            thrusts = sum(one.t >= -DAY * BURNED and one.satellite.bstar < 0.0 for one in public)
        storm = improved_sizes.after_storm(self.known.weather.kp, how["height"])
        catalogue = self.known.catalogue
        own = catalogue.take(np.flatnonzero(catalogue.table["number"] == newest.number))
        burns = burns_before(manoeuvres, date)
        improved = improved_sizes.of_object(
            own, how, self.better, storm=storm, is_burning=bool(burns or thrusts)
        )
        # The first sets after a burn are made of tracks from both sides of it: those since it is known count.
        begin = max((one.counts_from for one in manoeuvres), default=-np.inf)
        counted = [one for one in public if one.t >= begin] or public[-1:]
        inside = orbit_prediction.predict(
            counted, newest.number, self.better, days=days, forces=lambda: self._forces, kept=self.kept
        )
        published, identity = own.satellites[-1], known_sets.identity(newest)
        is_modelled, errors = how["applied"] != weighting.UNCHANGED, improved
        satellite = changed(published, how["motion"], how["bstar"])
        path: Callable[[np.ndarray], np.ndarray] = partial(_by_sgp4, satellite, identity, date)
        if isinstance(inside, OrbitInside):
            is_modelled, errors, path = inside.is_corrected, inside.errors(improved, storm), inside.path
        way, hindsight = _way(how, inside), self.better.hindsight if is_modelled else ""
        remark = way if isinstance(inside, OrbitInside) else f"{way}, propagated by SGP4"
        is_inside = isinstance(inside, OrbitInside)
        cautions = [
            *_cautions(how, errors.basis, hindsight, burns=burns, thrusts=thrusts, is_inside=is_inside)
        ]
        sizes = _errors(published, date, errors.sizes)
        return Prediction(
            sampled(identity, days, path, sizes, remark="; ".join([remark, *cautions])),
            date,
            days,
            errors.past,
            errors.basis,
            way,
            "; ".join(dict.fromkeys([*_reasons(how, inside), *cautions])),
            published,
            how,
            self.better.sets[place],
            errors.sizes,
            manoeuvres,
            inside,
            past_in_words=_past_in_words(errors.past, is_inside=is_inside),
        )

    @cached_property
    def _forces(self) -> Forces:
        return inside_now.forces_on(self.better.date, str(self.weather), propagator=self.propagator)


def _errors(published: Satrec, date: str, sizes: pd.DataFrame) -> ErrorModel:
    """Return errors from sizes by lead [d since the date], times since it."""
    (epoch,) = seconds_since(date, [published])
    columns = [sizes[axis].to_numpy(float) for axis in sgp4_errors.AXES]

    def sigmas(t: np.ndarray) -> np.ndarray:
        return np.stack([np.interp(t / DAY, sizes.index, column) for column in columns], axis=1)

    return sgp4_errors.error_model(published, epoch, sigmas)


def known_since(one: ElementSet) -> str:
    """Return when a set was known, in whole seconds of UTC: when it was made, else its epoch."""
    latest = np.datetime64(max(one.created, elements_epoch(one.satellite)), "us")
    return str((latest + np.timedelta64(999_999, "us")).astype("M8[s]"))


def burns_before(manoeuvres: Sequence[Manoeuvre], date: str) -> list[str]:
    """Return when the burns of the BURNED days before a date (UTC text) were, UTC; times since it [s]."""
    return ccsds.utc_texts(date, np.array([one.t for one in manoeuvres if one.t >= -DAY * BURNED]))
