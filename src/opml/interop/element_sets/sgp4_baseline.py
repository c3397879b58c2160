"""SGP4 from the newest set of mean elements, compared with predictions: what everybody has, as a baseline."""

import numpy as np
import pandas as pd

from opml.interop.element_sets.histories import states_of
from opml.orbits.elements import in_rsw
from opml.tables import IMPROVED_MODELS, STATE


def build(predictions: pd.DataFrame, sets: pd.DataFrame, *, epoch: str, name: str = "sgp4") -> pd.DataFrame:
    """Return a table such as `sgp4`: one row per pair of `predictions`, in their order.

    sets: table `element_sets` of one object
    name: of what SGP4 propagates, the prefix of the columns

    SGP4 propagates the set with the newest epoch up to t_i. An estimate is at the epoch of a set and made of
    it, so both are known at the same time. Columns are the prediction less SGP4's, in RSW of the predicted
    state
    [m, m/s], NaN where there is no such set or SGP4 fails.
    """
    predicted = np.ascontiguousarray(predictions[STATE])
    propagated = np.full_like(predicted, np.nan)
    newest = np.searchsorted(sets["t"].to_numpy(), predictions["t_i"].to_numpy(), side="right") - 1
    for row in np.unique(newest[newest >= 0]):
        pairs = np.flatnonzero(newest == row)
        propagated[pairs] = states_of(sets.iloc[row], epoch=epoch, t=predictions["t_j"].to_numpy()[pairs])
    differences = in_rsw(predicted - propagated, predicted)
    names = [f"{name}_{axis}" for axis in STATE]
    return predictions[["i", "j"]].assign(**dict(zip(names, differences.T, strict=True)))


def build_improved(predictions: pd.DataFrame, history: pd.DataFrame, *, epoch: str) -> pd.DataFrame:
    """Return the `improved` table, as `build` does for each model; history: table `improved_history`."""
    tables = [
        build(predictions, history[history["model"] == name], epoch=epoch, name=name)
        for name in IMPROVED_MODELS
    ]
    return pd.concat([tables[0], *(table.drop(columns=["i", "j"]) for table in tables[1:])], axis=1)
