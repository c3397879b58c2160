"""The chain of the paper as functions: environment, truth, tracks, estimates, predictions, correction.

All of them stand in `opml` itself. Tables are pandas DataFrames in SI units, radians and GCRF, column by
column as docs/data.md tells; times are seconds since the epoch. Defaults are the paper's settings. Each
example goes on where the one before it stopped, in the order of this file.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd

from opml.base.constants import BODIES, DAY, HOUR
from opml.base.errors import InputError
from opml.catalog.fit import estimation, start_states
from opml.catalog.fit import first_orbit as first_orbits
from opml.catalog.fit import measured_tracks as from_measurements
from opml.catalog.predict import labels, prediction, spread
from opml.catalog.simulate import tracking, truth
from opml.dynamics import forces
from opml.dynamics.ensemble import Integrator
from opml.dynamics.kernels.surroundings import ForceModel
from opml.environment import (
    MARGIN_S,
    celestial_bodies,
    earth_orientation,
    gravity_field,
    nodes,
    solar_activity,
)
from opml.ephemerides import corrected, replays
from opml.interop import mean_elements, tdm
from opml.learning.data import dataset as datasets
from opml.learning.data import splits
from opml.learning.data.cleaning import Cleaning
from opml.learning.data.components import CORRECTED
from opml.learning.judge import metrics
from opml.learning.judge.evaluation import evaluate
from opml.learning.models import learners
from opml.learning.models.contract import Model
from opml.learning.models.daily_training import Lessons
from opml.naming import parse_test
from opml.orbits.sheets import Rso, Station
from opml.orbits.sheets import read_rsos as _read_rsos
from opml.orbits.sheets import read_stations as _read_stations
from opml.readings.own_standardisation import as_tested
from opml.tables import COMPONENTS, LEARNING_VARIABLES

__all__ = ["InputError", "Rso", "Station"]

TRUTH: Mapping[str, Any] = {"degree": 40, "order": 40, "third_bodies": BODIES}
"""The paper's truth model, as options of `force_model`."""

ASSUMED: Mapping[str, Any] = {"degree": 20, "order": 20, "third_bodies": ("sun", "moon", "jupiter")}
"""The paper's assumed model, as options of `force_model`."""

ESTIMATION: Mapping[str, float] = {
    "window_hours": 12,
    "max_iterations": 30,
    "convergence": 0.001,
    "start_position_sigma_m": 1000.0,
    "start_velocity_sigma_mps": 1.0,
    "least_drag_m": 0.1,
    "cd_min": 1.2,
    "cd_max": 3.2,
}
"""Settings of `estimate`; config/README.md explains them."""

CLEANING: Mapping[str, Any] = {
    "cd_min": 1.2,
    "cd_max": 3.2,
    "fence": 3.0,
    "fence_days": (0, 30),
    "previous": "kept_estimate",
}
"""Settings of the cleaning in `dataset`; config/README.md explains them."""

LEARNER: Mapping[str, Any] = {"kind": "svr", "kernel_scale": "sigest", "c": 1.0, "epsilon": 0.1, "tol": 0.001}
"""The paper's learner, for `learn`."""

_SPAN_DAYS = (0.0, 30.0)


@dataclass(frozen=True)
class Environment:
    """What Earth, Sun and Moon do around a run that starts at `epoch` (UTC text).

    The four tables are those of docs/data.md; gm [m3/s2] and radius [m] are the gravity field's, and gms
    [m3/s2] the bodies', by name.
    """

    epoch: str
    earth_orientation: pd.DataFrame
    ephemerides: pd.DataFrame
    solar_activity: pd.DataFrame
    gravity_field: pd.DataFrame
    gm: float
    radius: float
    gms: Mapping[str, float]


