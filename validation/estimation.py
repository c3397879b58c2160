"""Least squares on the same noisy measurements: opml's and Orekit's."""

from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING

import jpype
import numpy as np
import pandas as pd

from opml.base.constants import DAY, HOUR
from opml.base.seeds import derive
from opml.catalog.associate import quarantine
from opml.catalog.fit import observations, start_states
from opml.catalog.propagator import Propagator
from opml.catalog.simulate import tracking
from opml.catalog.simulate.truth import simulate
from opml.dynamics.kernels.surroundings import ForceModel
from opml.dynamics.settings import Integrator
from opml.orbits.elements import wrap_half_turn
from opml.orbits.sheets import Rso
from opml.tables import PARAMETERS, STATE
from validation import orekit as ok
from validation.case import Case
from validation.orekit import java

if TYPE_CHECKING:
    from concurrent.futures import Future

    from validation.workers import Workers

RSO = "iss"
DAYS = 30.0
WINDOWS = 32

INTEGRATOR = Integrator(position_tolerance_m=1e-4, min_step_s=1e-3, max_step_s=90.0)
"""Of both sides: tight enough for half a day, over which the steps move a fit by millimetres."""

_START_SIGMAS = np.repeat([100.0, 0.1], 3)
_POSITION_SCALE = 1.0  # m, the unit of Orekit's convergence threshold
_CONVERGENCE = 1e-2
_MOST_ITERATIONS = 25


def simulated(
    case: Case, truth: ForceModel, earth_orientation: pd.DataFrame, integrator: Integrator
) -> tuple[pd.DataFrame, pd.DataFrame]:
    """The truth and tracking tables of RSO over DAYS, all stations."""
    settings, propagator = case.values, Propagator(truth, case.rsos[RSO], integrator)
    states = simulate(propagator, duration=DAYS * DAY, step=settings["tracking"]["step_s"])
    stations = list(case.stations.values())
    seed = settings["seed"]["noise"]
    return states, tracking.simulate(states, earth_orientation, stations, rso=RSO, seed=seed)


def opmls(
    case: Case,
    assumed: ForceModel,
    truth: pd.DataFrame,
    measured: pd.DataFrame,
    earth_orientation: pd.DataFrame,
    integrator: Integrator = INTEGRATOR,
) -> pd.DataFrame:
    """Return our estimates at the start of every track."""
    seed = case.values["seed"]["noise"]
    return quarantine.estimate_all(
        Propagator(assumed, case.rsos[RSO], integrator),
        start_states.perturbed(truth, measured, rso=RSO, settings=case.estimation, seed=seed),
        observations.Measured(measured, earth_orientation, list(case.stations.values())),
        settings=case.estimation,
    )


def chosen(estimates: pd.DataFrame, window: float) -> pd.DataFrame:
    """Return WINDOWS converged estimates spread evenly over the time after the first whole window [s]."""
    usable = estimates[estimates["converged"] & (estimates["t"] > window)]
    return usable.iloc[np.linspace(0, len(usable) - 1, WINDOWS).round().astype(int)]


def side_by_side(mine: pd.DataFrame, theirs: pd.DataFrame, truth: pd.DataFrame) -> pd.DataFrame:
    """Return how far apart and how far from the truth both sides are, one row per track where both converged.

    Columns track, position [m], velocity [m/s], cd (differences), error_opml, error_orekit [m], cd_opml,
    cd_orekit.
    """
    both = mine.merge(theirs[theirs["reason"] == ""], on="track", suffixes=("", "_orekit"))
    one, other = both[STATE].to_numpy(), both[[f"{name}_orekit" for name in STATE]].to_numpy()
    true = truth.set_index("t")[STATE].loc[both["t"]].to_numpy()
    return pd.DataFrame(
        {
            "track": both["track"],
            "position": np.linalg.norm((one - other)[:, :3], axis=1),
            "velocity": np.linalg.norm((one - other)[:, 3:], axis=1),
            "cd": np.abs(both["cd"] - both["cd_orekit"]),
            "error_opml": np.linalg.norm((one - true)[:, :3], axis=1),
            "error_orekit": np.linalg.norm((other - true)[:, :3], axis=1),
            "cd_opml": both["cd"],
            "cd_orekit": both["cd_orekit"],
        }
    )


