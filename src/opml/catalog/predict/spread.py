"""How far drag and the weather ahead may take predictions: the `spread` table.

From each estimate arcs fly with a tenth more drag, and under many futures of the space weather. What parts
them from the prediction is known at t_i. Drag alone parts them, so the Earth's flattening is all the gravity
they need; and their Cd is the mean of its past, as one short fit may say nothing of it.
"""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pandas as pd

from opml.catalog.flight import fly_pairs, part_of
from opml.catalog.predict.other_windows import past_cd
from opml.dynamics.ensemble import Integrator
from opml.dynamics.forces import with_outlooks
from opml.dynamics.kernels.surroundings import ForceModel
from opml.orbits.elements import in_rsw
from opml.orbits.sheets import Rso
from opml.tables import SPREAD, STATE

FLATTENED: Mapping[str, Any] = {"degree": 2, "order": 0, "third_bodies": []}
"""Settings of the force model that the arcs fly under."""

LONGEST_STEP = 300.0
"""Longest step of their integration [s]: differences of arcs need no more."""

TENTH = 0.1
"""Part of the drag that the columns `drag_*` are the effect of."""

_MEMORY_DAYS = 30.0


def build(
    model: ForceModel,
    estimates: pd.DataFrame,
    pairs: pd.DataFrame,
    rso: Rso,
    *,
    futures: pd.DataFrame | None,
    integrator: Integrator,
    threads: int = 1,
    progress: Callable[[float], None] | None = None,
) -> pd.DataFrame:
    """The `spread` table, one row per pair: distances [m] in RSW of the prediction, never negative.

    model: the assumed one, `FLATTENED`; pairs: i, j, t_i and t_j in the order of i; futures: the table, None
    where the weather ahead is taken for known. drag_*: of an arc with a TENTH more drag; weather_*: root mean
    square of the futures', 0 without any. Not finite where an arc does not reach.
    """
    started = estimates.set_index("track").loc[np.unique(pairs["i"])]
    cd = _past_cd(estimates, rso).loc[started.index].to_numpy()
    steps = Integrator(integrator.position_tolerance, integrator.min_step, LONGEST_STEP)
    members = [] if futures is None else [future for _, future in futures.groupby("member")]
    turns = 2 + len(members)

    def fly(turn: int, forces: ForceModel, drag: float) -> np.ndarray:
        states, _ = fly_pairs(
            forces,
            rso,
            pairs,
            started[STATE].to_numpy(),
            cd=drag * cd,
            integrator=steps,
            threads=threads,
            progress=part_of(progress, turn, turns),
        )
        return states

    predicted = fly(0, model, 1.0)
    drag = np.abs(in_rsw(fly(1, model, 1.0 + TENTH) - predicted, predicted)[:, :3])
    square = np.zeros(drag.shape)
    for turn, future in enumerate(members, start=2):
        square += in_rsw(fly(turn, with_outlooks(model, future), 1.0) - predicted, predicted)[:, :3] ** 2
    found = np.hstack([drag, np.sqrt(square / max(1, len(members)))])
    return pairs[["i", "j"]].assign(**dict(zip(SPREAD, found.T, strict=True)))


def _past_cd(estimates: pd.DataFrame, rso: Rso) -> pd.Series:
    """Mean of the past Cd at each estimate, by its track."""
    past = past_cd(estimates, apriori=rso.cd, memory_days=_MEMORY_DAYS)
    return pd.Series(past["mean"].to_numpy(), index=estimates["track"])
