"""Fits LAGEOS-2 to laser ranges that were really measured, and prints what is left of them by station:

    python -m validation.laser <folder of the files>

The folder holds normal points (CRD), stations (SINEX: coordinates and eccentricities) and the ILRS's
prediction of the same days (CPF), where the fit starts.
"""

import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

import opml
from opml.base.constants import BODIES, DAY
from opml.catalog.fit import fixes, laser_ranges
from opml.catalog.fit.estimate import Estimate
from opml.catalog.fit.estimation import Run
from opml.catalog.fit.estimation_settings import Estimation
from opml.catalog.fit.first import first_orbit, track_fits
from opml.catalog.fit.least_squares import Fit
from opml.interop import crd, sinex, truth_from_orbit
from opml.interop.orbit_from_files import OrbitFiles
from opml.orbits.elements import in_rsw
from opml.orbits.sheets import Rso
from opml.tables import STATE

EPOCH, DAYS = "2016-02-11T00:00:00", 4.0
LAST = 2.5
"""Where the last hours begin [d]."""

PREDICTED = 2.0, 2.9
"""Days of the prediction."""

DEGREE = 70
LAGEOS = {"area_to_mass": 6.97e-4, "cd": 0.0, "cr": 1.13}
OFFSET, SIGMA = 0.251, 0.02


def propagator(environment: opml.Environment) -> opml.Propagator:
    """Return LAGEOS-2 under the model that real satellites are flown under."""
    model = opml.force_model(
        environment, degree=DEGREE, order=DEGREE, third_bodies=BODIES, forces=["solid_tides", "relativity"]
    )
    unknown = dict.fromkeys(("a", "e", "i", "argp", "raan", "mean_anomaly"), np.nan)
    return opml.Propagator(
        model,
        Rso("lageos2", **unknown, **LAGEOS),
        opml.Integrator(position_tolerance_m=1e-4, max_step_s=75.0),
    )


def predicted(folder: Path) -> pd.DataFrame:
    """Return the states of the ILRS's prediction, every twenty minutes."""
    begin, end = PREDICTED
    files = OrbitFiles([folder / "lageos2_cpf_160213_5441.sgf"], "2016-02-13T00:00:00", (end - begin) * DAY)
    states, _ = truth_from_orbit.truth(files, step=1200.0)
    return states.assign(t=states["t"] + begin * DAY)


def fitted(run: Run, track: int, begin: float, end: float) -> Estimate:
    """Return the fit at the start of a pass to all that was measured from begin to end [d]."""
    at = run.measured.epochs[run.measured.at[track]]
    window = run.measured.window(track, at - begin * DAY, end * DAY - at)
    start = np.append(run.states[track], run.propagator.rso.cd)
    estimate = Estimate(window, Fit(start, run.method(np.arange(7) < 6)))
    run.fit([estimate])
    return estimate


@dataclass(frozen=True)
class Comparison:
    """What a fit leaves.

    by_station: points, their mean, scatter and root mean square [cm] of each station
    from_prediction: root mean square distance from the ILRS's prediction along R, S and W [m]
    """

    by_station: pd.DataFrame
    from_prediction: np.ndarray


def by_station(run: Run, estimate: Estimate, stations: np.ndarray) -> pd.DataFrame:
    """Return points, their mean, scatter and root mean square [cm] of each of the stations (rows,)."""
    rows, [left] = estimate.window.rows, run.residuals([estimate])
    table = pd.Series(100.0 * left * run.measured.deviations(rows)).groupby(
        pd.Series(stations[rows], name="station")
    )
    return table.agg(points="size", mean="mean", scatter="std", rms=lambda cm: np.sqrt(np.mean(cm**2)))


def fits(folder: Path) -> dict[str, Comparison]:
    """Return a fit to all that was measured, and one to the last hours, by their names."""
    environment = opml.make_environment(EPOCH, days=DAYS, degree=DEGREE)
    lageos, path = propagator(environment), predicted(folder)
    ranges = laser_ranges.table(
        crd.read([folder / "lageos2_2016-02-14.crd.gz"], epoch=environment.epoch),
        laser_ranges.Sites(
            sinex.read_coordinates(folder / "SLRF2014.snx.gz"),
            sinex.read_eccentricities(folder / "ecc_une.snx.gz"),
        ),
        epoch=environment.epoch,
        earth_orientation=environment.earth_orientation,
        ephemerides=environment.ephemerides,
        sigma=SIGMA,
        offset=OFFSET,
    )
    measured = fixes.measurements(ranges, environment.earth_orientation, [])
    middle = path.iloc[len(path) // 2]
    starts = first_orbit.starts_from_state(lageos, measured, (middle["t"], middle[STATE].to_numpy(float)))
    settings = Estimation(
        window_hours=24.0,
        max_iterations=20,
        convergence=1e-3,
        start_position_sigma_m=1.0,
        start_velocity_sigma_mps=1.0,
        least_drag_m=1e3,
    )
    run = Run.of_starts(lageos, starts, measured, settings)
    track = int(np.argmin(np.abs(starts["t"] - LAST * DAY)))
    found = {}
    for name, begin in (("three days", 0.0), ("the last 18 hours", LAST)):
        estimate = fitted(run, track, begin, DAYS)
        at, known = measured.epochs[estimate.window.at], path[STATE].to_numpy()
        flown = track_fits.everywhere(lageos, path["t"].to_numpy(), at, estimate.fit.best)
        apart = np.sqrt((in_rsw(flown - known, known)[:, :3] ** 2).mean(axis=0))
        found[name] = Comparison(by_station(run, estimate, measured.stations), apart)
    return found


def main(folder: Path) -> None:
    """Print the fits."""
    for name, fit in fits(folder).items():
        print(f"\n{name}\n{fit.by_station.round(1)}")
        print("from the prediction, rms of R, S, W [m]:", fit.from_prediction.round(2))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
