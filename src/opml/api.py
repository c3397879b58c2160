"""The chain of the paper as functions: environment, truth, tracks, estimates, predictions, correction.

All of them stand in `opml` itself. Tables are pandas DataFrames in SI units, radians and GCRF, column by
column as ``opml docs data`` tells; times are seconds since the epoch. Defaults are the paper's settings. Each
example goes on where the one before it stopped, in the order of this file.
"""

import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from importlib import import_module
from pathlib import Path
from typing import Any

import pandas as pd

from opml.base import epochs
from opml.base.constants import BODIES, DAY
from opml.base.errors import InputError
from opml.base.files import FilePath, project_file
from opml.catalog.associate import quarantine
from opml.catalog.fit import fixes, measured_tracks as from_measurements, start_states
from opml.catalog.fit.estimation_settings import Estimation
from opml.catalog.fit.first import first_orbit as first_orbits
from opml.catalog.predict import labels, prediction
from opml.catalog.propagator import Propagator
from opml.catalog.simulate import tracking, truth
from opml.dynamics.forces import build, tabulated
from opml.dynamics.kernels.surroundings import ForceModel
from opml.dynamics.run_environment import Environment
from opml.dynamics.settings import ForceModelSettings, Integrator
from opml.element_sets import prediction as set_prediction
from opml.element_sets.prediction import Prediction
from opml.environment import nodes, solar_activity
from opml.fetch import public_data
from opml.interop import comparison, formats, known_orbits, tdm
from opml.interop.known_orbits import KnownOrbit
from opml.interop.predicted_orbit import PredictedOrbit
from opml.learning.data import dataset as datasets, splits
from opml.learning.data.cleaning import Cleaning
from opml.learning.judge import metrics
from opml.learning.judge.evaluation import evaluate
from opml.learning.models import learners
from opml.learning.models.contract import Model
from opml.mornings.prediction_request import Request
from opml.orbits.sheets import Rso, Station, read_rsos as _read_rsos, read_stations as _read_stations
from opml.study import prediction as measured_prediction
from opml.study.settings import packaged
from opml.tables import COMPONENTS, LEARNING_VARIABLES

__all__ = ["Environment", "InputError", "Integrator", "Prediction", "Propagator", "Rso", "Station"]

TRUTH: Mapping[str, Any] = packaged.RUN["force_models"]["truth"]
"""The paper's truth model, as options of `force_model`."""

ASSUMED: Mapping[str, Any] = packaged.RUN["force_models"]["assumed"]
"""The paper's assumed model, as options of `force_model`."""

CLEANING: Mapping[str, Any] = packaged.PAPER_STUDY["cleaning"]
"""Settings of the cleaning in `dataset`; config/README.md explains them."""

_CD_BOUNDS = ("cd_min", "cd_max")

ESTIMATION: Mapping[str, Any] = (
    packaged.RUN["estimation"]
    | {bound: CLEANING[bound] for bound in _CD_BOUNDS}
    | {"reject_sigma": None, "suspect_sigma": None}
)
"""Settings of `estimate`, which config/README.md explains."""

LEARNER: Mapping[str, Any] = packaged.RUN["learners"]["svr"]
"""The paper's learner, for `learn`."""

_SPAN_DAYS: Sequence[float] = packaged.PAPER_STUDY["span_days"]


@dataclass(frozen=True)
class Catalogue:
    """One RSO in a catalogue: its tracks, estimates from them, and predictions from these.

    estimates, predictions, tracks: the tables; environment: that they were made in; cleaning: settings that
    differ from `CLEANING`.
    """

    estimates: pd.DataFrame
    predictions: pd.DataFrame
    tracks: pd.DataFrame
    environment: Environment
    cleaning: Mapping[str, Any] = field(default_factory=dict)


