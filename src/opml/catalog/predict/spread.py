"""How far drag and the weather ahead may take predictions: the `spread` table.

From each estimate arcs fly with a tenth more drag, and under many futures of the space weather. What parts
them from the prediction is known at t_i. Drag alone parts them, so the Earth's flattening is all the gravity
they need; and their Cd is the mean of its past, as one short fit may tell nothing of it.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd

from opml.catalog.flight import Flight
from opml.catalog.predict.other_windows import past_cd
from opml.dynamics.forces import with_outlooks
from opml.dynamics.kernels.surroundings import ForceModel
from opml.orbits.elements import in_rsw
from opml.tables import SPREAD, STATE

FLATTENED: Mapping[str, Any] = {"degree": 2, "order": 0, "third_bodies": []}
"""Settings of the force model that the arcs fly under."""

LONGEST_STEP = 300.0
"""Longest step of their integration [s]: differences of arcs need no more."""

TENTH = 0.1
"""Part of the drag that the columns `drag_*` are the effect of."""

_MEMORY_DAYS = 30.0


def build(
    flight: Flight, estimates: pd.DataFrame, pairs: pd.DataFrame, *, futures: pd.DataFrame | None
) -> pd.DataFrame:
    """Return the `spread` table, one row per pair: distances [m] in RSW of the prediction, never negative.

    flight: under the assumed model, `FLATTENED`
    pairs: i, j, t_i and t_j in the order of i
    futures: the table; None where the weather ahead is taken for known

    drag_* is the distance of an arc with a TENTH more drag, weather_* the root mean square of the futures', 0
    without any. Not finite where an arc does not reach.
    """
    started = estimates.set_index("track").loc[np.unique(pairs["i"])]
    cd = _past_cd(estimates, flight.rso.cd).loc[started.index].to_numpy()
    coarse = replace(flight, integrator=replace(flight.integrator, max_step=LONGEST_STEP))
    members = [] if futures is None else [future for _, future in futures.groupby("member")]

    def fly(turn: int, model: ForceModel, drag: float) -> np.ndarray:
        turned = replace(coarse, model=model).part(turn, 2 + len(members))
        return turned.fly_pairs(pairs, started[STATE].to_numpy(), cd=drag * cd)[0]

    predicted = fly(0, flight.model, 1.0)
    drag = np.abs(in_rsw(fly(1, flight.model, 1.0 + TENTH) - predicted, predicted)[:, :3])
    square = np.zeros(drag.shape)
    for turn, future in enumerate(members, start=2):
        states = fly(turn, with_outlooks(flight.model, future), 1.0)
        square += in_rsw(states - predicted, predicted)[:, :3] ** 2
    distances = np.hstack([drag, np.sqrt(square / max(1, len(members)))])
    return pairs[["i", "j"]].assign(**dict(zip(SPREAD, distances.T, strict=True)))


def _past_cd(estimates: pd.DataFrame, apriori: float) -> pd.Series:
    """Return the mean of the past Cd at each estimate, by its track."""
    past = past_cd(estimates, apriori=apriori, memory_days=_MEMORY_DAYS)
    return pd.Series(past["mean"].to_numpy(), index=estimates["track"])
