"""Arcs from one estimate to a grid of epochs, by its own fit and by fits of its track over other windows."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Self

import numpy as np
import pandas as pd

from opml.base.constants import HOUR
from opml.base.errors import InputError
from opml.catalog.predict import other_windows
from opml.catalog.predict.prediction import predict
from opml.catalog.propagator import Propagator, neighbour_paths
from opml.learning.models import learners
from opml.learning.models.contract import ResolvedSettings
from opml.learning.models.training_inputs import Training
from opml.orbits.manoeuvres import Manoeuvre
from opml.tables import STATE

_ANSWERS = "v_arc_y"  # variable of models that need arcs with another Cd


@dataclass(frozen=True)
class StartArcs:
    """Predictions from one estimate to the epochs of a grid.

    pairs: j is the number of an epoch; rows without numbers are where an arc does not reach
    fits: estimates of all tracks so far over other windows [h], as `other_windows.exclude_burns` has them
    others, perturbed: what these predict from the same track, the second with a Cd a little larger
    """

    pairs: pd.DataFrame
    fits: Mapping[float, pd.DataFrame]
    others: Mapping[float, pd.DataFrame]
    perturbed: Mapping[float, pd.DataFrame]
    cd: float  # of the sheet

    @classmethod
    def propagate(
        cls,
        propagator: Propagator,
        start: pd.DataFrame,
        arrivals: pd.Series,
        *,
        fits: Mapping[float, pd.DataFrame],
        models: Sequence[ResolvedSettings],
        manoeuvres: Sequence[Manoeuvre] = (),
    ) -> Self:
        """Return the arcs that models need from the estimate in `start`, a table of one row.

        propagator: under the assumed model
        arrivals: of `grid`
        fits: estimates over the windows [h] that the models ask for

        In a large field the first arc is propagated under all of it, and the others near it. A few arcs
        alone leave most lanes of a block empty.
        """
        track = start["track"].iloc[0]
        windows = learners.arc_windows(models)
        answering = learners.arc_windows(model for model in models if _ANSWERS in model.variables)
        departing = {hours: fits[hours][fits[hours]["track"] == track] for hours in windows}
        families = [
            start,
            *departing.values(),
            *(other_windows.perturbed(departing[hours]) for hours in answering),
        ]
        together = pd.concat(families, ignore_index=True).assign(track=np.arange(len(families)))
        near = propagator.for_neighbours()
        reached = partial(predict, arrivals=arrivals, max_days=np.inf)
        arcs = reached(near, together)
        if near is not propagator:
            whole = reached(propagator, start)[STATE].to_numpy()
            paths = arcs[STATE].to_numpy().reshape(-1, *whole.shape)
            moved = np.concatenate(neighbour_paths(whole, paths[0], paths))
            arcs = arcs.assign(**dict(zip(STATE, moved.T, strict=True)))
        pairs, *rest = (rows.assign(i=track).reset_index(drop=True) for _, rows in arcs.groupby("i"))
        return cls(
            pairs,
            {
                hours: other_windows.exclude_burns(fits[hours], manoeuvres=manoeuvres, window=HOUR * hours)
                for hours in windows
            },
            dict(zip(windows, rest[: len(windows)], strict=True)),
            dict(zip(answering, rest[len(windows) :], strict=True)),
            propagator.rso.cd,
        )

    def expected(self, model: ResolvedSettings) -> np.ndarray:
        """Return the e_y (n,) [m] that a model expects at the pairs, NaN where it cannot.

        Raises InputError for a model that learns from more than fits.
        """
        columns = self._columns(model)
        if lacking := [name for name in model.variables if name not in columns]:
            raise InputError(f"ephemeris: expected a model of fits alone, got one of {lacking[0]}")
        names = tuple(model.variables)
        inputs = columns[[*names]].to_numpy()
        law = learners.fit(Training(np.zeros((1, len(names))), np.zeros(1), names, seed=0), model)
        known, along = np.isfinite(inputs).all(axis=1), np.full(len(inputs), np.nan)
        along[known] = law.predict(inputs[known])
        return along

    def _columns(self, model: ResolvedSettings) -> pd.DataFrame:
        """Return the columns of the tables `arcs` and `cd_past` that a model needs."""
        if (arc := learners.arc_of(model)) is None:
            return self.pairs
        hours, memory_days = arc
        fitted = {"arc_estimates": self.fits[hours]}
        if _ANSWERS not in model.variables:
            return other_windows.arc_departures(self.pairs, arc_predictions=self.others[hours], **fitted)
        arcs = other_windows.arcs_table(
            self.pairs, self.others[hours], self.perturbed[hours], apriori=self.cd, **fitted
        )
        past = other_windows.build_past(self.pairs, apriori=self.cd, memory_days=memory_days, **fitted)
        return arcs.assign(cd_past=past["cd_past"])


def grid(step: float, last: float) -> pd.Series:
    """Return the epochs of ephemerides by their numbers: multiples of a step, up to the last time [s]."""
    number = np.arange(np.floor(last / step) + 1.0).astype(int)
    return pd.Series(step * number, index=number)
