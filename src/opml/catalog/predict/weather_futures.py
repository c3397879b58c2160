"""Predictions under many futures of the space weather: a distribution where no single forecast is good.

Each future is propagated from an estimate of its own, drawn from the fit's covariance, as far as fits
scatter. So the sample has the uncertainty of the weather, which lasts, and that of the fit, which counts in
the first hours, or where measurements are poor.
"""

import numpy as np
import pandas as pd

from opml.base.constants import DAY
from opml.base.seeds import derive
from opml.catalog.predict.fit_scatter import excess
from opml.catalog.propagator import Propagator
from opml.dynamics.forces import with_outlooks
from opml.orbits.elements import in_rsw
from opml.tables import PARAMETER_COVARIANCES, PARAMETERS, STATE, symmetric_matrices


def sample(
    propagator: Propagator,
    futures: pd.DataFrame,
    estimates: pd.DataFrame,
    predictions: pd.DataFrame,
    *,
    window: float,
    seed: int,
) -> pd.DataFrame:
    """Return the `ensemble` table: each pair of `predictions` under each of the `futures`.

    futures: the table, whose newest issue at t_i holds for an arc
    estimates: what the predictions start from
    window: of the estimates [s]
    seed: of the estimates' draws

    Where a prediction or a member has no numbers, the difference has none.
    """
    known = estimates.assign(excess=excess(estimates, window=window))
    started = known.set_index("track").loc[np.unique(predictions["i"])]
    formal = symmetric_matrices(started, PARAMETER_COVARIANCES)
    covariance = formal * started["excess"].to_numpy()[:, None, None]
    mean, root = started[PARAMETERS].to_numpy(), square_root(covariance)
    predicted = predictions[STATE].to_numpy()
    parts = []
    members = futures.groupby("member")
    for turn, (member, future) in enumerate(members):
        random = derive(seed, "ensembles", propagator.rso.name, str(member))
        drawn = mean + np.einsum("nij,nj->ni", root, random.normal(size=mean.shape))
        ahead = propagator.under(with_outlooks(propagator.model, future)).part(turn, len(members))
        states, _ = ahead.propagate_pairs(predictions, drawn[:, :6], cd=drawn[:, 6])
        shift = in_rsw(states - predicted, predicted)[:, :3]
        parts.append(
            predictions[["i", "j"]].assign(member=member, d_x=shift[:, 0], d_y=shift[:, 1], d_z=shift[:, 2])
        )
    return pd.concat(parts, ignore_index=True)


def square_root(covariance: np.ndarray) -> np.ndarray:
    """Return roots R (n, k, k) with R R' the covariances (n, k, k); 0 where these are not finite.

    R is the deviations times the symmetric root of the correlations, which is unique. Rounding may have left
    an eigenvalue of the correlations below 0.
    """
    known = np.isfinite(covariance).all(axis=(1, 2))
    sigma = np.sqrt(np.where(known[:, None], np.diagonal(covariance, axis1=1, axis2=2), 0.0))
    both = sigma[:, :, None] * sigma[:, None, :]
    correlation = np.divide(covariance, both, out=np.zeros_like(both), where=both > 0.0)
    values, vectors = np.linalg.eigh(correlation)
    stretched = vectors * np.sqrt(np.maximum(values, 0.0))[:, None, :]
    return sigma[:, :, None] * (stretched @ vectors.transpose(0, 2, 1))


def fan(ensemble: pd.DataFrame, predictions: pd.DataFrame, *, level: float) -> pd.DataFrame:
    """Return the `fan` table: along-track errors of each prediction by the futures, beside the true error.

    Were a future the true weather, the prediction would err by -d_y. level: the share from `low` to `high`.
    """
    count = ensemble["member"].nunique()
    errors = -ensemble["d_y"].to_numpy().reshape(count, -1)
    true = predictions["e_y"].to_numpy()
    low, median, high = band(errors, level)
    return pd.DataFrame(
        {
            "i": predictions["i"].to_numpy(),
            "j": predictions["j"].to_numpy(),
            "duration": (predictions["t_j"] - predictions["t_i"]).to_numpy(),
            "e_y": true,
            "mean": errors.mean(axis=0),
            "sigma": errors.std(axis=0, ddof=1),
            "low": low,
            "median": median,
            "high": high,
            "crps": crps(errors, true),
        }
    )


def band(members: np.ndarray, level: float) -> np.ndarray:
    """Return lower end, median and upper end, (3, n), of the share `level` of samples (members, n).

    The truth is one more draw: of m members, the k-th lies above it with the probability k / (m + 1).
    """
    shares = [0.5 - 0.5 * level, 0.5, 0.5 + 0.5 * level]
    return np.quantile(members, shares, axis=0, method="weibull")


def scores(fans: pd.DataFrame) -> pd.DataFrame:
    """Return the `scores` table: how good the fans are, by days of duration.

    Rows without numbers are left out.
    """
    finite = fans[np.isfinite(fans["e_y"]) & np.isfinite(fans["crps"])]
    inside = finite["e_y"].between(finite["low"], finite["high"])
    columns = {
        "day": np.ceil(finite["duration"] / DAY).astype(int),
        "inside": inside.astype(float),
        "width": finite["high"] - finite["low"],
        "crps": finite["crps"],
        "error": finite["e_y"].abs(),
    }
    days = pd.DataFrame(columns).groupby("day")
    return days.mean().assign(rows=days.size()).reset_index()


def crps(members: np.ndarray, true: np.ndarray) -> np.ndarray:
    """Return the continuous ranked probability score (n,) of samples (members, n) for a truth (n,).

    It is the mean distance to the truth less half the mean distance between members (Gneiting & Raftery 2007,
    eq. 21), which is a sum over the ordered members, (2 k - m - 1) x_k / m^2. The score of one member is its
    absolute error.
    """
    count = len(members)
    rank = 2.0 * np.arange(1, count + 1) - count - 1.0
    spread = rank @ np.sort(members, axis=0) / count**2
    return np.abs(members - true).mean(axis=0) - spread
