"""Predictions under many futures of the space weather: a distribution where no single forecast is good.

Each future is flown from an estimate of its own, drawn from the fit's covariance, as far as fits scatter. So
the sample has the uncertainty of the weather, which lasts, and that of the fit, which counts in the first
hours, or where measurements are poor.
"""

from collections.abc import Callable

import numpy as np
import pandas as pd

from opml.base.constants import DAY
from opml.base.seeds import derive
from opml.catalog.fit.estimation import COVARIANCES
from opml.catalog.fit.scatter import excess
from opml.catalog.flight import fly_pairs, part_of
from opml.dynamics.ensemble import Integrator
from opml.dynamics.forces import with_outlooks
from opml.dynamics.kernels.surroundings import ForceModel
from opml.orbits.elements import in_rsw
from opml.orbits.sheets import Rso
from opml.tables import PARAMETERS, STATE, symmetric_matrices


def sample(
    model: ForceModel,
    futures: pd.DataFrame,
    estimates: pd.DataFrame,
    predictions: pd.DataFrame,
    rso: Rso,
    *,
    window: float,
    seed: int,
    integrator: Integrator,
    threads: int = 1,
    progress: Callable[[float], None] | None = None,
) -> pd.DataFrame:
    """The `ensemble` table: each pair of `predictions` under each of the `futures`.

    model: the assumed one; futures: the table, whose newest issue at t_i holds for an arc; estimates: those
    that the predictions start from, over a `window` [s]; seed: of the estimates' draws. Where a prediction or
    a member has no numbers, the difference has none.
    """
    known = estimates.assign(excess=excess(estimates, window=window))
    started = known.set_index("track").loc[np.unique(predictions["i"])]
    covariance = symmetric_matrices(started, COVARIANCES) * started["excess"].to_numpy()[:, None, None]
    mean, root = started[PARAMETERS].to_numpy(), square_root(covariance)
    predicted = predictions[STATE].to_numpy()
    parts = []
    members = futures.groupby("member")
    for turn, (member, future) in enumerate(members):
        random = derive(seed, "ensembles", rso.name, str(member))
        drawn = mean + np.einsum("nij,nj->ni", root, random.normal(size=mean.shape))
        states, _ = fly_pairs(
            with_outlooks(model, future),
            rso,
            predictions,
            drawn[:, :6],
            cd=drawn[:, 6],
            integrator=integrator,
            threads=threads,
            progress=part_of(progress, turn, len(members)),
        )
        shift = in_rsw(states - predicted, predicted)[:, :3]
        parts.append(
            predictions[["i", "j"]].assign(member=member, d_x=shift[:, 0], d_y=shift[:, 1], d_z=shift[:, 2])
        )
    return pd.concat(parts, ignore_index=True)


def square_root(covariance: np.ndarray) -> np.ndarray:
    """Roots R (n, k, k) with R R' the covariances (n, k, k); 0 where these are not finite.

    R is the deviations times the symmetric root of the correlations, which is the only one; of the latter's
    eigenvalues rounding may have left one below 0.
    """
    known = np.isfinite(covariance).all(axis=(1, 2))
    sigma = np.sqrt(np.where(known[:, None], np.diagonal(covariance, axis1=1, axis2=2), 0.0))
    both = sigma[:, :, None] * sigma[:, None, :]
    correlation = np.divide(covariance, both, out=np.zeros_like(both), where=both > 0.0)
    values, vectors = np.linalg.eigh(correlation)
    stretched = vectors * np.sqrt(np.maximum(values, 0.0))[:, None, :]
    root: np.ndarray = sigma[:, :, None] * (stretched @ vectors.transpose(0, 2, 1))
    return root


def fan(ensemble: pd.DataFrame, predictions: pd.DataFrame, *, level: float) -> pd.DataFrame:
    """The `fan` table: what the futures say of the along-track error of each prediction, beside what it was.

    Were a future the true one, the prediction would err by -d_y. level: the share from `low` to `high`.
    """
    count = ensemble["member"].nunique()
    said = -ensemble["d_y"].to_numpy().reshape(count, -1)
    error = predictions["e_y"].to_numpy()
    low, median, high = band(said, level)
    return pd.DataFrame(
        {
            "i": predictions["i"].to_numpy(),
            "j": predictions["j"].to_numpy(),
            "duration": (predictions["t_j"] - predictions["t_i"]).to_numpy(),
            "e_y": error,
            "mean": said.mean(axis=0),
            "sigma": said.std(axis=0, ddof=1),
            "low": low,
            "median": median,
            "high": high,
            "crps": crps(said, error),
        }
    )


def band(members: np.ndarray, level: float) -> np.ndarray:
    """Lower end, median and upper end, (3, n), of the share `level` of samples (members, n).

    The truth is one more draw: of m members, the k-th lies above it with the probability k / (m + 1).
    """
    shares = [0.5 - 0.5 * level, 0.5, 0.5 + 0.5 * level]
    found: np.ndarray = np.quantile(members, shares, axis=0, method="weibull")
    return found


def scores(fans: pd.DataFrame) -> pd.DataFrame:
    """The `scores` table: how good the fans are, by days of duration; rows without numbers are left out."""
    told = fans[np.isfinite(fans["e_y"]) & np.isfinite(fans["crps"])]
    inside = told["e_y"].between(told["low"], told["high"])
    columns = {
        "day": np.ceil(told["duration"] / DAY).astype(int),
        "inside": inside.astype(float),
        "width": told["high"] - told["low"],
        "crps": told["crps"],
        "error": told["e_y"].abs(),
    }
    days = pd.DataFrame(columns).groupby("day")
    found: pd.DataFrame = days.mean().assign(rows=days.size()).reset_index()
    return found


def crps(members: np.ndarray, true: np.ndarray) -> np.ndarray:
    """Continuous ranked probability score (n,) of samples (members, n); of one member, its absolute error.

    Mean distance to the truth less half that between members (Gneiting & Raftery 2007, eq. 21), the latter
    from the ordered members: sum over k of (2 k - m - 1) x_k / m^2.
    """
    count = len(members)
    rank = 2.0 * np.arange(1, count + 1) - count - 1.0
    spread = rank @ np.sort(members, axis=0) / count**2
    found: np.ndarray = np.abs(members - true).mean(axis=0) - spread
    return found