def make_environment(
    epoch: str,
    *,
    days: float,
    gravity: str | Path = "EGM2008",
    kernel: str | Path = "DE440",
    activity: str | Path = "MSAFE",
    percentile: int = 50,
    degree: int = 40,
) -> Environment:
    """Tabulate the environment of a run of `days` from a UTC text, once for all that follows.

    gravity: EGM2008, EIGEN-6S or an ICGEM file; kernel: DE440 or an SPK file; activity: MSAFE, OBSERVED or a
    file of either kind; percentile: of MSAFE; degree: highest degree and order kept of the field.
    Raises InputError where a source cannot be read or does not reach.

    >>> environment = opml.make_environment("2016-09-28T12:09:45", days=2)
    >>> environment.radius
    6378136.3
    """
    t = nodes(epoch, DAY * days)
    field = gravity_field.read_icgem(gravity_field.resolve(gravity)).truncate(degree, degree)
    return Environment(
        epoch=epoch,
        earth_orientation=earth_orientation.tabulate(epoch, t),
        ephemerides=celestial_bodies.tabulate(kernel, epoch, t),
        solar_activity=solar_activity.tabulate(activity, epoch, t, percentile),
        gravity_field=gravity_field.table(field, epoch),
        gm=field.gm,
        radius=field.radius,
        gms=celestial_bodies.metadata(kernel)["gm"],
    )


def force_model(
    environment: Environment, *, degree: int = 40, order: int = 40, third_bodies: Sequence[str] = BODIES
) -> ForceModel:
    """Make a force model: the field to a degree and order, bodies that pull, drag and radiation pressure.

    The defaults are the paper's truth model (`TRUTH`); `ASSUMED` holds those of its assumed one.
    Raises InputError for a degree above the environment's and for an unknown body.

    >>> true_model = opml.force_model(environment)
    >>> assumed_model = opml.force_model(environment, **opml.ASSUMED)
    """
    highest = int(environment.gravity_field["n"].max())
    if not 0 <= order <= degree <= highest:
        raise InputError(
            f"force_model: degree, order: expected 0 <= order <= degree <= {highest}, got {degree}, {order}"
        )
    if unknown := [name for name in third_bodies if name not in BODIES]:
        raise InputError(f"force_model: third_bodies: expected {', '.join(BODIES)}, got {unknown[0]}")
    return forces.build(
        environment.earth_orientation,
        environment.ephemerides,
        environment.solar_activity,
        environment.gravity_field,
        epoch=environment.epoch,
        degree=degree,
        order=order,
        bodies=third_bodies,
        gm=environment.gm,
        radius=environment.radius,
        gms=environment.gms,
    )


def read_stations(path: str | Path) -> dict[str, Station]:
    """Read a sheet of radar stations, by name, in its order; columns as config/README.md tells.

    Raises InputError, naming file, row and column.

    >>> stations = list(opml.read_stations("config/stations.tsv").values())
    >>> [station.name for station in stations]
    ['eglin', 'clear', 'kaena']
    """
    return _read_stations(path)


def read_rsos(path: str | Path) -> dict[str, Rso]:
    """Read a sheet of RSOs, by name: osculating GCRF elements at the epoch, and bodies (config/README.md).

    Raises InputError, naming file, row and column.

    >>> iss = opml.read_rsos("config/rsos.tsv")["iss"]
    >>> iss.a
    6783340.0
    """
    return _read_rsos(path)


def read_elements(
    path: str | Path, *, name: str, epoch: str, area_to_mass: float, cd: float = 2.2, cr: float = 1.25
) -> Rso:
    """Read an RSO from a TLE or an OMM (KVN, JSON, XML), flown by SGP4 to a UTC text; area_to_mass [m2/kg].

    Raises InputError, naming file and line or key, and where SGP4 cannot reach the epoch.

    >>> lines = (
    ...     "1 25544U 98067A   16270.55892361  .00003421  00000-0  59245-4 0  9994",
    ...     "2 25544  51.6447 263.7421 0006793 345.4559  14.5438 15.54019233 20745",
    ... )
    >>> _ = Path("iss.tle").write_text("\\n".join(lines))
    >>> other = opml.read_elements("iss.tle", name="other", epoch="2016-09-28T12:09:45", area_to_mass=0.05)
    >>> 6.7e6 < other.a < 6.9e6
    True
    """
    satellite = mean_elements.read(path)
    body = mean_elements.Body(area_to_mass, cd, cr)
    return mean_elements.rso(satellite, name=name, epoch=epoch, body=body)


