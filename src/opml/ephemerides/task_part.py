"""A part of a task: ephemerides that are made side by side, and the further arcs that models need.

Several models may need the same arcs. Each family of them is propagated once in a part.
"""

from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass, field
from functools import partial, wraps
from typing import Concatenate, ParamSpec

import numpy as np
import pandas as pd

from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.catalog.predict import other_windows
from opml.catalog.predict.prediction import predict
from opml.catalog.propagator import Propagator, neighbour_paths
from opml.ephemerides.known_tables import KnownTables
from opml.learning.models.learners import needed_tables
from opml.tables import STATE

DEPARTURES = {f"l_arc_{axis}" for axis in STATE}
"""Columns of the table `arcs` that are the differences of its arcs from predictions."""

Arguments = ParamSpec("Arguments")
_Method = Callable[Concatenate["TaskPart", Arguments], pd.DataFrame]


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


def _once(make: _Method[Arguments]) -> _Method[Arguments]:
    """Return the method of a part that makes a table once for the same arguments."""

    @wraps(make)
    def lookup(part: "TaskPart", /, *args: Arguments.args, **kwargs: Arguments.kwargs) -> pd.DataFrame:
        key = (make.__name__, args, tuple(kwargs.items()))
        if key not in part.made:
            part.made[key] = make(part, *args, **kwargs)
        return part.made[key]

    return lookup


@dataclass(frozen=True)
class TaskPart:
    """Ephemerides to be made side by side from `starts`, rows of the estimates, to the epochs of a grid.

    made: the tables so far
    """

    propagator: Propagator  # under the assumed model
    known: KnownTables
    starts: pd.DataFrame
    grid: Grid
    made: dict[Hashable, pd.DataFrame] = field(default_factory=dict, repr=False, compare=False)

    def variables(
        self, variables: Sequence[str], *, arc: tuple[float, float] | None = None
    ) -> dict[str, pd.Series]:
        """Return the duration and the learning variables that a model needs of `pairs`, by their names.

        arc: window [h] and memory [days] of the arcs that it needs
        """
        pairs = self.pairs()
        of_estimates = self.known.at_estimates
        names = [name for name in variables if name in of_estimates]
        values = {"duration": pairs["t_j"] - pairs["t_i"]}
        values |= dict(of_estimates.loc[pairs["i"], names].set_axis(pairs.index).items()) if names else {}
        for kind in needed_tables(variables):
            table = self._table(kind, arc, variables)
            values |= {name: table[name] for name in variables if name in table}
        return values

    def _table(self, kind: str, arc: tuple[float, float] | None, variables: Sequence[str]) -> pd.DataFrame:
        """Return the table of a kind; raise InputError for one that a morning does not make."""
        hours, memory_days = arc or (0.0, 0.0)
        makers: dict[str, Callable[[], pd.DataFrame]] = {
            "arcs": partial(self.arc_departures if set(variables) <= DEPARTURES else self.arcs, hours),
            "cd_past": partial(self.cd_past, hours, memory_days),
        }
        if kind not in makers:
            raise InputError(f"ephemeris: expected a model of fits alone, got one of the table {kind}")
        return makers[kind]()

    @_once
    def pairs(self) -> pd.DataFrame:
        """Return predictions from the starts to the grid, j the number of an epoch on it.

        Rows without numbers are where an arc does not reach.
        """
        return self._predicted(self.starts, self.propagator)

    @_once
    def predictions(self, hours: float) -> pd.DataFrame:
        """Return predictions to the grid from the same tracks, by fits over another window [h]."""
        return self._predicted(self._at_starts(hours), self.propagator)

    def propagate_together(self, windows: Sequence[float], perturbed: Sequence[float]) -> None:
        """Make `pairs`, `predictions` of windows [h] and `perturbed`, all from one start.

        perturbed: windows [h] of those

        In a large field the first are propagated under all of it, and the others near them. A few arcs
        alone leave most lanes of a block empty.
        """
        families: dict[Hashable, pd.DataFrame] = {
            ("pairs", (), ()): self.starts,
            **{("predictions", (hours,), ()): self._at_starts(hours) for hours in windows},
            **{
                ("perturbed", (hours,), ()): other_windows.perturbed(self._at_starts(hours))
                for hours in perturbed
            },
        }
        numbered = pd.concat(families.values(), ignore_index=True)
        near = self.propagator.for_neighbours()
        propagated = self._predicted(numbered.assign(track=np.arange(len(numbered))), near)
        if near is not self.propagator:
            propagated = _near(self.pairs(), propagated)
        family = np.repeat(np.arange(len(families)), [len(one) for one in families.values()])[propagated["i"]]
        propagated["i"] = numbered["track"].to_numpy()[propagated["i"]]
        self.made.update(
            {key: propagated[family == k].reset_index(drop=True) for k, key in enumerate(families)}
        )

    def _at_starts(self, hours: float) -> pd.DataFrame:
        """Return the fits over another window [h] of the tracks that ephemerides start from."""
        estimates = self.known.other(hours)
        return estimates[estimates["track"].isin(self.starts["track"])]

    @_once
    def arcs(self, hours: float) -> pd.DataFrame:
        """Return the `arcs` table of fits over a window [h]."""
        return other_windows.arcs_table(
            self.pairs(),
            self.predictions(hours),
            self.perturbed(hours),
            arc_estimates=self.known.estimates_without_burns(hours),
            apriori=self.propagator.rso.cd,
        )

    @_once
    def perturbed(self, hours: float) -> pd.DataFrame:
        """Return `predictions` of a window [h], their Cd a little larger."""
        return other_windows.perturbed_predictions(
            self.propagator, self._at_starts(hours), self.predictions(hours)
        )

    @_once
    def arc_departures(self, hours: float) -> pd.DataFrame:
        """Return the columns `l_arc` of that table, for which no further arcs are propagated."""
        return other_windows.arc_departures(
            self.pairs(),
            arc_estimates=self.known.estimates_without_burns(hours),
            arc_predictions=self.predictions(hours),
        )

    @_once
    def cd_past(self, hours: float, memory_days: float) -> pd.DataFrame:
        """Return the `cd_past` table of fits over a window [h]."""
        return other_windows.build_past(
            self.pairs(),
            arc_estimates=self.known.estimates_without_burns(hours),
            apriori=self.propagator.rso.cd,
            memory_days=memory_days,
        )

    def _predicted(self, estimates: pd.DataFrame, propagator: Propagator) -> pd.DataFrame:
        arrivals = self.grid.epochs(estimates["t"].iloc[-1])
        return predict(propagator, estimates, arrivals=arrivals, max_days=self.grid.max_days)


def _near(predictions: pd.DataFrame, near: pd.DataFrame) -> pd.DataFrame:
    """Return predictions that begin at one time, from those under the near part of their field.

    predictions: of the first of them, under all of the field
    """
    whole, paths = predictions[STATE].to_numpy(), near[STATE].to_numpy().reshape(-1, len(predictions), 6)
    moved = np.concatenate(neighbour_paths(whole, paths[0], paths))
    return near.assign(**dict(zip(STATE, moved.T, strict=True)))