def window_of(case: Case, measured: pd.DataFrame, track: int) -> pd.DataFrame:
    """Return the measurements to which the estimate at the start of a track is fitted."""
    window = HOUR * case.values["estimation"]["window_hours"]
    begins = measured.groupby("track")["t"].min()
    members = begins.index[(begins >= begins[track] - window) & (begins.index <= track)]
    return measured[measured["track"].isin(members)]


def for_tests(
    rows: pd.DataFrame, truth: pd.DataFrame, estimates: pd.DataFrame
) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Return one window's measurements, and true states at its tracks' starts with Orekit's estimate.

    Tracks are numbered from 0 in both; only the last has an estimate ({name}_orekit).
    """
    begins = rows.groupby("track", as_index=False)["t"].min()
    true = begins.merge(truth[["t", *STATE]], on="t", validate="one_to_one")
    kept = estimates[["track", *PARAMETERS]].rename(columns={name: f"{name}_orekit" for name in PARAMETERS})
    both = true.merge(kept[kept["track"] == true["track"].max()], on="track", how="left")
    first = begins["track"].min()
    return tuple(table.assign(track=table["track"] - first) for table in (rows, both))


def orekits(
    workers: "Workers",
    case: Case,
    truth: pd.DataFrame,
    measured: pd.DataFrame,
    tracks: pd.DataFrame,
    gm: float,
) -> list["Future[dict]"]:
    """Have Orekit fit the state at the start of each of `tracks` (one row per track).

    A result has keys track, the state's, cd, iterations and reason, which is empty where the fit converged.
    """
    states = truth.set_index("t")[STATE]
    fits = []
    for track, t in tracks[["track", "t"]].itertuples(index=False):
        off = derive(0, "validation", str(track)).normal(size=6) * _START_SIGMAS
        rows = window_of(case, measured, track)
        start = states.loc[t].to_numpy() + off
        fits.append(workers.submit(f"Orekit's fit of track {track}", _fit, case, gm, track, t, start, rows))
    return fits


def _fit(orekit, case, gm, track, t, start, rows):
    problem = Problem(orekit, case, case.rsos[RSO], gm, INTEGRATOR)
    measurements = geometric(orekit, problem.measurements(rows))
    return {"track": track, **problem.fit(t, start, measurements)}


class Problem:
    """Orekit's batch least squares of one RSO under the assumed model."""

    def __init__(self, orekit: ok.Orekit, case: Case, rso: Rso, gm: float, integrator: Integrator):
        self.orekit, self.rso, self.gm, self.integrator = orekit, rso, gm, integrator
        self.settings, self.stations = case.force_models["assumed"], case.stations
        measurements = ok.org.orekit.estimation.measurements
        self.satellite = measurements.ObservableSatellite(0)
        self.grounds = {
            name: measurements.GroundStation(orekit.topocentric(station))
            for name, station in self.stations.items()
        }

    def fit(self, t: float, start: np.ndarray, measurements: Iterable) -> dict:
        """Fit state and Cd at t [s] to Orekit's measurements, from `start` (6,).

        The keys are the state's, cd, iterations and reason, which is empty where the fit converged.
        """
        estimation, hipparchus = ok.org.orekit.estimation, ok.org.hipparchus
        decomposer = hipparchus.linear.QRDecomposer(1e-15)
        optimizer = hipparchus.optim.nonlinear.vector.leastsquares.GaussNewtonOptimizer(decomposer, False)
        estimator = estimation.leastsquares.BatchLSEstimator(optimizer, self._builder(t, start))
        estimator.setMaxIterations(_MOST_ITERATIONS)
        estimator.setMaxEvaluations(_MOST_ITERATIONS)
        estimator.setParametersConvergenceThreshold(_CONVERGENCE)
        for measurement in measurements:
            estimator.addMeasurement(measurement)
        try:
            flown = estimator.estimate()[0]
        except jpype.JException as reason:
            return {**dict.fromkeys(PARAMETERS, np.nan), "iterations": 0, "reason": str(reason)}
        state = self.orekit.state(flown.getInitialState().getPVCoordinates(self.orekit.gcrf))
        (cd,) = (driver.getValue() for driver in estimator.getPropagatorParametersDrivers(True).getDrivers())
        return {
            **dict(zip(STATE, state, strict=True)),
            "cd": cd,
            "iterations": estimator.getIterationsCount(),
            "reason": "",
        }

    def _builder(self, t, start):
        orbits, conversion = ok.org.orekit.orbits, ok.org.orekit.propagation.conversion
        builder = conversion.NumericalPropagatorBuilder(
            self.orekit.orbit(t, start, self.gm),
            conversion.DormandPrince853IntegratorBuilder(
                self.integrator.min_step_s, self.integrator.max_step_s, self.integrator.position_tolerance_m
            ),
            orbits.PositionAngleType.TRUE,
            _POSITION_SCALE,
        )
        builder.setMass(ok.MASS)
        for force in self.orekit.forces(self.settings, self.rso):
            builder.addForceModel(force)
        for driver in builder.getPropagationParametersDrivers().getDrivers():
            driver.setSelected(driver.getName() == ok.org.orekit.forces.drag.DragSensitive.DRAG_COEFFICIENT)
        return builder

    def measurements(self, rows: pd.DataFrame) -> Iterator:
        """Yield rows of the tracking table as Orekit's measurements, with light time."""
        measurements = ok.org.orekit.estimation.measurements
        for row in rows.itertuples(index=False):
            station, ground, date = (
                self.stations[row.station],
                self.grounds[row.station],
                self.orekit.date(row.t),
            )
            yield measurements.AngularAzEl(
                ground,
                date,
                [row.azimuth, row.elevation],
                [station.sigma_azimuth, station.sigma_elevation],
                [1.0, 1.0],
                self.satellite,
            )
            yield measurements.Range(ground, False, date, row.range, station.sigma_range, 1.0, self.satellite)