def make_environment(
    epoch: epochs.Time,
    *,
    days: float,
    gravity: str | Path = "EGM2008",
    activity: str | Path = "MSAFE",
    percentile: int = 50,
    degree: int = 40,
) -> Environment:
    """Tabulate the environment of a run of `days` from an epoch (UTC), once for all that follows.

    gravity: EGM2008 or an ICGEM file; activity: MSAFE, OBSERVED or a file of either kind; percentile: of
    MSAFE; degree: highest degree and order kept of the field.
    Raises InputError where a source cannot be read or does not reach.

    >>> environment = opml.make_environment("2016-09-28T12:09:45", days=2)
    >>> environment.radius
    6378136.3
    """
    epoch = epochs.instant(epoch)
    t = nodes(epoch, DAY * days)
    indices = solar_activity.tabulate(activity, epoch, t, percentile)
    return tabulated(epoch, t, indices, gravity=gravity, degree=degree)


def force_model(
    environment: Environment,
    *,
    degree: int = 40,
    order: int = 40,
    third_bodies: Sequence[str] = BODIES,
    forces: Sequence[str] = (),
) -> ForceModel:
    """Make a force model: the field to a degree and order, bodies that pull, drag and radiation pressure.

    forces: that count, too: `solid_tides`, `relativity`

    The defaults are the paper's truth model (`TRUTH`); `ASSUMED` holds those of its assumed one.
    Raises InputError for a degree above the environment's, for an unknown body, and where no tides can be
    added to the field.

    >>> true_model = opml.force_model(environment)
    >>> assumed_model = opml.force_model(environment, **opml.ASSUMED)
    """
    highest = int(environment.gravity_field["n"].max())
    if not 0 <= order <= degree <= highest:
        raise InputError(
            f"force_model: degree, order: expected 0 <= order <= degree <= {highest}, got {degree}, {order}"
        )
    given = {"degree": degree, "order": order, "third_bodies": list(third_bodies), "forces": list(forces)}
    return build(environment, ForceModelSettings.read(given, "force_model"))


def read_stations(path: str | Path) -> dict[str, Station]:
    """Read a sheet of radar stations, by name, in its order; columns: config/README.md.

    Where there is none of that name, the package's own is read, such as config/stations.tsv. Raises
    InputError, naming file, row and column.

    >>> stations = list(opml.read_stations("config/stations.tsv").values())
    >>> [station.name for station in stations]
    ['eglin', 'clear', 'kaena']
    """
    return _read_stations(project_file(path))


def read_rsos(path: str | Path) -> dict[str, Rso]:
    """Read a sheet of RSOs, by name: osculating GCRF elements at the epoch, and bodies (config/README.md).

    Where there is none of that name, the package's own is read, such as config/rsos.tsv. Raises InputError,
    naming file, row and column.

    >>> iss = opml.read_rsos("config/rsos.tsv")["iss"]
    >>> iss.a
    6783340.0
    """
    return _read_rsos(project_file(path))


def propagate(propagator: Propagator, *, days: float, step: float = 20.0) -> pd.DataFrame:
    """Propagate an RSO from the epoch: the table `truth`, a GCRF state every `step` [s] for `days`.

    propagator: the RSO under the true model. Raises InputError where it does not stay in orbit that long.
    Source: sec. Truth Dynamic Models.

    >>> truth = opml.propagate(opml.Propagator(true_model, iss), days=2)
    >>> len(truth)
    8641
    """
    return truth.simulate(propagator, duration=DAY * days, step=step)


def track(
    truth: pd.DataFrame, environment: Environment, stations: Sequence[Station], *, rso: Rso, seed: int = 42
) -> pd.DataFrame:
    """Track an RSO: the table `tracking`, what each station has a sigma of, with its noise.

    truth: from `propagate`; seed: of the noise. Raises InputError where no station ever sees the RSO.
    Source: sec. Measurement Models.

    >>> tracks = opml.track(truth, environment, stations, rso=iss)
    >>> tracks["track"].nunique()
    29
    """
    return tracking.simulate(
        truth, environment.earth_orientation, stations, rso=rso.name, seed=seed, epoch=environment.epoch
    )


def read_tracks(*paths: str | Path, epoch: epochs.Time, stations: Sequence[Station]) -> pd.DataFrame:
    """Read what stations measured of an RSO from TDMs: the table `tracking`, where `*_true` is NaN.

    epoch: time (UTC) that times count from. Measurements of other stations are left out. Raises InputError,
    naming file and line, for what is malformed, or what a station cannot see or an orbit cannot be.

    >>> from opml.interop import tdm
    >>> tdm.write("iss.tdm", tracks, epoch=environment.epoch, rso=iss.name)
    >>> measured = opml.read_tracks("iss.tdm", epoch=environment.epoch, stations=stations)
    >>> list(measured["range"]) == list(tracks["range"])
    True
    """
    return from_measurements.tracks(tdm.measurements(paths, epoch=epochs.instant(epoch)), stations)


