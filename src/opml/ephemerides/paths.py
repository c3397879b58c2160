"""Ephemerides of several models from one estimate, the table `paths`: a morning makes, judges, issues them.

They are arcs from the estimate to a grid of epochs, with the error along the track that each model expects.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd

from opml.base.errors import InputError
from opml.ephemerides.along_track_shift import (
    LEAST_EPOCHS,
    check_smooth,
    corrected,
    corrected_by_each,
    through,
)
from opml.ephemerides.fit_sizes import FitSizes
from opml.ephemerides.start_arcs import StartArcs
from opml.learning.models.contract import ResolvedSettings
from opml.orbits.elements import in_rsw
from opml.orbits.rsw_covariance import rates, rsw_covariances
from opml.tables import COMPONENTS, SPREAD, STATE, STATE_COVARIANCES, state_rows

_ALONG = "e_y_"  # how the columns of corrections begin; the name of the model follows

_NEAR = 64
"""Epochs to both sides of a time that give its state: others move splines by less than 1 um."""


@dataclass(frozen=True)
class Paths:
    """The ephemerides of a morning; table: `paths`."""

    table: pd.DataFrame

    @property
    def made_at(self) -> float:
        """When they were made [s]."""
        return float(self.table["morning"].iloc[0])

    @property
    def start(self) -> int:
        """The track of the estimate that they start from."""
        return int(self.table["i"].iloc[0])

    @property
    def models(self) -> list[str]:
        """The names of their models."""
        return [name.removeprefix(_ALONG) for name in self.table if name.startswith(_ALONG)]

    def along(self, model: str) -> np.ndarray:
        """Return the e_y (n,) [m] that a model expects."""
        return self.table[f"{_ALONG}{model}"].to_numpy()

    def drag_after(self, duration: float) -> float:
        """Return how far a tenth more drag takes them along the track after a duration [s]."""
        return float(np.interp(duration, self.table["t_j"] - self.table["t_i"], self.table["drag_y"]))

    def with_spread(self, spreads: Callable[[pd.DataFrame], pd.DataFrame], sparse: slice) -> "Paths":
        """Return them with what more drag and the weather to come would do, linear between some epochs.

        spreads: returns the `spread` table of pairs; sparse: the rows that arcs are propagated to for it
        """
        rows = self.table.iloc[sparse]
        causes = rows[["t_j"]].join(spreads(rows)[SPREAD].set_axis(rows.index))
        return replace(self, table=self.table.assign(**spread_at(self.table["t_j"].to_numpy(), causes)))

    def differences(self, later: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
        """Return how far each model in turn is off later states, but for SIGMA_STATE.

        It is columns of a table, as tables of few rows take longer to make than what is in them.

        later: columns of `verdicts.later_states`, with SPREAD, at times that the ephemerides have
        """
        at, states = later["t_j"], np.column_stack([later[name] for name in STATE])
        off = (self._arrived(at) - states).reshape(-1, len(STATE))
        before, *after = in_rsw(off, np.tile(states, (1 + len(self.models), 1))).reshape(-1, *states.shape)
        t_i = float(self.table["t_i"].iloc[0])
        known = {name: values for name, values in later.items() if name not in STATE}
        known |= {"t_i": np.full(len(at), t_i), "morning": np.full(len(at), self.made_at)}
        known |= {"duration": at - t_i, "rate": rates(states), "before": before[:, 1]}
        each = {name: np.tile(values, len(after)) for name, values in known.items()}
        return each | dict(zip(COMPONENTS, np.concatenate(after).T, strict=True))

    def _arrived(self, at: np.ndarray) -> np.ndarray:
        """Return where the arc is at times (m,), and where each model has it: (1 + k, m, 6) GCRF."""
        t, predicted = self.table["t_j"].to_numpy(), state_rows(self.table)
        corrections = np.stack([self.along(model) for model in self.models])
        first, last = np.searchsorted(t, [at.min(initial=t[-1]), at.max(initial=t[0])])
        near = slice(max(0, min(first, last) - _NEAR), max(first, last) + _NEAR)
        paths = [predicted[near], *corrected_by_each(t, predicted, corrections, near)]
        return np.moveaxis(through(t[near], np.stack(paths, axis=1))(at), 1, 0)

    def ephemeris(self, model: str, sizes: FitSizes, *, at: np.ndarray) -> pd.DataFrame:
        """Return the table `corrected` of a model at epochs (n,) [s].

        sizes: of its errors

        Between their own epochs splines of degree 7 are millimetres off. Raises InputError as
        `along_track_shift.check_smooth` does.
        """
        t, along, path = self.table["t_j"].to_numpy(), self.along(model), state_rows(self.table)
        check_smooth(t, along)
        both = through(t, np.stack([path, corrected(t, path, along)], axis=1))
        predicted, states = np.moveaxis(both(at), 1, 0)
        begin = {name: self.table[name].iloc[0] for name in ("i", "t_i")}
        rate = rates(states)
        rows = pd.DataFrame(spread_at(at, self.table)).assign(rate=rate, duration=at - begin["t_i"])
        triangle = rsw_covariances(sizes.sigmas(rows), rate)[:, *np.tril_indices(6)].T
        return pd.DataFrame(
            {
                **{name: np.full(len(at), value) for name, value in begin.items()},
                "t": at,
                **dict(zip(STATE, states.T, strict=True)),
                **dict(zip((f"{name}_predicted" for name in STATE), predicted.T, strict=True)),
                **dict(zip(STATE_COVARIANCES, triangle, strict=True)),
            }
        )


def paths(arcs: StartArcs, models: Mapping[str, ResolvedSettings], *, now: float) -> Paths:
    """Return the ephemerides of several models, as far as all of them reach.

    models: settings of learners that learn nothing, by name
    now: when they are made [s]

    Raises InputError where they reach fewer than LEAST_EPOCHS.
    """
    along = {f"{_ALONG}{name}": arcs.expected(model) for name, model in models.items()}
    table = arcs.pairs.assign(morning=now, **along)
    lost = ~np.isfinite(table[[*STATE, *along]].to_numpy()).all(axis=1)
    reached = table[np.cumsum(lost) == 0]
    if len(reached) < LEAST_EPOCHS:
        raise InputError(f"ephemeris: expected at least {LEAST_EPOCHS} epochs ahead, got {len(reached)}")
    return Paths(reached)


def spread_at(t: np.ndarray, causes: pd.DataFrame) -> dict[str, np.ndarray]:
    """Return the columns of a spread at times t (n,) [s]; causes: the spread at some epochs."""
    spreads = np.stack([causes[name].to_numpy() for name in SPREAD])
    finite = np.isfinite(spreads).all(axis=0)
    known, columns = causes["t_j"].to_numpy()[finite], zip(SPREAD, spreads[:, finite], strict=True)
    return {name: np.interp(t, known, values) for name, values in columns}
