"""The mornings of several objects, their arcs side by side; what is wrong with one stops no other."""

import errno
import logging
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import date
from functools import cache, partial
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
import pandas as pd

from opml.base import epochs
from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.base.files import FilePath
from opml.base.provenance import settings_digest
from opml.base.section import JobSettings
from opml.catalog import kinds, measured_files
from opml.catalog.fit.estimation_settings import Estimation
from opml.catalog.measured_files import MeasurementSource, Span
from opml.catalog.predict import weather_spread
from opml.catalog.predict.weather_spread import Weathers
from opml.catalog.propagator import Propagator, near_part
from opml.dynamics import force_model
from opml.dynamics.ensemble import Arcs
from opml.dynamics.kernels.surroundings import ForceModel
from opml.dynamics.settings import ForceModelSettings, Integrator
from opml.dynamics.shared_blocks import SharedBlocks
from opml.element_sets import station_passes
from opml.element_sets.inside import kept_calibrations
from opml.element_sets.inside.past_orbits import Calibration
from opml.interop.element_sets import known_sets
from opml.interop.element_sets.element_set import ElementSet
from opml.learning.models.learners import JobLearner
from opml.mornings import days, set_mornings
from opml.mornings.calendar import Calendar
from opml.mornings.days import UnderWay, WatchedObject
from opml.mornings.kept.store import Store
from opml.mornings.morning import tracked
from opml.mornings.outcomes import FAILED
from opml.mornings.set_mornings import PublicOn, history_of, of_sets
from opml.mornings.watched_object import MorningPlan, ObjectPropagators, Watched
from opml.mornings.weather_of_day import FIGURES
from opml.orbits.sheets import Rso, Station
from opml.tables import SCHEMAS, read_runs, read_table

_FULL = (errno.ENOSPC, errno.EDQUOT)  # errors of a disk that is full: of no object, and the job ends

_SHARED = {"epoch", "force_model", "integrator", "estimation", "models"}
"""Settings that all mornings of a run are made with."""

_log = logging.getLogger(__name__)

Made = TypeVar("Made")


class ObjectSettings(MeasurementSource):
    """An object, and the source of its measurements."""

    rso: Rso
    has_message: bool


class BatchSettings(JobSettings):
    """The mornings of a job up to a date: of which objects, and how they are fitted and predicted."""

    epoch: str
    duration_days: float
    date: date
    hour: float
    days: Path
    batch: str
    force_model: ForceModelSettings
    integrator: Integrator
    stations: list[Station]
    estimation: Estimation
    max_days: float
    step_s: float
    models: dict[str, JobLearner]
    passes: list[str]
    element_files: list[str]  # mean elements of all objects, with which each set is improved
    weather: str  # under which they are improved
    objects: dict[str, ObjectSettings]

    @property
    def shared(self) -> dict[str, Any]:
        """Settings that all mornings of a run are made with."""
        return self.model_dump(include=_SHARED)

    @property
    def calibrations(self) -> Path:
        """The file of what the sets of past weeks told, which the next morning takes up."""
        return self.days / f"calibrations_{self.batch}.npz"

    @property
    def calendar(self) -> Calendar:
        """When mornings are."""
        return Calendar(self.epoch, self.hour)

    @property
    def plan(self) -> MorningPlan:
        """Settings of every morning."""
        return MorningPlan(
            self.models,
            self.estimation,
            self.max_days,
            self.step_s,
            DAY * self.duration_days,
            self.epoch,
            passes=[*map(station_passes.place, self.passes)],
        )


@dataclass(frozen=True)
class Surroundings:
    """Environment of all objects of a job: force models as of `ObjectPropagators`, and the stations.

    The weather was seen until `seen_until` [s]. The models of fits and predictions stand with the parts of
    them for high orbits and for neighbours, made once: arcs under one model are propagated together.
    sets: those of all objects of the run, None without any
    """

    fits: tuple[ForceModel, ForceModel]
    predictions: tuple[ForceModel, ForceModel]
    integrator: Integrator
    weathers: Weathers
    orientation: pd.DataFrame
    stations: Sequence[Station]
    seen_until: float
    sets: PublicOn | None
    read_sets: Callable[[tuple[str, ...]], Mapping[int, Sequence[ElementSet]]]
    propagate: Callable[..., Arcs]

    @classmethod
    def read(
        cls,
        files: Any,
        settings: BatchSettings,
        kept: dict[str, Calibration],
        propagate: Callable[..., Arcs],
        *,
        since: float,
    ) -> "Surroundings":
        """Read them, with the futures issued since a time [s]; raise InputError where a table is damaged."""
        paths = dict(files.items())
        fits, predictions = (
            {name.removeprefix(kind): path for name, path in paths.items() if name.startswith(kind)}
            for kind in ("fits_", "predictions_")
        )
        read = partial(force_model.read, epoch=settings.epoch)
        of_fits, of_predictions = (read(one, settings=settings.force_model) for one in (fits, predictions))
        flattened = read(predictions, settings=weather_spread.FLATTENED)
        futures = _futures(files.futures, since=since) if files.futures else None
        activity = read_table(fits["solar_activity"], "solar_activity")
        return cls(
            (of_fits, near_part(of_fits)),
            (of_predictions, near_part(of_predictions)),
            settings.integrator,
            Weathers.of(flattened, futures),
            read_table(fits["earth_orientation"], "earth_orientation"),
            settings.stations,
            float(activity.dropna(subset=list(FIGURES))["t"].max()),
            _public_sets(settings, kept, since, propagate),
            cache(known_sets.by_object),
            propagate,
        )

    def model(self, rso: Rso) -> ObjectPropagators:
        """Return the propagators of an object."""
        of = partial(Propagator, rso=rso, integrator=self.integrator, propagate_arcs=self.propagate)
        (fits, near), (predictions, near_ahead) = self.fits, self.predictions
        return ObjectPropagators(
            of(fits, near=near),
            of(predictions, near=near_ahead),
            of(self.weathers.model),
            self.weathers,
            self.orientation,
        )


