"""Ephemerides to be made: from estimates to the epochs of a regular grid, with what models ask for there.

From an estimate the assumed model predicts to every epoch of the grid. The variables of a learned model are
computed at those epochs as at later tracks. No truth is needed: all of it is known at t_i.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np
import pandas as pd

from opml.base.constants import DAY, LANES
from opml.base.errors import InputError
from opml.catalog.flight import Flight, Progress
from opml.catalog.predict import mechanism, other_windows
from opml.catalog.predict.mechanism import FittedArcs
from opml.catalog.predict.prediction import predict
from opml.catalog.predict.resonance import Resonances
from opml.catalog.predict.sensitivity import sensitivities
from opml.ephemerides.along_track_shift import LEAST_EPOCHS
from opml.ephemerides.known import Known
from opml.learning.models.learners import tables_asked
from opml.tables import STATE, STATE_COVARIANCES

TOGETHER = LANES
"""Ephemerides made side by side, an arc each; their tables take some hundred MB."""


@dataclass(frozen=True)
class Grid:
    """Epochs of ephemerides: multiples of `step` [s], up to max_days after an estimate and to `end` [s]."""

    step: float
    max_days: float
    end: float

    def epochs(self, last: float) -> pd.Series:
        """Return epochs [s] by their numbers, as far as ephemerides from estimates up to `last` [s] reach."""
        number = np.arange(np.floor(min(last + DAY * self.max_days, self.end) / self.step) + 1.0).astype(int)
        return pd.Series(self.step * number, index=number)


@dataclass(frozen=True)
class Task:
    """Ephemerides to be made from `starts`, rows of the estimates, to the epochs of a grid.

    flight: under the assumed model
    """

    flight: Flight
    known: Known
    starts: pd.DataFrame
    grid: Grid

    @classmethod
    def read(
        cls, files: Any, settings: Mapping[str, Any], *, threads: int = 1, progress: Progress | None = None
    ) -> Self:
        """Read the task of a job; raises InputError as `Known.read` and `departures` do."""
        known = Known.read(files, settings)
        step, max_days, duration_days = settings["grid"]
        return cls(
            Flight.read(files, settings, threads=threads, progress=progress),
            known,
            departures(
                known, known_until=DAY * settings["known_until_days"], each=settings["from"] == "each"
            ),
            Grid(step, max_days, DAY * duration_days),
        )

    def by_parts(self, make: Callable[[Self], Iterator[pd.DataFrame]]) -> pd.DataFrame:
        """Return the tables of all ephemerides as one; `make` yields those of a part of the task.

        Raises InputError where no ephemeris reaches anywhere.
        """
        tables: list[pd.DataFrame] = []
        for begin in range(0, len(self.starts), TOGETHER):
            starts = self.starts.iloc[begin : begin + TOGETHER]
            tables += make(replace(self, flight=self.flight.without_progress(), starts=starts))
            if self.flight.progress:
                self.flight.progress((begin + len(starts)) / len(self.starts))
        if not tables:
            least = f"{LEAST_EPOCHS} epochs {self.grid.step:g} s apart"
            raise InputError(
                f"ephemeris: expected {least} after an estimate and before the run ends, got fewer"
            )
        return pd.concat(tables, ignore_index=True)

    def columns(self, variables: Sequence[str]) -> pd.DataFrame:
        """Return predictions from the starts to the grid, with the learning variables that a model asks for.

        j is the number of the epoch on the grid. Rows without numbers are where an arc does not reach.
        """
        pairs = self.predicted(self.starts)
        columns = pairs.join(self.known.at_estimates, on="i")
        columns["duration"] = columns["t_j"] - columns["t_i"]
        for kind in tables_asked(variables):
            if kind not in _BESIDE:
                raise InputError(f"ephemeris: expected a learner that asks for one RSO alone, got the {kind}")
            columns = columns.join(_BESIDE[kind](self, pairs).drop(columns=["i", "j"]))
        return columns

    def predicted(self, estimates: pd.DataFrame) -> pd.DataFrame:
        """Return predictions of estimates to the grid."""
        arrivals = self.grid.epochs(estimates["t"].iloc[-1])
        return predict(self.flight, estimates, arrivals=arrivals, max_days=self.grid.max_days)


def departures(known: Known, *, known_until: float, each: bool) -> pd.DataFrame:
    """Return the estimates that ephemerides start from: the newest usable one up to `known_until` [s].

    With `each` all usable later ones, too. Raises InputError where there is none.
    """
    usable = known.may_depart()
    newest = np.flatnonzero(usable & (known.estimates["t"].to_numpy() <= known_until))
    if not newest.size:
        last = f"day {known_until / DAY:g}, the last to learn from"
        raise InputError(f"ephemeris: expected a usable estimate up to {last}, got none")
    later = known.estimates[newest[-1] :][usable[newest[-1] :]]
    return later if each else later[:1]


def _mechanism(task: Task, pairs: pd.DataFrame) -> pd.DataFrame:
    """Return the `mechanism` table of pairs."""
    known = task.known
    if known.long is None:
        raise InputError("ephemeris: expected fits over a longer window, as the learner asks for, got none")
    long_pairs = task.predicted(_of_same_tracks(known.long.estimates, pairs))
    short, long = (
        FittedArcs(
            estimates, predictions, sensitivities(task.flight, estimates, predictions, bounds=known.bounds)
        )
        for estimates, predictions in ((known.estimates, pairs), (known.long.estimates, long_pairs))
    )
    resonances = Resonances(known.resonances, known.long.window_hours, known.gm)
    return mechanism.build(short, long, bounds=known.bounds, resonances=resonances)


def _arcs(task: Task, pairs: pd.DataFrame) -> pd.DataFrame:
    """Return the `arcs` table of pairs."""
    estimates = task.known.arc_estimates()
    return other_windows.build_arcs(
        task.flight,
        pairs,
        arc_estimates=estimates,
        arc_predictions=task.predicted(_of_same_tracks(estimates, pairs)),
    )


def _cd_past(task: Task, pairs: pd.DataFrame) -> pd.DataFrame:
    """Return the `cd_past` table of pairs."""
    return other_windows.build_past(
        pairs,
        arc_estimates=task.known.arc_estimates(),
        apriori=task.flight.rso.cd,
        memory_days=task.known.memory_days,
    )


def _held(task: Task, pairs: pd.DataFrame) -> pd.DataFrame:
    """Return the `held` table of pairs."""
    return other_windows.build_held(
        task.flight, pairs, arc_estimates=task.known.arc_estimates(), memory_days=task.known.memory_days
    )


_BESIDE = {"mechanism": _mechanism, "arcs": _arcs, "cd_past": _cd_past, "held": _held}
"""How the tables that a learner asks for are made of pairs."""


def _of_same_tracks(estimates: pd.DataFrame, pairs: pd.DataFrame) -> pd.DataFrame:
    """Return the estimates of the same tracks that pairs start from."""
    return estimates[estimates["track"].isin(pairs["i"].unique())]


def reached(columns: pd.DataFrame, names: Sequence[str]) -> Iterator[pd.DataFrame]:
    """Yield the rows of each estimate up to its first row without numbers in the columns `names`."""
    lost = ~np.isfinite(columns[list(names)].to_numpy()).all(axis=1)
    for rows in columns.groupby("i", sort=True).indices.values():
        before = rows[np.cumsum(lost[rows]) == 0]
        if len(before) >= LEAST_EPOCHS:
            yield columns.iloc[before]


def ephemeris_table(rows: pd.DataFrame, states: np.ndarray, covariances: np.ndarray) -> pd.DataFrame:
    """Return the table of one ephemeris.

    rows: `Task.columns` of one estimate
    states: (n, 6) GCRF [m, m/s]
    covariances: (n, 6, 6) in RSW
    """
    columns = {"i": rows["i"].to_numpy(), "t_i": rows["t_i"].to_numpy(), "t": rows["t_j"].to_numpy()}
    predicted = {f"{name}_predicted": rows[name].to_numpy() for name in STATE}
    triangle = covariances[:, *np.tril_indices(6)].T
    return pd.DataFrame(
        columns
        | dict(zip(STATE, states.T, strict=True))
        | predicted
        | dict(zip(STATE_COVARIANCES, triangle, strict=True))
    )
