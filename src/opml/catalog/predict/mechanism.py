"""What a catalogue knows of why a prediction errs. None of it needs the truth.

Sensitivities to Cd; a longer arc of the same tracks, which has the better semi-major axis and Cd, so that the
difference of the two predictions shows most of the short arc's error; and the drift by resonant harmonics
that the assumed model leaves out.
"""

from collections.abc import Sequence

import numpy as np
import pandas as pd

from opml.catalog.predict import resonance
from opml.catalog.predict.sensitivity import running_mean, usable
from opml.orbits.elements import in_rsw
from opml.tables import STATE


def build(
    estimates: pd.DataFrame,
    predictions: pd.DataFrame,
    sensitivities: pd.DataFrame,
    *,
    long_estimates: pd.DataFrame,
    long_predictions: pd.DataFrame,
    long_sensitivities: pd.DataFrame,
    bounds: tuple[float, float] | None,
    resonances: Sequence[tuple[int, int]],
    long_window_hours: float,
    gm: float,
) -> pd.DataFrame:
    """The `mechanism` table: one row per pair of `predictions`, in their order.

    The `long_` tables are of the same tracks, estimated with a longer window. l_* is the predicted state less
    that from the long arc, in RSW of the predicted state [m, m/s]; d_cd_long is the long arc's Cd less the
    running mean of all long arcs' so far. Where the long arc did not converge, has its Cd outside `bounds`
    (if any are given) or does not reach t_j, the short one stands for it: l_* is 0, and v_long_*, cd_long its
    own. The columns of `resonances`, pairs (k, m), are those of `resonance.drifts` for arcs of
    long_window_hours; gm [m3/s2].
    """
    pairs = pd.MultiIndex.from_frame(predictions[["i", "j"]])
    own = estimates.set_index("track").loc[predictions["i"]]
    table = sensitivities.set_index(["i", "j"]).loc[pairs].assign(cd=own["cd"].to_numpy())
    d_cd = table["cd"] - table["cd_mean"]

    ends = _ends(long_estimates, bounds).reindex(predictions["i"])
    predicted = predictions[STATE].to_numpy()
    arrived = long_predictions.set_index(["i", "j"])[STATE].reindex(pairs).to_numpy()
    gap = in_rsw(predicted - arrived, predicted)
    answers = long_sensitivities.set_index(["i", "j"]).reindex(pairs)
    reached = np.isfinite(gap).all(axis=1) & np.isfinite(answers["v_y"].to_numpy())
    long = ends["usable"].eq(True).to_numpy() & reached

    table["cd_long"] = np.where(long, ends["cd"], table["cd"])
    table["d_cd_long"] = np.where(long, ends["cd"] - ends["mean"], d_cd)
    for k, axis in enumerate(STATE):
        table[f"l_{axis}"] = np.where(long, gap[:, k], 0.0)
        table[f"v_long_{axis}"] = np.where(long, answers[f"v_{axis}"], table[f"v_{axis}"])
    drifts = resonance.drifts(estimates, predictions, pairs=resonances, window_hours=long_window_hours, gm=gm)
    return table.reset_index().join(drifts.reset_index(drop=True))


def _ends(estimates: pd.DataFrame, bounds: tuple[float, float] | None) -> pd.DataFrame:
    """The estimates by track, with the running mean of their Cd and whether they are usable."""
    found = estimates.assign(mean=running_mean(estimates, bounds), usable=usable(estimates, bounds))
    return found.set_index("track")