def propagate(
    model: ForceModel, rso: Rso, *, days: float, step: float = 20.0, integrator: Integrator | None = None
) -> pd.DataFrame:
    """Propagate an RSO from the epoch: the table `truth`, a GCRF state every `step` [s] for `days`.

    integrator: Dormand-Prince 8(5,3) with the paper's tolerance and step limits by default.
    Raises InputError where the RSO does not stay in orbit that long. Source: sec. Truth Dynamic Models.

    >>> truth = opml.propagate(true_model, iss, days=2)
    >>> len(truth)
    8641
    """
    return truth.simulate(model, rso, duration=DAY * days, step=step, integrator=integrator or Integrator())


def track(
    truth: pd.DataFrame, environment: Environment, stations: Sequence[Station], *, rso: Rso, seed: int = 42
) -> pd.DataFrame:
    """Track an RSO: the table `tracking`, each station's azimuth, elevation and range with its noise.

    truth: from `propagate`; seed: of the noise. Raises InputError where no station ever sees the RSO.
    Source: sec. Measurement Models.

    >>> tracks = opml.track(truth, environment, stations, rso=iss)
    >>> tracks["track"].nunique()
    29
    """
    return tracking.simulate(truth, environment.earth_orientation, stations, rso=rso.name, seed=seed)


def write_tracks(path: str | Path, tracks: pd.DataFrame, *, epoch: str, rso: Rso) -> None:
    """Write tracks as a CCSDS tracking data message (TDM); `epoch` is the UTC text that times count from.

    >>> opml.write_tracks("iss.tdm", tracks, epoch=environment.epoch, rso=iss)
    """
    tdm.write(path, tracks, epoch=epoch, rso=rso.name)


def read_tracks(*paths: str | Path, epoch: str, stations: Sequence[Station]) -> pd.DataFrame:
    """Read what stations measured of an RSO from TDMs: the table `tracking`, where `*_true` is NaN.

    epoch: UTC text that times count from. Measurements of other stations are left out. Raises InputError,
    naming file and line, for what is malformed, or what a station cannot see and an orbit cannot be.

    >>> measured = opml.read_tracks("iss.tdm", epoch=environment.epoch, stations=stations)
    >>> list(measured["range"]) == list(tracks["range"])
    True
    """
    return from_measurements.tracks(tdm.measurements(paths, epoch=epoch), stations)


def first_orbit(
    model: ForceModel,
    tracks: pd.DataFrame,
    environment: Environment,
    stations: Sequence[Station],
    *,
    rso: Rso,
    start: Rso | None = None,
    integrator: Integrator | None = None,
) -> pd.DataFrame:
    """Find a first orbit without a truth: the table `starts`, a state at each track's start, for `estimate`.

    model: the assumed one; start: an RSO whose elements at the epoch are carried to the tracks, such as that
    of `read_elements`; where None, an orbit is determined from the tracks of the first day. Raises InputError
    where none gives one, and where tracks are far from the elements.

    >>> starts = opml.first_orbit(assumed_model, measured, environment, stations, rso=iss)
    >>> len(starts)
    29
    """
    used = _laid_over(ESTIMATION, None, "first_orbit")
    bounds = used.pop("cd_min"), used.pop("cd_max")
    return first_orbits.starts(
        model,
        tracks,
        environment.earth_orientation,
        stations,
        rso,
        given=first_orbits.of_sheet(start, model.gm) if start else None,
        settings=estimation.Estimation(**used, cd_bounds=bounds),
        integrator=integrator or Integrator(),
    )


