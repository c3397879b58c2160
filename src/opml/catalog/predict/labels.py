"""Labels from later estimates: what a catalogue without a truth holds its predictions against.

The prediction from t_i to t_j is compared with the estimate at t_j, which is known when its track is over.
"""

import numpy as np
import pandas as pd

from opml.orbits.elements import in_rsw, rsw_rotation
from opml.tables import COMPONENTS, PARAMETER_COVARIANCES, SCHEMAS, SIGMAS, STATE, symmetric_matrices

NO_LATER_ESTIMATE = "later estimate"  # what a label's reason begins with; the reason of the fit follows


def build(predictions: pd.DataFrame, estimates: pd.DataFrame, tracking: pd.DataFrame) -> pd.DataFrame:
    """Return the `labels` table: one row per pair of `predictions`, in their order.

    estimates: of the tracks that are predicted to
    tracking: that table, or `fixes` in its place

    The error is the predicted state less the estimate, in RSW of the estimate [m, m/s], with the formal
    uncertainty of the estimate in that frame. A pair without a prediction or without an estimate that
    converged has the reason.
    """
    failed = estimates["reason"].to_numpy() != ""  # states of failed fits may be no orbits at all
    fitted = estimates.assign(**{name: estimates[name].mask(failed) for name in STATE})
    at_end = with_sigmas(fitted).assign(t_known=_known_at(estimates, tracking))
    later = at_end.set_index("track").reindex(predictions["j"]).reset_index(drop=True)
    error = in_rsw(predictions[STATE].to_numpy() - later[STATE].to_numpy(), later[STATE].to_numpy())
    table = later.assign(
        i=predictions["i"].to_numpy(),
        j=predictions["j"].to_numpy(),
        **dict(zip(COMPONENTS, error.T, strict=True)),
    )
    unpredicted = predictions["reason"].to_numpy()
    reason = later["reason"].fillna("none")
    unfitted = np.where(reason == "", "", f"{NO_LATER_ESTIMATE}: " + reason)
    table["reason"] = np.where(unpredicted != "", unpredicted, unfitted)
    table.loc[table["reason"] != "", [*COMPONENTS, *SIGMAS]] = np.nan
    return table[SCHEMAS["labels"].names]


def _known_at(estimates: pd.DataFrame, tracking: pd.DataFrame) -> np.ndarray:
    """Return when each estimate (n,) is known [s]: when its track is over, or made."""
    tracks = tracking.groupby("track")["t"].agg(at="min", known="max")
    newest = np.searchsorted(tracks["at"], estimates["t"].to_numpy(), side="right") - 1
    return np.asarray(tracks["known"].to_numpy()[newest])


def with_sigmas(estimates: pd.DataFrame) -> pd.DataFrame:
    """Return the estimates with their formal standard deviations in RSW [m, m/s]."""
    rotation = rsw_rotation(estimates[STATE].to_numpy())
    covariance = symmetric_matrices(estimates, PARAMETER_COVARIANCES)
    deviations = [
        np.sqrt(np.einsum("nij,njk,nik->ni", rotation, covariance[:, part, part], rotation))
        for part in (slice(0, 3), slice(3, 6))
    ]
    return estimates.assign(**dict(zip(SIGMAS, np.hstack(deviations).T, strict=True)))