def first_orbit(
    propagator: Propagator,
    tracks: pd.DataFrame,
    environment: Environment,
    stations: Sequence[Station],
    *,
    start: Rso | None = None,
) -> pd.DataFrame:
    """Find a first orbit without a truth: the table `starts`, a state at each track's start, for `estimate`.

    propagator: under the assumed model; start: an RSO whose elements at the epoch are carried to the tracks;
    where None, an orbit is determined from the tracks of the first day.
    Raises InputError where no track gives an orbit, where tracks of angles fit none together, and where
    tracks are far from the elements.

    >>> propagator = opml.Propagator(assumed_model, iss)
    >>> starts = opml.first_orbit(propagator, measured, environment, stations)
    >>> len(starts)
    29
    """
    return first_orbits.starts(
        propagator,
        fixes.measurements(tracks, environment.earth_orientation, stations),
        known=first_orbits.of_sheet(start, propagator.model.gm) if start else None,
        settings=_estimation(None, "first_orbit"),
    )


def estimate(
    propagator: Propagator,
    truth: pd.DataFrame,
    tracks: pd.DataFrame,
    environment: Environment,
    stations: Sequence[Station],
    *,
    settings: Mapping[str, float] | None = None,
    seed: int = 42,
) -> pd.DataFrame:
    """Estimate state and drag coefficient at each track's start: the table `estimates`, one row per track.

    propagator: under the assumed model; truth: perturbed with `seed`, where a first fit starts, or the table
    `starts` of `first_orbit`, which is taken as it is; settings: those that differ from `ESTIMATION`. A
    fit that fails is a row with its reason. Raises InputError for an unknown setting.
    Source: sec. Estimation Models.

    >>> estimates = opml.estimate(propagator, truth, tracks, environment, stations)
    >>> bool(estimates["converged"].all())
    True
    """
    method = _estimation(settings, "estimate")
    rso = propagator.rso.name
    is_known = "track" in truth
    starts = truth if is_known else start_states.perturbed(truth, tracks, rso=rso, settings=method, seed=seed)
    measured = fixes.measurements(tracks, environment.earth_orientation, stations)
    return quarantine.estimate_all(propagator, starts, measured, settings=method)


def predict(
    files: FilePath | Sequence[FilePath],
    *,
    days: float = 7.0,
    object: str | int | None = None,
    date: epochs.Time | None = None,
    weather: FilePath = "NEWEST",
    catalogue: Sequence[FilePath] = (),
    trained: FilePath | None = None,
    stations: Sequence[Station] = (),
    area_to_mass: float | None = None,
) -> PredictedOrbit:
    """Predict an object with a covariance: the orbit inside its element sets, or a fit to measurements.

    files: of TLEs or OMMs, or folders of them; a number or a name, whose sets are fetched as by ``opml
    fetch``; or files of points (OEM, SP3, CPF, CSV) or tracks (TDM); days: 7 at most; object: name,
    designator or number, of several; date: a time (UTC), None for when the newest was known; weather:
    NEWEST, as fetched, else packaged, or a CSSI file; catalogue: others' sets to compare with; trained: a
    model of ``opml train``; stations: of tracks; area_to_mass: of what was measured [m2/kg], None: a guess,
    above 1000 km by light.
    Raises InputError for unreadable files, an object that is not there, days out of range, old weather.
    Source: ``opml docs improve``.

    >>> made = opml.predict("sets.tle", days=3)
    >>> made.state("2026-01-09T00:00:00").shape, made.covariance("2026-01-09T00:00:00").shape
    ((6,), (6, 6))
    >>> made.to_oem("mine.oem")
    >>> bool(made.to_pandas()["sigma_s"].is_monotonic_increasing)
    True
    """
    paths, fetched = public_data.sets_or_files(_paths("predict", files), lambda line: None)
    name = fetched if object is None else str(object)
    date = None if date is None else epochs.instant(date)
    if not isinstance(days, (int, float)):
        raise InputError(f"predict: days: expected a number, got {days!r}")
    if formats.kind_of(paths[0], formats.ELEMENTS, formats.ORBIT, formats.TRACKS) != formats.ELEMENTS:
        request = Request(paths, days, name, date, weather, stations, area_to_mass)
        return measured_prediction.of_measurements(request, progress=lambda line: None)
    return set_prediction.predict(
        paths,
        days=days,
        object=name,
        date=date,
        weather=weather,
        catalogue=_paths("predict", catalogue) if catalogue else (),
        trained=trained,
    )


