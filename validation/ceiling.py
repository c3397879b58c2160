"""What an oracle would leave of a study's prediction errors: of the state, of Cd, of the weather.

    python -m validation.ceiling config/studies/swarm.yaml results/swarm

Reads a finished study of one real satellite. From the estimates that mornings start from, arcs are flown
under the weather as forecast and as observed, with the state of the fit or of the orbit, and with Cd of the
fit, the best one of the month or the best one of each week. Prints median and 95th percentile of |e_y| [m].
"""

import argparse
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from opml.base.constants import DAY
from opml.catalog.flight import Flight
from opml.dynamics import force_model
from opml.dynamics.settings import ForceModelSettings, Integrator
from opml.ephemerides.replays import first_of_each
from opml.orbits.elements import in_rsw
from opml.study.settings.merging import merged, with_sheets
from opml.tables import STATE, read_table
from validation.case import ROOT

MARKS = (1, 2, 4, 7)
"""Durations that errors are told at [d]."""

_EVERY = 0.25
"""Time between the epochs that arcs are compared with the orbit at [d], and half the width of a mark."""

_STARTS_EVERY = 6.0
"""Time between the estimates that arcs start from [h], as in the studies."""

_NUDGE = 0.01
_TABLES = ("earth_orientation", "ephemerides", "gravity_field")


@dataclass(frozen=True)
class Mornings:
    """The predictions of a study's mornings, compared with the orbit.

    flights: by what is known of the weather
    pairs: rows of i, j, t_i and t_j
    estimates: a row per i
    true: (pairs, 6) GCRF [m, m/s] at t_j
    at_start: (estimates, 6) of the orbit at t_i
    """

    flights: dict[str, Flight]
    pairs: pd.DataFrame
    estimates: pd.DataFrame
    true: np.ndarray
    at_start: np.ndarray

    @property
    def days(self) -> np.ndarray:
        """Duration of each pair [d]."""
        return ((self.pairs["t_j"] - self.pairs["t_i"]) / DAY).to_numpy()

    @property
    def arc(self) -> np.ndarray:
        """The estimate of each pair, by its number."""
        return np.unique(self.pairs["i"], return_inverse=True)[1]

    def along(self, weather: str, states: np.ndarray, cd: np.ndarray) -> np.ndarray:
        """Return e_y of each pair [m] of arcs from states (estimates, 6) with Cd (estimates,)."""
        flown, _ = self.flights[weather].fly_pairs(self.pairs, states, cd=cd)
        return in_rsw(flown - self.true, self.true)[:, 1]

    def with_best_cd(self, errors: np.ndarray, answer: np.ndarray, group: np.ndarray) -> np.ndarray:
        """Return errors with the one change of Cd in each group that leaves least of their ratio to time.

        answer: of the errors to Cd [m]
        """
        weight = np.maximum(self.days, 0.5) ** -2.0
        shared, own = (np.bincount(group, weight * answer * one) for one in (errors, answer))
        return errors - (shared / own)[group] * answer

    def cases(self, name: str) -> Iterator[tuple[str, np.ndarray]]:
        """Yield what is known, and the errors that are left; name: of the fits."""
        fitted, cd = self.estimates[STATE].to_numpy(), self.estimates["cd"].to_numpy()
        for weather in self.flights:
            yield f"{name}, weather {weather}", self.along(weather, fitted, cd)
            true = self.along(weather, self.at_start, cd)
            yield "  true state, Cd of the fit", true
            answer = (self.along(weather, self.at_start, cd + _NUDGE) - true) / _NUDGE
            one = true - answer * (cd - np.median(cd))[self.arc]
            month = self.with_best_cd(one, answer, np.zeros(len(one), int))
            yield "  true state, best Cd of the month", month
            yield "  true state, best Cd of each week", self.with_best_cd(true, answer, self.arc)


def read(study: Path, results: Path, window_hours: int) -> Mornings:
    """Return the mornings of a finished study of one RSO, from fits over a window [h]."""
    settings = with_sheets(merged([ROOT / "config" / "config.yaml", study]).values)
    values, (name,) = settings.values, settings.orbits
    (path,) = (results / "estimates" / name).glob(f"*_w{window_hours}.parquet")
    known = {table: str(results / "environment" / f"{table}.parquet") for table in _TABLES}
    weathers = {
        "observed": {"solar_activity": "solar_activity"},
        "forecast": {"solar_activity": "solar_activity", "outlooks": "outlooks_3h"},
    }
    flights, assumed = {}, ForceModelSettings(**values["force_models"]["assumed"])
    for weather, tables in weathers.items():
        paths = known | {
            kind: str(results / "environment" / f"{table}.parquet") for kind, table in tables.items()
        }
        model = force_model.read(paths, epoch=values["epoch"], settings=assumed)
        flights[weather] = Flight(model, settings.rsos[name], Integrator(**values["integrator"]))
    truth = read_table(results / "truth" / f"{name}.parquet", "truth").set_index("t")[STATE]
    first_day = 0.5 * sum(values["study"]["days"]["train"])
    estimates = read_table(path, "estimates")
    return _mornings(flights, truth, estimates[estimates["t"] >= DAY * first_day])


def _mornings(flights: dict[str, Flight], truth: pd.DataFrame, estimates: pd.DataFrame) -> Mornings:
    """Return predictions from the first converged estimate of every six hours, as far as the orbit goes."""
    usable = estimates[estimates["converged"]]
    starts = first_of_each(usable, every_hours=_STARTS_EVERY)
    t, step = truth.index.to_numpy(), DAY * _EVERY
    after = step * np.arange(1, round(max(MARKS) / _EVERY) + 1)
    grid = pd.DataFrame({"i": starts["track"], "t_i": starts["t"]}).merge(
        pd.Series(after, name="after"), how="cross"
    )
    grid = grid[grid["t_i"] + grid["after"] < t[-1]]
    t_j = t[np.searchsorted(t, grid["t_i"] + grid["after"])]
    pairs = grid.assign(t_j=t_j, j=np.arange(len(grid)))
    starts = starts[starts["track"].isin(pairs["i"])]
    return Mornings(flights, pairs, starts, truth.loc[t_j].to_numpy(), truth.loc[starts["t"]].to_numpy())


def sizes(days: np.ndarray, along: np.ndarray) -> str:
    """Return median and 95th percentile of |e_y| [m] about each mark, as cells of a table."""
    cells = []
    for mark in MARKS:
        size = np.abs(along[np.abs(days - mark) < 0.5 * _EVERY])
        cells.append(f"{np.nanmedian(size):.0f} / {np.nanpercentile(size, 95.0):.0f}")
    return " | ".join(cells)


def main() -> None:
    """Print the table of a finished study."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("study", type=Path)
    parser.add_argument("results", type=Path)
    parser.add_argument("--windows", type=int, nargs="+", default=[24, 48, 96])
    asked = parser.parse_args()
    print(f"| what is known | {' | '.join(f'{mark} d' for mark in MARKS)} |")
    for window in asked.windows:
        mornings = read(asked.study, asked.results, window)
        for name, along in mornings.cases(f"`fit{window}`"):
            print(f"| {name} | {sizes(mornings.days, along)} |", flush=True)


if __name__ == "__main__":
    main()
