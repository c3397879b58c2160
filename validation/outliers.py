"""Fits to tracks with outliers, with a track of another object and with constant errors; prints how far off:

    python -m validation.outliers [--seed N]

The ISS for three days, known to the model, seen by the paper's stations, in eight runs of other noise.
"""

import argparse
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import pandas as pd

import opml
from opml.base.constants import DAY
from opml.catalog.fit import estimation, sightings, start_states
from opml.catalog.fit.estimation_settings import Estimation
from opml.catalog.simulate import tracking, truth
from opml.catalog.simulate.observing import QUANTITIES, sigmas, wrapped
from opml.tables import STATE

EPOCH, DAYS, STEP, RUNS = "2016-09-28T12:09:45", 3.0, 20.0, 8
SETTINGS = Estimation(
    window_hours=12.0,
    max_iterations=30,
    convergence=1e-3,
    start_position_sigma_m=1000.0,
    start_velocity_sigma_mps=1.0,
    least_drag_m=0.1,
    cd_bounds=(1.2, 3.2),
)
EDITING, BEARING = SETTINGS.evolve(reject_sigma=5.0), SETTINGS.evolve(bias_sigma=3.0)

OUTLIERS, LEAST, MOST = 0.05, 1.0, 3.0
"""Share of the numbers that are off, and powers of ten of their sigmas by which they are, from and to."""

LATE = 60.0
"""How long behind the satellite the other object passes [s]."""

RANGE_OFF, ANGLE_OFF = 50.0, np.radians(0.05)
"""Constant errors of stations [m, rad]."""


@dataclass(frozen=True)
class Case:
    """Tracks of one run, and the orbit behind them."""

    flight: opml.Flight
    environment: opml.Environment
    stations: list[opml.Station]
    orbit: pd.DataFrame
    rows: pd.DataFrame
    chance: np.random.Generator

    def with_outliers(self) -> pd.DataFrame:
        """Return tracks of which some numbers are far off."""
        spread = {station.name: sigmas(station, QUANTITIES) for station in self.stations}
        sigma = np.array([spread[name] for name in self.rows["station"]])
        size = 10.0 ** self.chance.uniform(LEAST, MOST, sigma.shape)
        size *= self.chance.choice([-1.0, 1.0], sigma.shape) * (self.chance.random(sigma.shape) < OUTLIERS)
        return self._with(wrapped(self.rows[QUANTITIES].to_numpy() + size * sigma, QUANTITIES))

    def with_foreign(self) -> pd.DataFrame:
        """Return tracks of which one is of an object behind."""
        late = self.orbit.assign(t=self.orbit["t"] + LATE)
        earth = self.environment.earth_orientation
        other = tracking.simulate(late, earth, self.stations, rso="other", seed=2).set_index(["t", "station"])
        theirs = other[QUANTITIES].reindex(pd.MultiIndex.from_frame(self.rows[["t", "station"]])).to_numpy()
        seen = np.isfinite(theirs).all(axis=1)
        whole = [track for track, rows in self.rows.groupby("track") if seen[rows.index].mean() > 0.5]
        of_track = (self.rows["track"] == self.chance.choice(whole)).to_numpy()
        values = np.where(of_track[:, None], theirs, self.rows[QUANTITIES])
        return self._with(values)[~of_track | seen].reset_index(drop=True)

    def with_biases(self) -> pd.DataFrame:
        """Return tracks of stations whose numbers are all off alike, up or down by chance."""
        signs = {station.name: self.chance.choice([-1.0, 1.0], 3) for station in self.stations}
        off = np.array([signs[name] for name in self.rows["station"]]) * [ANGLE_OFF, ANGLE_OFF, RANGE_OFF]
        return self._with(wrapped(self.rows[QUANTITIES].to_numpy() + off, QUANTITIES))

    def errors(self, rows: pd.DataFrame, settings: Estimation) -> pd.Series:
        """Return how far fits of three tracks and more are off [m]; NaN of those that did not converge."""
        starts = start_states.perturbed(self.orbit, rows, rso="iss", settings=settings, seed=42)
        measured = sightings.Measured(rows, self.environment.earth_orientation, self.stations)
        found = estimation.estimate_all(self.flight, starts, measured, settings=settings)
        true = self.orbit.set_index("t").loc[found["t"], STATE[:3]].to_numpy()
        off = pd.Series(np.linalg.norm(found[STATE[:3]].to_numpy() - true, axis=1))
        return off.where(found["converged"])[found["tracks_used"] >= 3]

    def _with(self, values: np.ndarray) -> pd.DataFrame:
        return self.rows.assign(**dict(zip(QUANTITIES, values.T, strict=True)))


def cases(seed: int) -> Iterator[Case]:
    """Yield the runs, each with noise and chance of its own."""
    environment = opml.make_environment(EPOCH, days=DAYS)
    model = opml.force_model(environment, degree=8, order=8, third_bodies=["sun", "moon", "jupiter"])
    flight = opml.Flight(model, opml.read_rsos("config/rsos.tsv")["iss"])
    stations = list(opml.read_stations("config/stations.tsv").values())
    orbit = truth.simulate(flight, duration=DAYS * DAY, step=STEP)
    for number in range(RUNS * seed, RUNS * (seed + 1)):
        earth, noise = environment.earth_orientation, number + 1
        rows = tracking.simulate(orbit, earth, stations, rso="iss", seed=noise)
        yield Case(flight, environment, stations, orbit, rows, np.random.default_rng(number))


def main(seed: int) -> None:
    """Print the errors of all runs together, by what is wrong with the measurements."""
    off: dict[str, list[pd.Series]] = {}
    for case in cases(seed):
        outliers, foreign, biased = case.with_outliers(), case.with_foreign(), case.with_biases()
        for name, rows, settings in (
            ("clean", case.rows, SETTINGS),
            ("outliers, left out", outliers, EDITING),
            ("a track of another object, left out", foreign, EDITING),
            ("the same, counted", foreign, SETTINGS),
            ("clean, bias_sigma", case.rows, BEARING),
            ("biased", biased, SETTINGS),
            ("biased, bias_sigma", biased, BEARING),
        ):
            off.setdefault(name, []).append(case.errors(rows, settings))
    for name, parts in off.items():
        errors = pd.concat(parts)
        median, high, most = np.nanpercentile(errors, [50.0, 95.0, 100.0])
        lost = int(errors.isna().sum())
        print(f"{name}: {median:.1f}, {high:.1f}, {most:.0f} m of {len(errors)} fits, {lost} not converged")


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--seed", type=int, default=0)
    main(**vars(parser.parse_args()))
