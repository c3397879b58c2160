"""What is fitted: tracks of the paper's RSO by its three radars, without any error of the force model."""

from dataclasses import dataclass, replace
from functools import cache
from typing import Self

import numpy as np
import pandas as pd

from benchmarks import case
from opml.base.constants import DAY, HOUR
from opml.base.seeds import derive
from opml.catalog.fit.estimate import Estimate
from opml.catalog.fit.estimation import Run
from opml.catalog.fit.least_squares import Fit
from opml.catalog.fit.observations import Measured
from opml.catalog.propagator import Propagator
from opml.catalog.simulate import tracking, truth
from opml.dynamics.kernels.surroundings import ForceModel
from opml.tables import STATE

LONGEST = 48.0
"""Length of the longest windows [h]."""

_START_SIGMAS = np.repeat([10.0, 0.01], 3)
"""Standard deviations [m, m/s] of the states that fits start from, as of the estimate a track before."""


@dataclass(frozen=True)
class Answers:
    """What fits gave: GCRF states (n, 6) [m, m/s], not finite where one did not converge, and iterations."""

    states: np.ndarray
    iterations: np.ndarray


@dataclass(frozen=True)
class Windows:
    """Fits of the state at the beginning of each of `tracks` (n,) to what was measured in `hours` from there.

    measured: the tracking table of all tracks; t (n,): where the windows begin [s since the epoch]; starts
    (n, 6): GCRF states [m, m/s] there that fits start from.
    """

    measured: pd.DataFrame
    tracks: np.ndarray
    t: np.ndarray
    starts: np.ndarray
    hours: float

    def __len__(self) -> int:
        return len(self.tracks)

    def sample(self, count: int) -> Self:
        """Return `count` of the windows, evenly spread, each from the middle of its share."""
        picked = ((np.arange(count) + 0.5) * len(self) / count).astype(int)
        return replace(self, tracks=self.tracks[picked], t=self.t[picked], starts=self.starts[picked])

    def rows(self, number: int) -> pd.DataFrame:
        """Return the measurements of the tracks that begin in a window, a row each."""
        begins = self.measured.groupby("track")["t"].transform("min")
        return self.measured[begins.between(self.t[number], self.t[number] + self.hours * HOUR)]


@cache
def _simulated() -> tuple[pd.DataFrame, pd.DataFrame]:
    """Return true states of the RSO under the assumed model, and the tracks of it."""
    paper = case.paper()
    rso, step = paper.rsos["iss"], paper.values["tracking"]["step_s"]
    propagator = Propagator(case.force_model("assumed"), rso, paper.integrator)
    states = truth.simulate(propagator, duration=case.DAYS * DAY, step=step)
    stations, seed = list(paper.stations.values()), paper.values["seed"]["noise"]
    orientation = case.environment(2 * case.DAYS)["earth_orientation"]
    return states, tracking.simulate(states, orientation, stations, rso=rso.name, seed=seed)


def draw(count: int, *, hours: float) -> Windows:
    """Return `count` windows of a length; those of another length begin at the same tracks."""
    states, measured = _simulated()
    begins = measured.groupby("track")["t"].min()
    whole = begins[begins < case.DAYS * DAY - LONGEST * HOUR]
    chosen = whole.iloc[case.spread(len(whole), count)]
    noise = derive(case.paper().values["seed"]["noise"], "benchmarks", "fits").normal(size=(count, 6))
    starts = states.set_index("t")[STATE].loc[chosen].to_numpy() + noise * _START_SIGMAS
    return Windows(measured, chosen.index.to_numpy(), chosen.to_numpy(), starts, hours)


def fit(model: ForceModel, windows: Windows, *, light_time: bool = False) -> list[Fit]:
    """Return opml's fits of state and Cd, all windows side by side; light_time: as in `Estimation`."""
    run = _run(model, windows, light_time)
    method, length = run.method(np.ones(7, bool)), run.settings.after_hours * HOUR
    estimates = [
        Estimate(
            run.measured.window(track, 0.0, length), Fit(np.append(start, run.propagator.rso.cd), method)
        )
        for track, start in zip(windows.tracks, windows.starts, strict=True)
    ]
    run.fit(estimates)
    return [estimate.fit for estimate in estimates]


def _run(model, windows, light_time):
    """Return what the windows share: the paper's estimation, but from the beginning of a window on."""
    paper, orientation = case.paper(), case.environment(2 * case.DAYS)["earth_orientation"]
    return Run(
        Measured(windows.measured, orientation, list(paper.stations.values())),
        Propagator(model, paper.rsos["iss"], paper.integrator),
        windows.starts,
        paper.estimation.evolve(window_hours=0.0, after_hours=windows.hours, light_time=light_time),
    )


def answers(fits: list[Fit]) -> Answers:
    """Return the answers of opml's fits."""
    states = [fit.best[:6] if fit.converged else np.full(6, np.nan) for fit in fits]
    return Answers(np.array(states), np.array([fit.iterations for fit in fits]))