def run(files: Any, settings: BatchSettings, *, metadata: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Run the mornings of objects up to a date; return what became of each on that date.

    files: the job's input, the environment's tables
    metadata: of tables
    """
    # Texts of Arrow take a fifth of a morning: tables of a few rows have more names of columns than texts.
    with pd.option_context("mode.string_storage", "python"):
        blocks, store = SharedBlocks(), Store(settings.days, settings.batch, settings.objects)
        done = store.done(settings.date)
        kept, since = kept_calibrations.read(settings.calibrations), _issued_since(settings, done)
        surroundings = Surroundings.read(files, settings, kept, blocks.propagate, since=since)
        failed: dict[str, dict[str, Any]] = {}
        together = partial(_together, blocks=blocks, day=settings.date, failed=failed)
        begun = together(
            {
                name: partial(_begin, name, one, surroundings, settings, store, done[name])
                for name, one in settings.objects.items()
                if settings.date not in done[name]
            }
        )
        shared = settings_digest(settings.shared)
        days.catch_up(
            store,
            list(begun.values()),
            settings.date,
            together=together,
            metadata={**metadata, "settings": shared},
        )
        kept_calibrations.write(settings.calibrations, kept)
        places = store.places(settings.date)
        return [failed.get(name) or places[name].outcomes[name] for name in settings.objects]


def _together(
    calls: Mapping[str, Callable[[], Made]],
    *,
    blocks: SharedBlocks,
    day: date,
    failed: dict[str, dict[str, Any]],
) -> dict[str, Made]:
    """Return what calls for objects return, side by side; what is wrong with one object stops no other.

    failed: takes what became of those whose call failed
    """

    def attempt(name: str, call: Callable[[], Made]) -> Made | None:
        try:
            return call()
        except InputError as error:
            _log.warning("%s: %s", name, error)
            reason = str(error)
        except Exception as error:
            if isinstance(error, OSError) and error.errno in _FULL:
                raise
            _log.exception("%s: failed", name)
            reason = f"{type(error).__name__}: see the log of the job"
        failed[name] = days.failed(name, day, FAILED, reason)
        return None

    results = blocks.run([partial(attempt, *call) for call in calls.items()])
    return {name: result for name, result in zip(calls, results, strict=True) if result is not None}


def _public_sets(
    settings: BatchSettings, kept: dict[str, Calibration], since: float, propagate: Callable[..., Arcs]
) -> PublicOn | None:
    """Return the public sets of a run, None without any; since: a time before all mornings to be run [s]."""
    if not settings.element_files:
        return None
    first = epochs.mjd(settings.epoch) + (since / DAY if np.isfinite(since) else 0.0)
    files, weather = settings.element_files, settings.weather
    return set_mornings.read(files, weather, since=first, propagator=propagate, kept=kept)


def _futures(path: FilePath, *, since: float) -> pd.DataFrame:
    """Return the table `futures` of the issues after a time [s]: of a year, all would be a gigabyte."""
    runs = read_runs(path, "futures", "issued")
    kept = [rows for rows in runs if rows["issued"].iloc[0] > since]
    return pd.concat(kept or [SCHEMAS["futures"].empty()], ignore_index=True)


def _issued_since(settings: BatchSettings, done: Mapping[str, Sequence[date]]) -> float:
    """Return the time after which the weather of the mornings to be run is issued [s]."""
    begins = [settings.calendar.time(before[-1]) if before else -np.inf for before in done.values()]
    # An ephemeris starts less than its length before the morning, and from an issue of at most a day before.
    return min(begins) - DAY * (settings.max_days + 1.0)


def _begin(
    name: str,
    one: ObjectSettings,
    surroundings: Surroundings,
    settings: BatchSettings,
    store: Store,
    done: Sequence[date],
) -> UnderWay:
    """Return an object before the first of its mornings that are not over."""
    plan = replace(settings.plan, has_message=one.has_message)
    begin = _of_sets if one.kind == kinds.ELEMENTS.name else _tracked
    watched = begin(one, surroundings, plan, since=days.since(done, settings.calendar, plan))
    known = max(surroundings.seen_until, watched.last_known)
    days.check_reached(settings.calendar, settings.date, known)
    digest = settings_digest(settings.shared | one.model_dump(include={"rso", "options"}))
    shared = name, watched, settings.calendar, store, digest
    return UnderWay.begin(*shared, done=done, until=settings.date)


def _of_sets(
    one: ObjectSettings, surroundings: Surroundings, plan: MorningPlan, *, since: float
) -> WatchedObject:
    """Return an object of public sets; all of them count, whenever its mornings begin."""
    assert surroundings.sets is not None
    histories = surroundings.read_sets(tuple(one.files))
    history = history_of(histories, one.options.get("number"), one.files[0])
    return of_sets(plan, surroundings.sets, history)


def _tracked(
    one: ObjectSettings, surroundings: Surroundings, plan: MorningPlan, *, since: float
) -> WatchedObject:
    """Return an object of tracks or fixes; since: earlier tracks are left out [s]."""
    span, stations = Span(plan.epoch, plan.end), surroundings.stations
    measured = measured_files.read(one, span, stations, surroundings.orientation, since=since)
    model = surroundings.model(one.rso)
    given = measured_files.given_state(one, span, one.rso, measured.tracking, model.predictions.model.gm)
    return tracked(
        Watched(model, plan, measured.tracking, stations, measured.manoeuvres, given, measured.identity)
    )
