"""Ephemerides to be made: from estimates to the epochs of a regular grid, with what models ask for there.

From an estimate the assumed model predicts to every epoch of the grid. The variables of a learned model are
computed at those epochs as at later tracks. No truth is needed: all of it is known at t_i.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
import pandas as pd

from opml.base.constants import DAY, LANES
from opml.base.errors import InputError
from opml.catalog.propagator import Progress, Propagator, PropagatorSettings
from opml.ephemerides.along_track_shift import LEAST_EPOCHS
from opml.ephemerides.known_tables import KnownSettings, KnownTables
from opml.ephemerides.task_part import Grid, TaskPart
from opml.tables import STATE, STATE_COVARIANCES

TOGETHER = LANES  # ephemerides made side by side, an arc each; their tables take some hundred MB


class TaskSettings(PropagatorSettings, KnownSettings):
    """Estimates that ephemerides start from, and the grid of epochs: step [s], span and run [days]."""

    known_until_days: float
    grid: tuple[float, float, float]


@dataclass(frozen=True)
class Task:
    """Ephemerides to be made from `starts`, rows of the estimates, to the epochs of a grid."""

    propagator: Propagator  # under the assumed model
    known: KnownTables
    starts: pd.DataFrame
    grid: Grid

    @classmethod
    def read(
        cls, files: Any, settings: TaskSettings, *, threads: int = 1, progress: Progress | None = None
    ) -> Self:
        """Read the task of a job; raises InputError as `KnownTables.read` and `departure` do."""
        known = KnownTables.read(files, settings)
        step, max_days, duration_days = settings.grid
        return cls(
            Propagator.read(files, settings, threads=threads, progress=progress),
            known,
            departure(known, known_until=DAY * settings.known_until_days),
            Grid(step, max_days, DAY * duration_days),
        )

    def parts(self) -> Iterator[TaskPart]:
        """Yield the parts of the task, each to be done with before the next; tell the progress in between."""
        for begin in range(0, len(self.starts), TOGETHER):
            starts = self.starts.iloc[begin : begin + TOGETHER]
            yield TaskPart(self.propagator.without_progress(), self.known, starts, self.grid)
            if self.propagator.progress:
                self.propagator.progress((begin + len(starts)) / len(self.starts))

    def joined(self, tables: Sequence[pd.DataFrame]) -> pd.DataFrame:
        """Return the tables of all ephemerides as one; raise InputError where none reaches anywhere."""
        if not tables:
            least = f"{LEAST_EPOCHS} epochs every {self.grid.step:g} s"
            raise InputError(
                f"ephemeris: expected {least} after an estimate and before the run ends, got fewer"
            )
        return pd.concat(tables, ignore_index=True)


def departure(known: KnownTables, *, known_until: float) -> pd.DataFrame:
    """Return the row of the newest estimate up to `known_until` [s] that an ephemeris may start from.

    Raises InputError where there is none.
    """
    usable = known.may_depart()
    newest = np.flatnonzero(usable & (known.estimates["t"].to_numpy() <= known_until))
    if not newest.size:
        last = f"day {known_until / DAY:g}, the last to learn from"
        raise InputError(f"ephemeris: expected a usable estimate up to {last}, got none")
    return known.estimates.iloc[newest[-1:]]


def reached(columns: pd.DataFrame, names: Sequence[str]) -> Iterator[pd.DataFrame]:
    """Yield the rows of each estimate up to its first row without numbers in the columns `names`."""
    lost = ~np.isfinite(columns[list(names)].to_numpy()).all(axis=1)
    for rows in columns.groupby("i", sort=True).indices.values():
        before = rows[np.cumsum(lost[rows]) == 0]
        if len(before) >= LEAST_EPOCHS:
            yield columns.iloc[before]


def ephemeris_table(rows: pd.DataFrame, states: np.ndarray, covariances: np.ndarray) -> pd.DataFrame:
    """Return the table of one ephemeris.

    rows: `TaskPart.pairs` of one estimate
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
