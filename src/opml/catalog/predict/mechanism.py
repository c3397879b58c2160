"""Causes of a prediction's error, as far as a catalogue knows them. None of it needs the truth.

Sensitivities to Cd; a longer arc of the same tracks, which has the better semi-major axis and Cd, so that the
difference of the two predictions shows most of the short arc's error; and the drift by resonant harmonics
that the assumed model leaves out.
"""

from dataclasses import dataclass

import numpy as np
import pandas as pd

from opml.catalog.predict.resonance import Resonances, drifts
from opml.orbits.elements import in_rsw
from opml.tables import STATE


@dataclass(frozen=True)
class FittedArcs:
    """Arcs fitted over one window: the estimates, their predictions, and how these answer to Cd (tables)."""

    estimates: pd.DataFrame
    predictions: pd.DataFrame
    sensitivities: pd.DataFrame


def build(
    short: FittedArcs, long: FittedArcs, *, bounds: tuple[float, float] | None, resonances: Resonances
) -> pd.DataFrame:
    """Return the `mechanism` table: one row per pair of the short arcs' predictions, in their order.

    long: of the same tracks, estimated with a longer window
    bounds: on Cd, None for any
    resonances: met by the long arcs; their columns are those of `resonance.drifts`

    l_* is the predicted state less that from the long arc, in RSW of the predicted state [m, m/s]. Where the
    long arc did not converge, has its Cd outside `bounds` or does not reach t_j, the short arc stands for it:
    l_* is 0, and v_long_*, cd_long are the short arc's.
    """
    predictions = short.predictions
    pairs = pd.MultiIndex.from_frame(predictions[["i", "j"]])
    cd = short.estimates.set_index("track").loc[predictions["i"], "cd"].to_numpy()
    table = short.sensitivities.set_index(["i", "j"]).loc[pairs].assign(cd=cd)
    ends = long.estimates.assign(usable=usable(long.estimates, bounds))
    ends = ends.set_index("track").reindex(predictions["i"])
    predicted = predictions[STATE].to_numpy()
    arrived = long.predictions.set_index(["i", "j"])[STATE].reindex(pairs).to_numpy()
    gap = in_rsw(predicted - arrived, predicted)
    answers = long.sensitivities.set_index(["i", "j"]).reindex(pairs)
    reached = np.isfinite(gap).all(axis=1) & np.isfinite(answers["v_y"].to_numpy())
    is_known = ends["usable"].eq(True).to_numpy() & reached

    table["cd_long"] = np.where(is_known, ends["cd"], table["cd"])
    for k, axis in enumerate(STATE):
        table[f"l_{axis}"] = np.where(is_known, gap[:, k], 0.0)
        table[f"v_long_{axis}"] = np.where(is_known, answers[f"v_{axis}"], table[f"v_{axis}"])
    drift = drifts(short.estimates, predictions, resonances)
    return table.reset_index().join(drift.reset_index(drop=True))


def usable(estimates: pd.DataFrame, bounds: tuple[float, float] | None) -> np.ndarray:
    """Return which estimates (n,) converged with their Cd within `bounds`, None for any Cd."""
    low, high = bounds or (-np.inf, np.inf)
    return np.asarray(estimates["converged"] & estimates["cd"].between(low, high))