def estimate(
    model: ForceModel,
    truth: pd.DataFrame,
    tracks: pd.DataFrame,
    environment: Environment,
    stations: Sequence[Station],
    *,
    rso: Rso,
    settings: Mapping[str, float] | None = None,
    after_hours: float = 0.0,
    integrator: Integrator | None = None,
    seed: int = 42,
    threads: int = 1,
) -> pd.DataFrame:
    """Estimate state and drag coefficient at each track's start: the table `estimates`, one row per track.

    model: the assumed one; truth: perturbed with `seed`, where a first fit starts, or the table `starts` of
    `first_orbit`, which is taken as it is; settings: those that differ from `ESTIMATION`; after_hours: tracks
    that begin so long after an estimate are used, too, for labels: nothing may be predicted from it. A fit
    that fails is a row with its reason. Raises InputError for an unknown setting. Source: sec. Estimation
    Models.

    >>> estimates = opml.estimate(assumed_model, truth, tracks, environment, stations, rso=iss)
    >>> bool(estimates["converged"].all())
    True
    """
    used = _laid_over(ESTIMATION, settings, "estimate")
    bounds = used.pop("cd_min"), used.pop("cd_max")
    asked = estimation.Estimation(**used, cd_bounds=bounds, after_hours=after_hours)
    return estimation.estimate_all(
        model,
        start_states.chosen(truth, tracks, rso=rso.name, settings=asked, seed=seed),
        tracks,
        environment.earth_orientation,
        stations,
        rso,
        settings=asked,
        integrator=integrator or Integrator(),
        threads=threads,
    )


def predict(
    model: ForceModel,
    truth: pd.DataFrame | None,
    estimates: pd.DataFrame,
    *,
    rso: Rso,
    max_days: float = 7.0,
    integrator: Integrator | None = None,
    threads: int = 1,
) -> pd.DataFrame:
    """Predict from each estimate to every later track start: the table `predictions`, with the true errors.

    model: the assumed one; truth: None where there is none, the true states and errors are NaN then;
    max_days: longest prediction. A pair that the arc does not reach has its reason.
    Source: sec. Orbit Prediction and Machine Learning Model of the Prediction Error.

    >>> predictions = opml.predict(assumed_model, truth, estimates, rso=iss)
    >>> bool((predictions["t_j"] > predictions["t_i"]).all())
    True
    """
    return prediction.predict_all(
        model,
        truth,
        estimates,
        rso,
        max_days=max_days,
        integrator=integrator or Integrator(),
        threads=threads,
    )


def label(
    predictions: pd.DataFrame, estimates: pd.DataFrame, tracks: pd.DataFrame, *, after_hours: float = 0.0
) -> pd.DataFrame:
    """Hold predictions against later estimates, as without a truth: the table `labels`, one row per pair.

    estimates: of the tracks predicted to; after_hours: as `estimate` had it. Errors are in RSW of the later
    estimate [m, m/s], with its formal uncertainty and when it is known; a pair without one has the reason.
    Source: docs/labels.md.

    >>> labels = opml.label(predictions, estimates, tracks)
    >>> bool((labels["t_known"] > predictions["t_j"]).all())
    True
    """
    return labels.build(predictions, estimates, tracks, after=HOUR * after_hours)


def dataset(
    estimates: pd.DataFrame,
    predictions: pd.DataFrame,
    tracks: pd.DataFrame,
    environment: Environment,
    *,
    cleaning: Mapping[str, Any] | None = None,
    labels: pd.DataFrame | None = None,
) -> pd.DataFrame:
    """Capture the error model: the table `dataset`, learning variables and true errors of every pair.

    cleaning: settings that differ from `CLEANING`; a dropped row stays, with `keep` false and the reason;
    labels: of `label`, in the place of the true errors; the table is `labelled` then.
    Raises InputError for an unknown setting and for tables that do not belong together.
    Source: sec. Dataset Capturing the Orbit Prediction Error Model.

    >>> rows = opml.dataset(estimates, predictions, tracks, environment)
    >>> len(rows) == len(predictions)
    True
    """
    settings = _laid_over(CLEANING, cleaning, "dataset")
    return datasets.build(
        estimates,
        predictions,
        tracks,
        gm=environment.gm,
        cleaning=Cleaning.from_settings(settings),
        labels=labels,
    )


