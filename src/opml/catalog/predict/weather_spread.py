"""Effect of drag and of the weather ahead on predictions: the `spread` table.

From each estimate arcs are propagated with a tenth more drag, and under many futures of the space weather.
What parts them from the prediction is known at t_i. Drag alone parts them, so the Earth's flattening is all
the gravity they need; and their Cd is the mean of its past, as one short fit may say nothing about it.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
import pandas as pd

from opml.catalog.predict.other_windows import past_cd
from opml.catalog.propagator import Propagator
from opml.dynamics.forces import joined, with_outlooks
from opml.dynamics.kernels.surroundings import ForceModel
from opml.dynamics.settings import ForceModelSettings
from opml.orbits.elements import rsw_rotation
from opml.tables import SPREAD, STATE

FLATTENED = ForceModelSettings(degree=2, order=0, third_bodies=[])
"""Settings of the force model that the arcs are propagated with."""

LONGEST_STEP = 600.0  # longest step of their integration [s]: differences of arcs need no more
TOLERANCE = 10.0  # least tolerance of such a step [m]: distances err by 0.0003 in a week at 300 km
TENTH = 0.1  # part of the drag that the columns `drag_*` are the effect of

_MEMORY_DAYS = 30.0


@dataclass(frozen=True)
class Weathers:
    """The weather that is expected, and its futures, in one force model."""

    model: ForceModel  # its outlooks are the expected ones, and behind these each future's
    issued: Sequence[np.ndarray]  # of each weather, when its outlooks were issued [s], ascending

    @classmethod
    def of(cls, model: ForceModel, futures: pd.DataFrame | None) -> Self:
        """Return the weather of a model with its futures, a table; None where it is taken for known."""
        members = [] if futures is None else [future for _, future in futures.groupby("member")]
        models = [model, *(with_outlooks(model, future) for future in members)]
        return cls(joined(models), [one.issued for one in models])

    def outlooks(self, t: np.ndarray) -> np.ndarray:
        """Return the outlook of each weather that is the newest at times t (n,) [s]: (weathers, n)."""
        begins = np.cumsum([0, *(len(issued) for issued in self.issued[:-1])])
        newest = np.array([np.searchsorted(issued, t, side="right") - 1 for issued in self.issued])
        return np.where(newest < 0, -1, newest + begins[:, None])


def build(
    propagator: Propagator, estimates: pd.DataFrame, pairs: pd.DataFrame, *, weathers: Weathers
) -> pd.DataFrame:
    """Return the `spread` table, one row per pair: distances [m] in RSW of the prediction, never negative.

    propagator: under the assumed model, `FLATTENED`
    pairs: i, j, t_i and t_j in the order of i
    weathers: of the propagator's model

    drag_* is the distance of an arc with a TENTH more drag, weather_* the root mean square of the futures', 0
    without any. Not finite where an arc does not reach.
    """
    started = estimates.set_index("track").loc[np.unique(pairs["i"])]
    cd = mean_cd(estimates, propagator.rso.cd).loc[started.index].to_numpy()
    tolerance = max(propagator.integrator.position_tolerance_m, TOLERANCE)
    integrator = propagator.integrator.evolve(max_step_s=LONGEST_STEP, position_tolerance_m=tolerance)
    coarse = replace(propagator.under(weathers.model), integrator=integrator)
    # First the prediction, then more drag, then the futures, all side by side.
    expected, *futures = weathers.outlooks(started["t"].to_numpy())
    outlook = np.array([expected, expected, *futures])
    drag = np.ones(len(outlook))
    drag[1] += TENTH
    propagated, _ = coarse.propagate_pairs(
        pairs,
        np.tile(started[STATE].to_numpy(), (len(outlook), 1)),
        cd=np.outer(drag, cd).ravel(),
        outlook=outlook.ravel(),
    )
    predicted, *others = propagated.reshape(len(outlook), len(pairs), len(STATE))
    away = np.array(others)[:, :, :3] - predicted[:, :3]
    more, *ahead = np.einsum("nij,knj->kni", rsw_rotation(predicted), away)
    square = np.sum([shift**2 for shift in ahead], axis=0) if ahead else np.zeros(more.shape)
    distances = np.hstack([np.abs(more), np.sqrt(square / max(1, len(ahead)))])
    return pairs[["i", "j"]].assign(**dict(zip(SPREAD, distances.T, strict=True)))


def mean_cd(estimates: pd.DataFrame, apriori: float) -> pd.Series:
    """Return the mean of the past Cd at each estimate, by its track; apriori: of the sheet."""
    past = past_cd(estimates, apriori=apriori, memory_days=_MEMORY_DAYS)
    return pd.Series(past, index=estimates["track"])