def geometric(orekit: ok.Orekit, measurements: Iterable) -> Iterator:
    """Yield Orekit's measurements without light time, as ours are."""
    azimuth_elevation = ok.org.orekit.estimation.measurements.AngularAzEl
    for measurement in measurements:
        pick = _angles if isinstance(measurement, azimuth_elevation) else _distance
        horizon = measurement.getStation().getBaseFrame()
        measurement.addModifier(_WithoutLightTime(orekit.gcrf, horizon, pick))
        yield measurement


@jpype.JImplements("org.orekit.estimation.measurements.EstimationModifier", deferred=True)
class _WithoutLightTime:
    """Puts the geometric value in the place of Orekit's, which is that of the light's departure.

    Orekit's derivatives stay: they differ by the light's 1e-5 of itself, which changes the way to the
    minimum and moves the minimum by the same part of the fit's own error, under a millimetre.
    """

    def __init__(self, gcrf, horizon, pick):
        self.gcrf, self.horizon, self.pick = gcrf, horizon, pick

    @jpype.JOverride
    def getParametersDrivers(self):
        return java.util.Collections.emptyList()

    @jpype.JOverride
    def getEffectName(self):
        return "without light time"

    @jpype.JOverride
    def modifyWithoutDerivatives(self, estimated):
        measurement = estimated.getObservedMeasurement()
        departed, date = estimated.getStates()[0], measurement.getDate()
        position = departed.shiftedBy(date.durationFrom(departed.getDate())).getPosition(self.gcrf)
        seen = self.horizon.getTrackingCoordinates(position, self.gcrf, date)
        estimated.setEstimatedValue(self.pick(seen, measurement.getObservedValue()))

    @jpype.JOverride
    def modify(self, estimated):
        self.modifyWithoutDerivatives(estimated)


def _angles(seen, observed):
    """Return azimuth, in the turn of the observed one, and elevation [rad]."""
    azimuth = observed[0] + wrap_half_turn(seen.getAzimuth() - observed[0])
    return jpype.JArray(jpype.JDouble)([azimuth, seen.getElevation()])


def _distance(seen, observed):
    """Return the range [m]."""
    return jpype.JArray(jpype.JDouble)([seen.getRange()])
