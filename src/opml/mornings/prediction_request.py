"""A prediction that is asked for: files of an object, the times that count, its propagators on these."""

import os
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
import pandas as pd

from opml.base import epochs
from opml.base.constants import DAY, HOUR
from opml.base.errors import InputError
from opml.base.files import FilePath
from opml.base.section import JobSettings
from opml.catalog import measured_files
from opml.catalog.fit.estimation_settings import Estimation
from opml.catalog.measured_files import MeasurementSource, Span
from opml.catalog.predict import weather_spread
from opml.catalog.predict.weather_spread import Weathers
from opml.catalog.propagator import Propagator
from opml.dynamics.forces import build, measured, with_outlooks
from opml.dynamics.settings import ForceModelSettings, Integrator
from opml.environment import known_weather
from opml.environment.known_weather import Issues
from opml.environment.settings import EnvironmentSettings
from opml.ephemerides.fit_sizes import GIVEN, GUESSED
from opml.interop import ccsds, formats, points_from_files, tdm
from opml.interop.object_ids import ObjectId
from opml.interop.orbit_from_files import OrbitFiles
from opml.interop.predicted_orbit import LEADS, STEP, check_days
from opml.learning.models import learners
from opml.learning.models.learners import JobLearner
from opml.mornings.verdicts import OLDEST
from opml.mornings.watched_object import MorningPlan, ObjectPropagators, Watched
from opml.orbits.sheets import Rso, Station

MORNINGS = 7  # mornings before the date that are run again
STRETCH = 6.0  # length of a stretch of points [h], whose estimate is at its first
SIGMA = 10.0  # standard deviation of positions whose file tells none [m]
GUESS = 0.01  # area to mass of a body that nobody knows [m2/kg]
AFTER = HOUR  # that paths reach beyond the end
_EVERY = 120.0  # between points [s]: each is an end of a step
_ANY = "2000-01-01T12:00:00"
_SECONDS, _DAY = len("2016-09-28T12:09:45"), len("2016-09-28")
_HISTORY = 5.0  # of measurements that the first morning fits [days]
_LEAST_STRETCHES = 4.0
_FEWEST_TRACKS = 3  # in a fit: of fewer its state is hardly known
_MOST_WITH_FEWER = 0.1  # part of the fits that may have fewer
_NO_ELEMENTS = dict.fromkeys(("a", "e", "i", "argp", "raan", "mean_anomaly"), np.nan)


@dataclass(frozen=True)
class Request:
    """Prediction that is asked for."""

    files: Sequence[FilePath]  # of one object, points (OEM, SP3, CPF, CSV) or tracks (TDM)
    days: float = LEADS[-1]  # how long
    object: str | None = None  # name or number, where the files have several objects
    date: str | None = None  # UTC text; None: when the last was measured
    weather: FilePath = "OBSERVED"  # OBSERVED, the packaged weather, or a CSSI file
    stations: Sequence[Station] = ()  # by which tracks were measured
    area_to_mass: float | None = None  # [m2/kg]; None: GUESS

    def __post_init__(self) -> None:
        """Raise InputError for a length out of range and an area that no body has."""
        check_days(self.days)
        if self.area_to_mass is not None and not 0.0 < self.area_to_mass < np.inf:
            raise InputError(f"predict: expected an area to mass above 0 m2/kg, got {self.area_to_mass:g}")

    @property
    def kind(self) -> str:
        """Tracks or fixes."""
        kind = formats.kind_of(self.files[0], formats.ORBIT, formats.TRACKS)
        return "tracks" if kind == formats.TRACKS else "fixes"


@dataclass(frozen=True)
class Times:
    """When a prediction is made: times since `epoch`, midnight before all that counts [s].

    first, date: first measurement that counts, and the date; duration: up to the prediction's end
    """

    epoch: str
    first: float
    date: float
    duration: float

    @classmethod
    def of(cls, request: Request) -> "Times":
        """Return the times of a request; raise InputError where nothing was measured before its date."""
        first, last = _span(request)
        if request.date is not None:
            last = min(last, epochs.seconds_between(_ANY, request.date))
        if not first < last:
            before = f" before {request.date}" if request.date else ""
            raise InputError(f"{request.files[0]}: expected measurements{before}, got fewer than two")
        date = _text(_ANY, np.ceil(last)) if request.date is None else request.date
        begin = max(first, last - DAY * (MORNINGS + _HISTORY))
        epoch = f"{_text(_ANY, begin)[:_DAY]}T00:00:00"
        offset = epochs.seconds_between(epoch, _ANY)
        now = epochs.seconds_between(epoch, date)
        return cls(epoch, begin + offset, now, now + DAY * request.days + AFTER)

    @property
    def utc(self) -> str:
        """The date, UTC."""
        return _text(self.epoch, self.date)

    @property
    def stretch(self) -> float:
        """Length of a stretch of points [h]."""
        return min(STRETCH, (self.date - self.first) / HOUR / _LEAST_STRETCHES)

    @property
    def mornings(self) -> np.ndarray:
        """Mornings (n,) that are run, the last at the date [s]."""
        back = min(MORNINGS, int((self.date - self.first - HOUR * self.stretch) / DAY))
        return self.date - DAY * np.arange(back, -1, -1)


