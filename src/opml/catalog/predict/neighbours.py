"""Arcs near those of predictions, under as much of the gravity field as their distances need."""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np
import pandas as pd

from opml.catalog.propagator import Propagator, neighbour_paths
from opml.tables import STATE


@dataclass(frozen=True)
class Neighbours:
    """Arcs that begin near the estimates of predictions."""

    propagator: Propagator  # of the neighbours
    predictions: pd.DataFrame
    origin: np.ndarray | None  # (n, 6) where the estimates' own arcs come then; None: the predictions

    @classmethod
    def of_predictions(cls, propagator: Propagator, predictions: pd.DataFrame, started: pd.DataFrame) -> Self:
        """Return the neighbours of predictions.

        propagator: of the predictions
        started: the estimates that they start from, a row per arc
        """
        near = propagator.for_neighbours()
        if near is propagator:
            return cls(propagator, predictions, None)
        states, cd = started[STATE].to_numpy(), started["cd"].to_numpy()
        origin, _ = near.without_progress().propagate_pairs(predictions, states, cd=cd)
        return cls(near, predictions, origin)

    def part(self, number: int, parts: int) -> Self:
        """Return the same with the progress of one of several equal parts."""
        return replace(self, propagator=self.propagator.part(number, parts))

    def propagate(self, states: np.ndarray, cd: np.ndarray) -> np.ndarray:
        """Return the states (n, 6) in GCRF [m, m/s] of neighbours at t_j.

        cd: (arcs,)
        """
        propagated, _ = self.propagator.propagate_pairs(self.predictions, states, cd=cd)
        if self.origin is None:
            return propagated
        return neighbour_paths(self.predictions[STATE].to_numpy(float), self.origin, propagated[None])[0]