def learn(
    dataset: pd.DataFrame,
    *,
    component: str = "e_y",
    learner: Mapping[str, Any] = LEARNER,
    train: str = "random-80",
    span_days: Sequence[float] = _SPAN_DAYS,
    seed: int = 42,
) -> Model:
    """Learn an error component from the kept rows of a dataset; the model has `variables` and `predict(x)`.

    learner: as under `learners` in the settings; train: a split (docs/wildcards.md); span_days: window of t_j
    that random splits draw from; seed: of the draw. Raises InputError for what is unknown and for no rows.
    Source: sec. Support Vector Machine.

    >>> model = opml.learn(rows)
    >>> "duration" in model.variables
    True
    """
    if component not in COMPONENTS:
        raise InputError(f"learn: component: expected {', '.join(COMPONENTS)}, got {component}")
    chosen = splits.training_rows(dataset, train, span_days=span_days, seed=seed)
    settings = learners.resolved(learner, component=component, variables=LEARNING_VARIABLES)
    return learners.train(dataset[chosen], component=component, settings=settings, seed=seed)


def correct(
    model: Model,
    dataset: pd.DataFrame,
    *,
    component: str = "e_y",
    test: str = "rest",
    train: str | None = "random-80",
    span_days: Sequence[float] = _SPAN_DAYS,
    seed: int = 42,
    learned: pd.DataFrame | None = None,
) -> pd.DataFrame:
    """Correct predictions by a model: the table `evaluation`, true, predicted and residual error of each row.

    test: which rows (docs/wildcards.md); train, span_days, seed: as `learn` had them, so that its rows are
    left out; train is None where the model learned from another RSO; learned: the dataset of the same pairs
    that the model learned from, where its errors are labels. Raises InputError for no rows, and for a test
    that takes a model of its own (`-together`). Source: sec. Validation of the Trained SVM Model.

    >>> corrected = opml.correct(model, rows)
    >>> list(corrected.columns)
    ['i', 'j', 'duration', 'true', 'predicted', 'residual']
    """
    if parse_test(test).standardisation == "together":
        raise InputError(f"correct: test: expected one that asks no model of its own, got {test}")
    chosen = splits.rows_tested(dataset, test, train=train, span_days=span_days, seed=seed, learned=learned)
    return evaluate(as_tested(model, test), dataset, chosen, component=component)


def p_ml(evaluation: pd.DataFrame) -> float:
    """Performance metric P_ML [%] of a correction: what is left of the summed error; 100 is no better.

    Raises InputError where there is no error to correct. Source: sec. Validation of the Trained SVM Model.

    >>> round(opml.p_ml(corrected))
    29
    """
    return metrics.p_ml(evaluation["true"].to_numpy(), evaluation["predicted"].to_numpy())


def lessons(
    dataset: pd.DataFrame, *, learner: Mapping[str, Any] = LEARNER, first_day: float = 0.0, seed: int = 42
) -> Lessons:
    """A learner of e_y that is trained anew each morning, on the errors of the dataset known by then.

    learner: as under `learners` in the settings; first_day: of the rows that it is trained on; seed: of its
    draws.

    >>> daily = opml.lessons(rows, learner={"kind": "none"})  # two days are too short for a law
    >>> bool(daily.learns)
    False
    """
    settings = learners.resolved(learner, component=CORRECTED, variables=LEARNING_VARIABLES)
    return Lessons(dataset, settings, seed, first_day)


