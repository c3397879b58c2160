"""Prediction of an object from its points or tracks, with covariances: its mornings run again.

The mornings up to a date fit what was measured by then, under the forces and the weather that were known, and
judge what they issued. The last one's ephemeris is the prediction.
"""

import logging
import os
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np
import pandas as pd

from opml.base import epochs
from opml.base.constants import DAY, HOUR, WGS84_A
from opml.base.errors import InputError
from opml.base.files import FilePath
from opml.base.progress import Progress, with_time_left
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
from opml.ephemerides.along_track_shift import through
from opml.ephemerides.fit_sizes import GIVEN, GUESSED
from opml.interop import ccsds, formats, points_from_files, tdm
from opml.interop.object_ids import ObjectId
from opml.interop.orbit_from_files import OrbitFiles
from opml.interop.predicted_orbit import STEP, PredictedOrbit, check_days, sampled
from opml.learning.models import learners
from opml.learning.models.contract import ResolvedSettings
from opml.learning.models.learners import JobLearner, arc_of
from opml.mornings import issued
from opml.mornings.morning import TrackMorning, morning
from opml.mornings.records import Records
from opml.mornings.verdicts import OLDEST
from opml.mornings.watched_object import MorningPlan, ObjectPropagators, Watched
from opml.orbits.sheets import Rso, Station
from opml.tables import STATE, STATE_COVARIANCES, state_rows, symmetric_matrices

MORNINGS = 7  # mornings before the date that are run again
STRETCH = 6.0  # length of a stretch of points [h], whose estimate is at its first
SIGMA = 10.0  # standard deviation of positions whose file tells none [m]
GUESS = 0.01  # area to mass of a body that nobody knows [m2/kg]
_TRIED = (0.0005, 0.005, 0.01)  # areas to mass of fits that show how light presses [m2/kg]
_PRIOR = 1e-3  # what an area to mass twice GUESS counts as, in mean squares of weighted residuals
_BODIES = (1e-4, 0.1)  # areas to mass of satellites [m2/kg]
LIT = 1000e3  # height above which light presses more than drag does [m]
LONGEST = 7.0  # days that a prediction reaches at most
_EVERY = 120.0  # between points [s]: each is an end of a step
_ANY = "2000-01-01T12:00:00"
_SECONDS, _DAY = len("2016-09-28T12:09:45"), len("2016-09-28")
_HISTORY = 5.0  # of measurements that the first morning fits [days]
_AFTER = HOUR  # that paths reach beyond the end
_LEAST_STRETCHES = 4.0
_NO_ORBIT = 50.0  # root mean square of the weighted residuals of what no orbit fits: 78 with z mirrored
_ROUGH_FIT = 10.0  # the same of what forces hardly explain: 30 with a sign wrong, 20 across a burn
_FEWEST_TRACKS = 3  # in a fit: of fewer its state is hardly known
_MOST_WITH_FEWER = 0.1  # part of the fits that may have fewer
_NO_ELEMENTS = dict.fromkeys(("a", "e", "i", "argp", "raan", "mean_anomaly"), np.nan)


_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Request:
    """Prediction that is asked for."""

    files: Sequence[FilePath]  # of one object, points (OEM, SP3, CPF, CSV) or tracks (TDM)
    days: float = LONGEST  # how long
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
class _Times:
    """When a prediction is made: times since `epoch`, midnight before all that counts [s].

    first, date: first measurement that counts, and the date; duration: up to the prediction's end
    """

    epoch: str
    first: float
    date: float
    duration: float

    @classmethod
    def of(cls, request: Request) -> "_Times":
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
        return cls(epoch, begin + offset, now, now + DAY * request.days + _AFTER)

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


def predict(request: Request, settings: OrbitSettings, *, progress: Progress) -> PredictedOrbit:
    """Predict an object from what measured it.

    Raises InputError for unreadable files, a date without measurements before it, weather that ends too
    early, and measurements that no orbit fits.
    """
    times = _Times.of(request)
    progress(f"weather and forces from {times.epoch[:_DAY]} on")
    watched = _watched(request, settings, times)
    # What is too old to be propagated from the date on is propagated no farther than it can be judged.
    judged_alone = replace(watched, plan=replace(watched.plan, end=times.date + _AFTER))
    records, newest = Records.empty(), None
    for now in with_time_left(times.mornings.tolist(), "morning", progress):
        left = morning(judged_alone if now < times.date - OLDEST else watched, records, now=now)
        records = records.and_then(left.records, since=now - DAY * watched.plan.max_days)
        newest = newest if left.ephemeris is None else left
    if not records.paths:
        asked = "are frame, axes and units right, points more than a few, the body's area to mass possible?"
        why = left.verdict.reason if request.kind == "tracks" else asked
        raise InputError(f"{request.files[0]}: expected what an orbit fits, got none: {why}")
    estimates = records.estimates[records.estimates["track"] == records.paths[-1].start]
    if (rms := estimates["weighted_rms"].max()) > _NO_ORBIT:
        asked = "are object, frame and times right, or did it burn in the last days before --date?"
        got = f"got some {rms:.0f} standard deviations off the best: {asked}"
        raise InputError(f"{request.files[0]}: expected measurements of an orbit, {got}")
    if rms > _ROUGH_FIT:
        asked = "are sigmas, frame, axes and times right, or did it burn?"
        _log.warning("%s: measurements are off their fit by %.0f sigma: %s", request.files[0], rms, asked)
    height = float(np.linalg.norm(estimates[STATE[:3]].iloc[0])) - WGS84_A
    if request.area_to_mass is None and height > LIT:
        progress("area to mass, by how light presses")
        area = _area_by_light(request, settings, times)
        if area is not None:
            _log.warning("%s: area to mass of %.2g m2/kg, by how light presses", request.files[0], area)
            return predict(replace(request, area_to_mass=area), settings, progress=progress)
        guess = "area to mass is a guess, %g m2/kg: light presses by it, more than drag: give --area-to-mass"
        _log.warning(f"%s: {guess}", request.files[0], GUESS)
    expected = f"{request.files[0]}: expected an orbit for {request.days:g} days, got"
    if newest is None:
        raise InputError(f"{expected} none: {left.verdict.reason}")
    assert newest.ephemeris is not None
    if (end := float(newest.ephemeris["t"].iloc[-1]) - times.date) < DAY * request.days:
        ends = f"after {end / DAY:.1f}" if end > 0.0 else "as little was measured before the date"
        raise InputError(f"{expected} one that comes down, or is hardly determined, {ends}")
    return _fitted_orbit(request, times, newest)


