"""brahe, a Rust library: https://github.com/duncaneddy/brahe, MIT."""

from importlib import metadata

import astropy_iers_data
import brahe
import numpy as np

from benchmarks import case, windows
from benchmarks.peers import activity
from benchmarks.windows import Answers, Windows
from opml.catalog.fit.least_squares import Fit
from opml.environment import solar_activity

_APRIORI = np.diag(np.repeat([1e10, 1e4], 3))
"""Covariance [m2, m2/s2] beforehand, which brahe asks for: so wide that it tells nothing."""

_CONVERGENCE = 1e-2
"""Last correction of the state [m, m/s], as Orekit's."""

_COST_CONVERGENCE = 1e-6
"""Last relative change of the cost; over two days the steps alone move the state by centimetres."""

_MOST_ITERATIONS = 25

_CD_STEP = 0.1


class Brahe:
    """Its `BatchLeastSquares`, which fits the state alone; Cd is that of the least residuals."""

    title = f"brahe {metadata.version('brahe')}"
    model = (
        "EGM2008 20x20, Sun, Moon (analytic), NRLMSISE-00 with the middle day's activity, radiation pressure"
    )
    method = "state alone, Cd known, variational equations"
    way = "RKF 7(8), tolerance 1e-12"
    share = 1

    def __init__(self):
        brahe.set_num_threads(1)
        bulletin = brahe.FileEOPProvider.from_standard_file(astropy_iers_data.IERS_A_FILE, True, "Hold")
        brahe.set_global_eop_provider(bulletin)
        brahe.set_global_space_weather_provider(_space_weather())
        paper = case.paper()
        self.epoch = brahe.Epoch.from_string(f"{paper.epoch}Z")
        self.stations = list(paper.stations)
        self.models = [_radar(station) for station in paper.stations.values()]
        # A thousand times these, and two days without drag end 380 m off; so they end 1.2 m from opml's.
        self.propagation = (
            brahe.NumericalPropagationConfig.with_method(brahe.IntegrationMethod.RKF78)
            .with_abs_tol(1e-6)
            .with_rel_tol(1e-12)
        )
        self.config = brahe.BLSConfig(
            max_iterations=_MOST_ITERATIONS,
            state_correction_threshold=_CONVERGENCE,
            cost_convergence_threshold=_COST_CONVERGENCE,
            store_observation_residuals=False,
        )
        self.cds = {}

    def prepare(self, fitted: Windows) -> None:
        """Find each window's Cd."""
        for number, t in enumerate(fitted.t):
            self.cds[t, fitted.hours] = self._cd(fitted, number)

    def fit(self, fitted: Windows) -> Answers:
        """Fit the state, from Cd known."""
        found = [self._solved(fitted, number, self.cds[t, fitted.hours]) for number, t in enumerate(fitted.t)]
        states = [one.current_state() if one.converged() else np.full(6, np.nan) for one in found]
        return Answers(np.array(states), np.array([one.iterations_completed() for one in found]))

    def twin(self, fitted: Windows) -> list[Fit]:
        """Fit by ours, state and Cd."""
        return windows.fit(case.force_model("assumed"), fitted)

    def _cd(self, fitted, number):
        """Return the Cd with the least residuals, where a parabola through three fits has its vertex."""
        tried = case.paper().rsos["iss"].cd + _CD_STEP * np.array([-1.0, 0.0, 1.0])
        costs = [self._solved(fitted, number, cd).final_cost() for cd in tried]
        bend, slope, _ = np.polyfit(tried, costs, 2)
        return float(-0.5 * slope / bend)

    def _solved(self, fitted, number, cd):
        """Return brahe's estimator after its fit of a window."""
        estimator = brahe.BatchLeastSquares(
            self.epoch + float(fitted.t[number]),
            fitted.starts[number],
            _APRIORI,
            self.propagation,
            _forces(case.paper().rsos["iss"], cd),
            self.models,
            config=self.config,
        )
        estimator.solve(
            [
                brahe.Observation(
                    self.epoch + float(row.t),
                    np.array([row.azimuth, row.elevation, row.range]),
                    self.stations.index(row.station),
                )
                for row in fitted.rows(number).itertuples(index=False)
            ]
        )
        return estimator


def _forces(rso, cd):
    """Return the assumed model, but Jupiter, for a body of 1 kg."""
    value, area = brahe.ParameterSource.value, brahe.ParameterSource.value(rso.area_to_mass)
    return brahe.ForceModelConfig(
        gravity=brahe.GravityConfiguration(
            degree=20, order=20, model_type=brahe.GravityModelType.EGM2008_120
        ),
        drag=brahe.DragConfiguration(brahe.AtmosphericModel.NRLMSISE00, area, value(cd)),
        srp=brahe.SolarRadiationPressureConfiguration(area, value(rso.cr), brahe.EclipseModel.CONICAL),
        third_body=[
            brahe.ThirdBodyConfiguration(body, brahe.EphemerisSource.LowPrecision)
            for body in (brahe.ThirdBody.SUN, brahe.ThirdBody.MOON)
        ],
        mass=value(1.0),
    )


def _radar(station):
    return brahe.AzElRangeMeasurementModel(
        station.longitude,
        station.latitude,
        station.altitude,
        station.sigma_azimuth,
        station.sigma_elevation,
        station.sigma_range,
        brahe.AngleFormat.RADIANS,
    )


def _space_weather():
    """Return the activity of the run's middle day, which hardly changes in a week of MSAFE's."""
    _, f107, ap = list(activity.daily())[activity.MARGIN + int(case.DAYS / 2)]
    kp = float(solar_activity.kp_from_ap(ap))
    return brahe.StaticSpaceWeatherProvider.from_values(kp, ap, f107, f107, 0)