def replay(
    force_model: ForceModel,
    lessons: Lessons,
    estimates: pd.DataFrame,
    predictions: pd.DataFrame,
    tracks: pd.DataFrame,
    environment: Environment,
    *,
    rso: Rso,
    train_days: Sequence[float],
    max_days: float = 7.0,
    every_hours: float = 6.0,
    cleaning: Mapping[str, Any] | None = None,
    window_hours: float = 12.0,
    integrator: Integrator | None = None,
    threads: int = 1,
) -> pd.DataFrame:
    """Run the mornings that are over again: the table `replay`, what each ephemeris was off by.

    force_model: the assumed one; train_days: first and last day to train on, of which a learner sees half
    before its first morning; every_hours: between the estimates that ephemerides start from. Raises
    InputError where nothing can be held against.

    >>> mornings = opml.replay(
    ...     assumed_model, daily, estimates, predictions, tracks, environment,
    ...     rso=iss, train_days=(0, 1.5), every_hours=1,
    ... )
    >>> bool((mornings["t_i"] >= mornings["morning"]).all())
    True
    """
    flight = corrected.Flight(force_model, rso, integrator or Integrator(), threads)
    known = _known(estimates, predictions, tracks, environment, cleaning, window_hours)
    first_day = replays.first_day(lessons, known, train_days=train_days)
    starts = replays.departures(known, every_hours=every_hours, first_day=first_day)
    pairs = predictions[predictions["i"].isin(starts["track"])]
    return replays.build(
        flight,
        known,
        lessons,
        starts,
        replays.judge(lessons.dataset, predictions, None),
        _spreading(flight, known, environment)(pairs),
        max_days=max_days,
    )


def ephemeris(
    force_model: ForceModel,
    lessons: Lessons,
    replay: pd.DataFrame,
    estimates: pd.DataFrame,
    predictions: pd.DataFrame,
    tracks: pd.DataFrame,
    environment: Environment,
    *,
    rso: Rso,
    until_days: float,
    max_days: float = 7.0,
    step: float = 60.0,
    each: bool = False,
    window_hours: float = 12.0,
    cleaning: Mapping[str, Any] | None = None,
    integrator: Integrator | None = None,
    threads: int = 1,
) -> pd.DataFrame:
    """Correct the newest prediction: the table `corrected`, states and covariances every `step` [s].

    force_model: the assumed one; replay: of the same lessons, from which the covariances come; until_days: up
    to when errors are known, the ephemeris starts from the newest estimate by then, or from it and `each`
    later one, trained anew each morning. It reaches max_days ahead, as far as the environment does. Raises
    InputError where nothing can be made.

    >>> ahead = opml.ephemeris(
    ...     assumed_model, daily, mornings, estimates, predictions, tracks, environment,
    ...     rso=iss, until_days=1.5,
    ... )
    >>> bool((ahead["t"].diff().dropna() == 60.0).all())
    True
    """
    flight = corrected.Flight(force_model, rso, integrator or Integrator(), threads)
    known = _known(estimates, predictions, tracks, environment, cleaning, window_hours)
    end = float(environment.earth_orientation["t"].iloc[-1]) - MARGIN_S
    return corrected.build(
        flight,
        known,
        lessons,
        replay,
        corrected.departures(known, known_until=DAY * until_days, each=each),
        corrected.Grid(step, max_days, end),
        spreads=_spreading(flight, known, environment),
        first_morning=DAY * until_days,
    )


def _known(
    estimates: pd.DataFrame,
    predictions: pd.DataFrame,
    tracks: pd.DataFrame,
    environment: Environment,
    cleaning: Mapping[str, Any] | None,
    window_hours: float,
) -> corrected.Known:
    cleaned = Cleaning.from_settings(_laid_over(CLEANING, cleaning, "ephemeris"))
    at = datasets.of_estimates(estimates, predictions, tracks, gm=environment.gm, cleaning=cleaned)
    return corrected.Known(estimates, at, window_hours, environment.gm, bounds=cleaned.cd_bounds)


def _spreading(
    flight: corrected.Flight, known: corrected.Known, environment: Environment
) -> corrected.Spread:
    flat = force_model(environment, **spread.FLATTENED)
    options = flight.options | {"model": flat}
    return lambda pairs: spread.build(estimates=known.estimates, pairs=pairs, futures=None, **options)


def _laid_over(defaults: Mapping[str, Any], given: Mapping[str, Any] | None, what: str) -> dict[str, Any]:
    """The defaults with the given settings over them; raises InputError for one that there is not."""
    if unknown := sorted(set(given or {}) - set(defaults)):
        raise InputError(f"{what}: settings: expected {', '.join(defaults)}, got {unknown[0]}")
    return {**defaults, **(given or {})}