def _paths(what: str, files: FilePath | Iterable[FilePath]) -> list[FilePath]:
    """Return one path or several as a list. Raises InputError for none, and for what is none."""
    paths = list(files) if isinstance(files, Iterable) and not isinstance(files, (str, bytes)) else [files]
    for path in paths:
        if not isinstance(path, (str, os.PathLike)) or path == "":
            raise InputError(f"{what}: expected files, got {path!r}")
    if not paths:
        raise InputError(f"{what}: expected files, got none")
    return paths


def read_orbit(*paths: FilePath, object: str | int | None = None) -> KnownOrbit:
    """Read an orbit with its covariances from OEM, SP3, CPF, CSV, TLE, OMM or a table, whatever its frame.

    object: name, designator or number, of several; its states are in GCRF, interpolated between those that
    are five minutes apart or less. Raises InputError, naming file and line, for files that are malformed.

    >>> orbit = opml.read_orbit("mine.oem")
    >>> orbit.state("2026-01-09T00:00:00").shape, orbit.covariance("2026-01-09T00:00:00").shape
    ((6,), (6, 6))
    >>> orbit.to_pandas().columns.tolist()
    ['utc', 'x', 'y', 'z', 'vx', 'vy', 'vz', 'sigma_r', 'sigma_s', 'sigma_w']
    """
    together = [path for each in paths for path in _paths("read_orbit", each)]
    return known_orbits.read(_paths("read_orbit", together), None if object is None else str(object))


def compare(ours: KnownOrbit | PredictedOrbit, other: KnownOrbit | PredictedOrbit) -> pd.DataFrame:
    """Compare two orbits: the table `comparison`, ours less the other in RSW [m], at the other's times.

    It has our standard deviations, and the part of our ellipsoid's probability that each error is within.
    Raises InputError where both know nothing of the same time.

    >>> apart = opml.compare(orbit, opml.read_orbit("sets.tle"))
    >>> bool((apart["sigma_s"] > 0.0).all())
    True
    """
    return comparison.compare(*map(known_orbits.of, (ours, other)))


def predict_tracks(
    propagator: Propagator, truth: pd.DataFrame | None, estimates: pd.DataFrame, *, max_days: float = 7.0
) -> pd.DataFrame:
    """Predict from each estimate to every later track start: the table `predictions`, with the true errors.

    propagator: under the assumed model; truth: None where there is none: no true states, errors are NaN;
    max_days: longest prediction. A pair that the arc does not reach has its reason.
    Source: sec. Orbit Prediction and Machine Learning Model of the Prediction Error.

    >>> predictions = opml.predict_tracks(propagator, truth, estimates)
    >>> bool((predictions["t_j"] > predictions["t_i"]).all())
    True
    """
    return prediction.predict_all(propagator, truth, estimates, max_days=max_days)


def label(predictions: pd.DataFrame, estimates: pd.DataFrame, tracks: pd.DataFrame) -> pd.DataFrame:
    """Hold predictions against later estimates, as without a truth: the table `labels`, one row per pair.

    estimates: of the tracks predicted to. Errors are in RSW of the later estimate [m, m/s], with its formal
    uncertainty and when it is known; a pair without one has the reason.
    Source: ``opml docs labels``.

    >>> labels = opml.label(predictions, estimates, tracks)
    >>> bool((labels["t_known"] > predictions["t_j"]).all())
    True
    """
    return labels.build(predictions, estimates, tracks)


