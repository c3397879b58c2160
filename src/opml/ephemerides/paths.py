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
        """Return how far each model is off later states, as `differences`."""
        corrections = np.stack([self.along(model) for model in self.models])
        return differences(self.table, corrections, later, now=self.made_at)

    def ephemeris(self, model: str, sizes: FitSizes, *, at: np.ndarray | None = None) -> pd.DataFrame:
        """Return the table `corrected` of a model.

        sizes: of its errors
        at: (n,) epochs [s]; None: those of the paths, between which splines of degree 7 are millimetres off

        Raises InputError as `along_track_shift.check_smooth` does.
        """
        t, along, path = self.table["t_j"].to_numpy(), self.along(model), state_rows(self.table)
        check_smooth(t, along)
        predicted, states = path, corrected(t, path, along)
        if at is not None:
            t = at
            both = through(self.table["t_j"].to_numpy(), np.stack([predicted, states], axis=1))
            predicted, states = np.moveaxis(both(at), 1, 0)
        rows = pd.DataFrame(dict(zip(STATE, predicted.T, strict=True))).assign(
            i=self.table["i"].iloc[0], t_i=self.table["t_i"].iloc[0], t_j=t, **spread_at(t, self.table)
        )
        rows = rows.assign(rate=rates(states), duration=t - rows["t_i"])
        return ephemeris_table(rows, states, rsw_covariances(sizes.sigmas(rows), rows["rate"].to_numpy()))


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


def ephemeris_table(rows: pd.DataFrame, states: np.ndarray, covariances: np.ndarray) -> pd.DataFrame:
    """Return the table of one ephemeris.

    rows: `StartArcs.pairs`
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


def spread_at(t: np.ndarray, causes: pd.DataFrame) -> dict[str, np.ndarray]:
    """Return the columns of a spread at times t (n,) [s]; causes: the spread at some epochs."""
    spreads = np.stack([causes[name].to_numpy() for name in SPREAD])
    finite = np.isfinite(spreads).all(axis=0)
    known, columns = causes["t_j"].to_numpy()[finite], zip(SPREAD, spreads[:, finite], strict=True)
    return {name: np.interp(t, known, values) for name, values in columns}


def differences(
    rows: pd.DataFrame, corrections: np.ndarray, later: Mapping[str, np.ndarray], *, now: float
) -> dict[str, np.ndarray]:
    """Return how far an ephemeris is off later states by each correction in turn, but for SIGMA_STATE.

    It is columns of a table, as tables of few rows take longer to make than what is in them.

    rows: of one estimate: t_i, and t_j and a state (STATE) at each epoch of the ephemeris
    corrections: (k, epochs) e_y that are taken from it [m]
    later: columns of the table that `judge` returns, with SPREAD, at times that the ephemeris has
    now: when it was made [s]
    """
    at, states = later["t_j"], np.column_stack([later[name] for name in STATE])
    off = (_arrived(rows, corrections, at) - states).reshape(-1, len(STATE))
    before, *after = in_rsw(off, np.tile(states, (1 + len(corrections), 1))).reshape(-1, *states.shape)
    t_i = float(rows["t_i"].iloc[0])
    known = {name: values for name, values in later.items() if name not in STATE}
    known |= {"t_i": np.full(len(at), t_i), "morning": np.full(len(at), now), "duration": at - t_i}
    known |= {"rate": rates(states), "before": before[:, 1]}
    each = {name: np.tile(values, len(after)) for name, values in known.items()}
    return each | dict(zip(COMPONENTS, np.concatenate(after).T, strict=True))


def _arrived(rows: pd.DataFrame, corrections: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Return where an ephemeris is at times (m,), and where each correction has it: (1 + k, m, 6) GCRF."""
    t, predicted = rows["t_j"].to_numpy(), state_rows(rows)
    first, last = np.searchsorted(t, [at.min(initial=t[-1]), at.max(initial=t[0])])
    near = slice(max(0, min(first, last) - _NEAR), max(first, last) + _NEAR)
    paths = [predicted[near], *corrected_by_each(t, predicted, corrections, near)]
    return np.moveaxis(through(t[near], np.stack(paths, axis=1))(at), 1, 0)
