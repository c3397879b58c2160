"""Arcs near those of predictions, under as much of the gravity field as their distances need."""

import numpy as np
import pandas as pd

from opml.catalog.propagator import Propagator, neighbour_paths
from opml.tables import STATE


def propagate_neighbours(
    propagator: Propagator,
    predictions: pd.DataFrame,
    started: pd.DataFrame,
    states: np.ndarray,
    cd: np.ndarray,
) -> np.ndarray:
    """Return the states (families, n, 6) in GCRF [m, m/s] at t_j of arcs that begin near the predictions'.

    propagator: of the predictions
    started: the estimates that these start from, a row per arc
    states, cd: (families * arcs, 6) and (families * arcs,) of the neighbours, one family behind the other
    """
    near = propagator.for_neighbours()
    propagated, _ = near.propagate_pairs(predictions, states, cd=cd)
    families = propagated.reshape(-1, len(predictions), len(STATE))
    if near is propagator:
        return families
    quiet, own_cd = near.without_progress(), started["cd"].to_numpy()
    origin, _ = quiet.propagate_pairs(predictions, started[STATE].to_numpy(), cd=own_cd)
    return neighbour_paths(predictions[STATE].to_numpy(float), origin, families)
