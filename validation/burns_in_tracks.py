"""Finds burns and tracks of other objects by fits that hold them back, and prints how many and when:

    python -m validation.burns_in_tracks <hours of the fits> [folder of a satellite's orbit in SP3] [--seed N]

A month of Swarm A's orbit is simulated, seen by the paper's stations: without a burn, with burns, and with
tracks of objects that pass before or behind it. The folder holds a real orbit without burns, for false ones.
"""

import argparse
import logging
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pandas as pd

import opml
from opml.base.constants import DAY, HOUR
from opml.catalog.associate import quarantine
from opml.catalog.fit import sightings, start_states
from opml.catalog.fit.estimation_settings import Estimation
from opml.catalog.simulate import tracking, truth
from opml.catalog.simulate.observing import QUANTITIES
from opml.dynamics.settings import Integrator
from opml.interop import truth_from_orbit
from opml.interop.orbit_from_files import OrbitFiles
from opml.orbits.elements import rsw_rotation
from opml.orbits.sheets import Rso, Station
from opml.tables import BURN, STATE

EPOCH, REAL_EPOCH, DAYS, STEP = "2016-09-28T12:09:45", "2019-09-03T00:00:00", 27.99, 20.0
BODY = {"area_to_mass": 0.0035, "cd": 2.2, "cr": 1.25}
SIZES = 0.01, 0.05, 0.2, 1.0
"""Of burns [m/s]."""

AXES = {"along": 1, "across": 2}
EVERY, COUNT = 3.0, 8
"""Days between burns, and their number in a month."""

FOREIGN = 0.02
"""Share of the tracks that are of another object."""

SHIFTS = 3.0, 120.0
"""How long before or behind the satellite other objects pass [s], from least to most."""

LIMIT = 6.0
INTEGRATOR = Integrator()


def settings(hours: float, limit: float | None = LIMIT) -> Estimation:
    """Return fits over windows [h]."""
    return Estimation(
        window_hours=hours,
        max_iterations=30,
        convergence=1e-3,
        start_position_sigma_m=1000.0,
        start_velocity_sigma_mps=1.0,
        least_drag_m=0.1,
        suspect_sigma=limit,
    )


@dataclass(frozen=True)
class Burning:
    """A burn: its time [s] and what it changes, (3,) in RSW [m/s]."""

    t: float
    velocity: np.ndarray


def burns(size: float, axis: int, seed: int) -> list[Burning]:
    """Return a month's burns of a size [m/s], forwards and backwards along one of the axes of RSW."""
    chance = np.random.default_rng(5 + seed)
    days = EVERY * np.arange(1, COUNT + 1) + chance.uniform(0.0, 1.0, COUNT)
    signs = chance.choice([-1.0, 1.0], COUNT)
    return [
        Burning(float(day * DAY), sign * size * np.eye(3)[axis])
        for day, sign in zip(days, signs, strict=True)
    ]


def orbit(flight: opml.Flight, burned: Sequence[Burning]) -> pd.DataFrame:
    """Return the `truth` table of a month with burns."""
    t = np.arange(0.0, DAYS * DAY, STEP)
    state, begin = truth.initial_state(flight.rso, flight.model.gm), 0.0
    states = [state[None]]
    for burn in [*burned, None]:
        end = t[-1] if burn is None else burn.t
        inside = t[(t > begin) & (t < end)]
        epochs = np.concatenate([[begin], inside, [end]])
        path = flight.fly(epochs, state[None], cd=flight.rso.cd, first=[0], last=[len(epochs) - 1]).path(0)
        states.append(path if burn is None else path[:-1])
        if burn is not None:
            turn = rsw_rotation(path[-1:])[0].T
            state, begin = path[-1] + np.append(np.zeros(3), turn @ burn.velocity), burn.t
    return pd.DataFrame({"t": t, **dict(zip(STATE, np.vstack(states).T, strict=True))})


@dataclass(frozen=True)
class Month:
    """An object's flight under the assumed model, its Earth and stations, and the seed of all chance."""

    flight: opml.Flight
    environment: opml.Environment
    stations: Sequence[Station]
    seed: int

    def seen(self, orbit: pd.DataFrame) -> pd.DataFrame:
        """Return the `tracking` table of an orbit."""
        earth, seed = self.environment.earth_orientation, 1 + self.seed
        return tracking.simulate(orbit, earth, self.stations, rso="a", seed=seed)

    def with_foreign(self, orbit: pd.DataFrame, rows: pd.DataFrame) -> tuple[pd.DataFrame, np.ndarray]:
        """Return tracks of which some are of objects before or behind, and which these are."""
        chance = np.random.default_rng(9 + self.seed)
        tracks = np.sort(chance.choice(rows["track"].max(), round(FOREIGN * rows["track"].max()), False))
        shifts = np.exp(chance.uniform(*np.log(SHIFTS), len(tracks))) * chance.choice(
            [-1.0, 1.0], len(tracks)
        )
        where, found = pd.MultiIndex.from_frame(rows[["t", "station"]]), rows.copy()
        for track, shift in zip(tracks, shifts, strict=True):
            away = truth.interpolate(orbit, orbit["t"].to_numpy() + shift)
            other = pd.DataFrame({"t": orbit["t"], **dict(zip(STATE, away.T, strict=True))}).dropna()
            seen = self.seen(other).set_index(["t", "station"])[QUANTITIES].reindex(where).to_numpy()
            theirs = (rows["track"] == track).to_numpy()
            found.loc[theirs, QUANTITIES] = seen[theirs]
        found = found.dropna(subset=QUANTITIES)
        left = pd.Index(found["track"].unique())
        return found.assign(track=left.get_indexer(found["track"])), left.get_indexer(tracks)

    def estimates(self, rows: pd.DataFrame, orbit: pd.DataFrame, method: Estimation) -> pd.DataFrame:
        """Return the `estimates` table, with their errors [m] in the column off."""
        starts = start_states.perturbed(orbit, rows, rso="a", settings=method, seed=42 + self.seed)
        measured = sightings.Measured(rows, self.environment.earth_orientation, self.stations)
        table = quarantine.estimate_all(self.flight, starts, measured, settings=method)
        true = orbit.set_index("t").loc[table["t"], STATE[:3]].to_numpy()
        return table.assign(off=np.linalg.norm(table[STATE[:3]].to_numpy() - true, axis=1))