def _area_by_light(request: Request, settings: OrbitSettings, times: _Times) -> float | None:
    """Return the area to mass [m2/kg] whose fit leaves least, near GUESS; None where fits hardly tell it.

    The mean square of what the newest, longest fit leaves is a parabola of the pressure of light.
    """
    squares = []
    for area in _TRIED:
        watched = _watched(replace(request, area_to_mass=area), settings, times)
        fitted = morning(watched, Records.empty(), now=times.date).records.estimates
        newest = fitted[(fitted["track"] == fitted["track"].max()) & fitted["converged"].astype(bool)]
        if newest.empty:
            return None
        squares.append(float(newest.sort_values("window_hours")["weighted_rms"].iloc[-1]) ** 2)
    curve = np.polynomial.Polynomial.fit(_TRIED, squares, 2).convert().coef
    prior = _PRIOR / GUESS**2
    if curve[2] < prior:
        return None
    return float(np.clip((prior * GUESS - 0.5 * curve[1]) / (prior + curve[2]), *_BODIES))


def _text(epoch: str, t: float) -> str:
    """Return a time [s since an epoch] as UTC text, in whole seconds."""
    return ccsds.utc_texts(epoch, np.array([t]))[0][:_SECONDS]


def _span(request: Request) -> tuple[float, float]:
    """Return when the first and the last was measured [s since _ANY]."""
    if request.kind == "tracks":
        measured = tdm.measurements(request.files, epoch=_ANY, wanted=request.object)
        return float(measured["t"].min()), float(measured["t"].max())
    return points_from_files.reach(OrbitFiles(request.files, _ANY, np.inf, request.object))


def _watched(request: Request, settings: OrbitSettings, times: _Times) -> Watched:
    """Return what is measured of the object, and its propagators."""
    max_days = request.days + (OLDEST + _AFTER) / DAY
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
    rso: Rso, weather: FilePath, settings: OrbitSettings, times: _Times, max_days: float
) -> ObjectPropagators:
    """Return the propagators of an object under the weather that was known at each time."""
    weather, sources = str(weather), settings.environment
    hours = sources.issue_hours or known_weather.FIT_HOURS
    known_weather.known_on(weather, times.utc, oldest=OLDEST / DAY)
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


def _fitted_orbit(request: Request, times: _Times, newest: TrackMorning) -> PredictedOrbit:
    """Return what the newest morning issued that could."""
    assert newest.ephemeris is not None
    assert newest.selected is not None
    watched, selected, verdict = newest.watched, newest.selected, newest.verdict
    table = newest.ephemeris.assign(t=newest.ephemeris["t"] - times.date)
    errors = selected.past.assign(lead=selected.past["duration"] / DAY, left=selected.past["e_y"])
    count = sum(times.mornings[0] <= one.t for one in watched.known_by(times.date))
    burned = f"; burns in its mornings: {count}, across which no error counts" if count else ""
    way = _way(watched.plan.models[selected.model])

    path = through(table["t"].to_numpy(), state_rows(table))
    return PredictedOrbit(
        sampled(watched.identity, request.days, path, _Errors(table), remark=way),
        times.utc,
        request.days,
        errors[["morning", "lead", "left"]].reset_index(drop=True),
        selected.basis,
        way,
        f"{verdict.word}: {verdict.reason}{burned}",
    )


@dataclass(frozen=True, eq=False)
class _Errors:
    """Errors of the ephemeris of a fit, a table `corrected`, times since the date (`fit_sizes`)."""

    table: pd.DataFrame

    def covariances(self, t: np.ndarray, _: np.ndarray) -> np.ndarray:
        """Return covariances as `ErrorModel`."""
        columns = {name: np.interp(t, self.table["t"], self.table[name]) for name in STATE_COVARIANCES}
        return symmetric_matrices(pd.DataFrame(columns), STATE_COVARIANCES)

    def density(self, *_: np.ndarray) -> None:
        """Return none: a fit does not tell the density's part."""


def _way(model: ResolvedSettings) -> str:
    """Return the fits that were used, in words."""
    arc = arc_of(model)
    of_mean = ", its drag the mean of such fits" if issued.holds_cd(model) else ""
    return f"fit over {arc[0] if arc else 0.0:g} h under all forces{of_mean}"