def dataset(catalogue: Catalogue, *, labels: pd.DataFrame | None = None) -> pd.DataFrame:
    """Capture the error model: the table `dataset`, learning variables and true errors of every pair.

    A row that is dropped by the catalogue's cleaning stays, with `keep` false and the reason; labels: of
    `label`, in the place of the true errors; the table is `labelled` then.
    Raises InputError for an unknown setting and for tables that do not belong together.
    Source: sec. Dataset Capturing the Orbit Prediction Error Model.

    >>> catalogue = opml.Catalogue(estimates, predictions, tracks, environment)
    >>> rows = opml.dataset(catalogue)
    >>> len(rows) == len(predictions)
    True
    """
    return datasets.build(
        catalogue.estimates,
        catalogue.predictions,
        catalogue.tracks,
        gm=catalogue.environment.gm,
        cleaning=Cleaning.read(_laid_over(CLEANING, catalogue.cleaning, "dataset"), "dataset"),
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

    learner: as under `learners` in the settings; train: a split (``opml docs wildcards``); span_days: window
    of t_j that random splits draw from; seed: of the draw. Raises InputError for what is unknown and for no
    rows. Source: sec. Support Vector Machine.

    >>> model = opml.learn(rows)
    >>> "duration" in model.variables
    True
    """
    if component not in COMPONENTS:
        raise InputError(f"learn: component: expected {', '.join(COMPONENTS)}, got {component}")
    chosen = splits.training_rows(dataset, train, span_days=span_days, seed=seed)
    settings = learners.settings_of(learner).resolved(component=component, variables=LEARNING_VARIABLES)
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

    test: which rows (``opml docs wildcards``); train, span_days, seed: as `learn` had them, so that its rows
    are left out; train is None where the model learned from another RSO; learned: the dataset of the same
    pairs that the model learned from, where its errors are labels. Raises InputError for no rows.
    Source: sec. Validation of the Trained SVM Model.

    >>> corrected = opml.correct(model, rows)
    >>> list(corrected.columns)
    ['i', 'j', 'duration', 'true', 'predicted', 'residual']
    """
    source = dataset if learned is None else learned
    trained = None if train is None else splits.training_rows(source, train, span_days=span_days, seed=seed)
    chosen = splits.test_rows(dataset, test, span_days=span_days, trained=trained)
    return evaluate(model, dataset, chosen, component=component)


def p_ml(evaluation: pd.DataFrame) -> float:
    """Return the performance metric P_ML [%] of a correction: what is left of the summed error.

    100 is no better than no correction.

    Raises InputError where there is no error to correct. Source: sec. Validation of the Trained SVM Model.

    >>> round(opml.p_ml(corrected))
    29
    """
    return metrics.p_ml(evaluation["true"].to_numpy(), evaluation["predicted"].to_numpy())


def style() -> dict[str, str]:
    """Give matplotlib the look of opml's figures; return its colours by what they mean in them.

    The colours (Okabe & Ito 2008) differ under every colour blindness. Needs matplotlib.

    >>> colors = opml.style()
    >>> colors["corrected"]
    '#D55E00'
    """
    look = import_module("opml.figures.style")  # not above: only here the library needs matplotlib
    import_module("matplotlib").rcParams.update(look.LOOK)
    return {
        "true": look.TRUE_COLOR,
        "predicted": look.PREDICTED_COLOR,
        "corrected": look.RESIDUAL,
        "context": look.MUTED,
    }


def _estimation(settings: Mapping[str, float] | None, what: str) -> Estimation:
    """Return the paper's estimation with settings laid over it; raises InputError for an unknown setting."""
    used = _laid_over(ESTIMATION, settings, what)
    bounds: dict[str, float] = {name: used.pop(name) for name in _CD_BOUNDS if name in used}
    return Estimation.read({**used, "cd_bounds": Cleaning.read(bounds, what).cd_bounds}, what)


def _laid_over(defaults: Mapping[str, Any], settings: Mapping[str, Any] | None, what: str) -> dict[str, Any]:
    """Return the defaults with settings laid over them, None for none; raises InputError for other keys."""
    settings = settings or {}
    if unknown := sorted(set(settings) - set(defaults)):
        raise InputError(f"{what}: settings: expected {', '.join(defaults)}, got {unknown[0]}")
    return {name: value for name, value in {**defaults, **settings}.items() if value is not None}