def stations() -> list[Station]:
    """Return the paper's stations."""
    return list(opml.read_stations("config/stations.tsv").values())


def simulated(seed: int) -> tuple[Month, opml.Flight]:
    """Return a month of Swarm A's orbit, and its flight under the true model."""
    environment = opml.make_environment(EPOCH, days=DAYS + 1.0)
    swarm = replace(opml.read_rsos("config/rsos.tsv")["swarma"], **BODY)
    flights = [
        opml.Flight(opml.force_model(environment, degree=degree, order=degree), swarm, INTEGRATOR)
        for degree in (20, 40)
    ]
    return Month(flights[0], environment, stations(), seed), flights[1]


def real(folder: Path, seed: int) -> tuple[Month, pd.DataFrame]:
    """Return a month of a real orbit, and the orbit."""
    files = OrbitFiles(sorted(folder.glob("*.sp3.gz")), REAL_EPOCH, DAYS * DAY)
    states, _ = truth_from_orbit.truth(files, step=STEP)
    environment = opml.make_environment(REAL_EPOCH, days=DAYS + 1.0, activity="OBSERVED")
    model = opml.force_model(environment, degree=20, order=20)
    unknown = dict.fromkeys(("a", "e", "i", "argp", "raan", "mean_anomaly"), np.nan)
    flight = opml.Flight(model, Rso("swarm", **unknown, **BODY), INTEGRATOR)
    return Month(flight, environment, stations(), seed), states


def errors(table: pd.DataFrame) -> str:
    """Return median, 95 % and largest error [m] of the estimates behind the first day, in words."""
    late = table[table["converged"] & (table["t"] > DAY)]
    median, high, most = np.percentile(late["off"], [50.0, 95.0, 100.0])
    return f"{median:.1f}, {high:.1f}, {most:.0f} m, {len(table) - table['converged'].sum()} not converged"


def held_back(table: pd.DataFrame, foreign: Sequence[int]) -> str:
    """Return how many foreign and other tracks were held back, how many burns shown, and the errors."""
    held, burned = set(table.loc[table["held_back"], "track"]), table["burn_t"].notna().sum()
    theirs = held & set(foreign)
    counts = f"{len(table)} tracks, {len(theirs)} of {len(foreign)} foreign and {len(held - theirs)} others"
    return f"{counts} held back, {burned} burns, {errors(table)}"


def print_found(table: pd.DataFrame, burned: Sequence[Burning], axis: int) -> None:
    """Print which burns were found, after how long, how far off, and the false ones."""
    shown = table[table["burn_t"].notna()]
    ends = [*(burn.t for burn in burned[1:]), np.inf]
    hours, apart, size, matched = [], [], [], 0
    for burn, end in zip(burned, ends, strict=True):
        those = shown[(shown["t"] > burn.t) & (shown["t"] < end)]
        if len(those):
            row = those.iloc[0]
            matched += 1
            hours.append((row["t"] - burn.t) / HOUR)
            apart.append((row["burn_t"] - burn.t) / 60.0)
            size.append(100.0 * (row[BURN[1 + axis]] - burn.velocity[axis]))
    told = [np.round(np.sort(values), 2).tolist() for values in (hours, apart, size)]
    print(f"found {matched} of {len(burned)}, false {len(shown) - matched}")
    print(f"  hours until found {told[0]}\n  minutes off {told[1]}\n  cm/s off {told[2]}", flush=True)


def main(hours: float, folder: Path | None, seed: int) -> None:
    """Print what is found in fits over windows [h]; seed: 0 is that of the tables in notes/."""
    method = settings(hours)
    if folder:
        month, states = real(folder, seed)
        table = month.estimates(month.seen(states), states, method)
        print(f"{folder.name}: {held_back(table, [])}", flush=True)
    month, flight = simulated(seed)
    states = orbit(flight, [])
    rows = month.seen(states)
    print(f"clean: {held_back(month.estimates(rows, states, method), [])}", flush=True)
    spoilt, foreign = month.with_foreign(states, rows)
    print(f"foreign: {held_back(month.estimates(spoilt, states, method), foreign)}", flush=True)
    print(f"  counted: {errors(month.estimates(spoilt, states, settings(hours, None)))}", flush=True)
    for name, axis in AXES.items():
        for size in SIZES:
            burned = burns(size, axis, seed)
            states = orbit(flight, burned)
            table = month.estimates(month.seen(states), states, method)
            print(f"{100.0 * size:g} cm/s {name} track: {errors(table)}")
            print_found(table, burned, axis)


if __name__ == "__main__":
    logging.basicConfig(level=logging.INFO, format="%(message)s")
    parser = argparse.ArgumentParser()
    parser.add_argument("hours", type=float)
    parser.add_argument("folder", type=Path, nargs="?")
    parser.add_argument("--seed", type=int, default=0)
    main(**vars(parser.parse_args()))