class OrbitSettings(JobSettings):
    """Settings of fits and predictions, whenever objects were measured."""

    force_model: ForceModelSettings
    integrator: Integrator
    estimation: Estimation
    environment: EnvironmentSettings
    futures: int
    models: dict[str, JobLearner]


def _text(epoch: str, t: float) -> str:
    """Return a time [s since an epoch] as UTC text, in whole seconds."""
    return ccsds.utc_texts(epoch, np.array([t]))[0][:_SECONDS]


def _span(request: Request) -> tuple[float, float]:
    """Return when the first and the last was measured [s since _ANY]."""
    if request.kind == "tracks":
        measured = tdm.measurements(request.files, epoch=_ANY, wanted=request.object)
        return float(measured["t"].min()), float(measured["t"].max())
    return points_from_files.reach(OrbitFiles(request.files, _ANY, np.inf, request.object))


def watch(request: Request, settings: OrbitSettings, times: Times) -> Watched:
    """Return what is measured of the object, and its propagators."""
    max_days = request.days + (OLDEST + AFTER) / DAY
    rso = Rso("object", **_NO_ELEMENTS, area_to_mass=request.area_to_mass or GUESS, cd=2.2, cr=1.25)
    model = _object_propagators(rso, request.weather, settings, times, max_days)
    sampling = {"sigma_m": (SIGMA,) * 3, "every_s": _EVERY, "stretch_hours": times.stretch}
    files = list(map(str, request.files))
    source = MeasurementSource(kind=request.kind, files=files, options=sampling, satellite=request.object)
    span = Span(times.epoch, times.date)
    measured = measured_files.read(source, span, request.stations, model.orientation, since=0.0)
    estimation = settings.estimation
    if request.kind == "tracks":
        windows = sorted({estimation.window_hours, *learners.arc_windows(settings.models.values())})
        estimation = estimation.evolve(window_hours=_window(measured.tracking, windows))
    plan = MorningPlan(
        settings.models,
        estimation,
        max_days,
        STEP,
        times.duration,
        times.epoch,
        light=GUESSED if request.area_to_mass is None else GIVEN,
    )
    identity = measured.identity if measured.identity.name else ObjectId(Path(request.files[0]).stem)
    return Watched(model, plan, measured.tracking, request.stations, measured.manoeuvres, None, identity)


def _window(tracking: pd.DataFrame, windows: Sequence[float]) -> float:
    """Return the shortest of windows [h], ascending, in which nearly all fits have tracks enough."""
    begins = np.sort(tracking.groupby("track")["t"].min().to_numpy())
    for hours in windows:
        first = np.searchsorted(begins, begins - HOUR * hours)
        fewer = (np.arange(len(begins)) - first + 1 < _FEWEST_TRACKS)[first > 0]
        if fewer.sum() <= _MOST_WITH_FEWER * len(fewer):
            return hours
    return windows[-1]


def _object_propagators(
    rso: Rso, weather: FilePath, settings: OrbitSettings, times: Times, max_days: float
) -> ObjectPropagators:
    """Return the propagators of an object under the weather that was known at each time."""
    weather, sources = str(weather), settings.environment
    hours = sources.issue_hours or known_weather.FIT_HOURS
    known_weather.known_on(times.utc, known_weather.read(weather), weather, oldest=OLDEST / DAY)
    gravity, degree = sources.gravity_field, settings.force_model.degree
    environment = measured(weather, times.epoch, times.duration, gravity=gravity, degree=degree)
    t = environment.solar_activity["t"].to_numpy()
    issues = Issues(source=weather, epoch=times.epoch, issue_hours=hours, max_days=max_days)
    expected = known_weather.outlooks(issues, t)
    futures = known_weather.tabulate_futures(issues, t, members=settings.futures)
    three_hourly = issues.model_copy(update={"issue_hours": known_weather.FIT_HOURS, "max_days": _HISTORY})
    still, flattened = (build(environment, one) for one in (settings.force_model, weather_spread.FLATTENED))
    fitting = with_outlooks(still, known_weather.outlooks(three_hourly, t))
    full, flat = (with_outlooks(model, expected) for model in (still, flattened))
    propagator = partial(Propagator, rso=rso, integrator=settings.integrator, threads=os.cpu_count() or 1)
    return ObjectPropagators(
        propagator(fitting),
        propagator(full),
        propagator(flat),
        Weathers.of(flat, futures),
        environment.earth_orientation,
    )
