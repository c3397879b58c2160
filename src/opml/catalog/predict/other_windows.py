"""What a catalogue can do without a truth: fits over another window, and Cd held by its own past.

All of it comes from estimates that are over at t_i and from the assumed model.
"""

from collections.abc import Callable, Sequence

import numpy as np
import pandas as pd

from opml.base.constants import DAY
from opml.catalog.flight import fly_pairs, part_of
from opml.catalog.predict.sensitivity import shift_with_cd
from opml.dynamics.ensemble import Integrator
from opml.dynamics.kernels.surroundings import ForceModel
from opml.orbits.elements import in_rsw
from opml.orbits.manoeuvres import contain_any
from opml.orbits.sheets import Rso
from opml.tables import STATE

_NUDGE = 0.01
"""Change of Cd between neighbouring arcs: small against Cd, large against rounding."""

SPREAD = 0.1
"""How much the Cd of a body varies as a model feels it, beside the fits' noise, as a part of it.

Models of the thermosphere err by 10 to 15 % (Emmert 2015, Thermospheric mass density: A review, sec. 5).
"""

APRIORI_SIGMA = 0.5
"""Uncertainty of the sheet's Cd, as a part of it."""


def build(
    model: ForceModel,
    predictions: pd.DataFrame,
    rso: Rso,
    *,
    arc_estimates: pd.DataFrame,
    arc_predictions: pd.DataFrame,
    memory_days: float,
    integrator: Integrator,
    manoeuvres: Sequence[float] = (),
    window: float = 0.0,
    threads: int = 1,
    progress: Callable[[float], None] | None = None,
) -> pd.DataFrame:
    """The `arcs` table: one row per pair of `predictions`, in their order.

    The `arc_` tables are of the same tracks, estimated over another window, or the same. In RSW of the
    predicted state [m, m/s]: l_arc_*: the prediction less that of the arc; v_arc_*: how the arc's prediction
    answers to its Cd along the fit's covariance; h_arc_*: the prediction less that of the arc with its Cd
    held by its past. cd_past is the mean of the arcs' Cd up to t_i, see `past_cd`. Where the arc did not
    converge, does not reach t_j or has one of the `manoeuvres` (times [s]) within the `window` [s] before
    t_i, it says nothing: l, v and h are 0.
    """
    t = arc_estimates["t"].to_numpy()
    disturbed = contain_any(t - window, t, manoeuvres)
    arc_estimates = arc_estimates.assign(converged=arc_estimates["converged"] & ~disturbed)
    own = arc_predictions.set_index(["i", "j"])
    pairs = pd.MultiIndex.from_frame(predictions[["i", "j"]])
    predicted = predictions[STATE].to_numpy()
    converged = arc_estimates["converged"].to_numpy()
    past = past_cd(arc_estimates, apriori=rso.cd, memory_days=memory_days)
    flown = _flown(model, arc_estimates, arc_predictions, rso, past, integrator, threads, progress)
    arc = own[STATE].reindex(pairs).to_numpy()
    found = {
        "l_arc": predicted - arc,
        "v_arc": (flown["v"].reindex(pairs).to_numpy() - arc) / _NUDGE,
        "h_arc": predicted - flown["h"].reindex(pairs).to_numpy(),
    }
    usable = pd.Series(converged, index=arc_estimates["track"]).reindex(predictions["i"]).to_numpy()
    usable = usable & np.isfinite(np.concatenate(list(found.values()), axis=1)).all(axis=1)
    of_arc = arc_estimates.assign(cd_past=past["mean"]).set_index("track").reindex(predictions["i"])
    table = {
        "i": predictions["i"].to_numpy(),
        "j": predictions["j"].to_numpy(),
        "cd_arc": np.where(usable, of_arc["cd"], of_arc["cd_past"]),
        "cd_past": of_arc["cd_past"].to_numpy(),
    }
    for name, difference in found.items():
        turned = np.where(usable[:, None], in_rsw(difference, predicted), 0.0)
        table |= {f"{name}_{axis}": turned[:, k] for k, axis in enumerate(STATE)}
    return pd.DataFrame(table)


def _flown(
    model: ForceModel,
    estimates: pd.DataFrame,
    predictions: pd.DataFrame,
    rso: Rso,
    past: pd.DataFrame,
    integrator: Integrator,
    threads: int,
    progress: Callable[[float], None] | None,
) -> dict[str, pd.DataFrame]:
    """States of the neighbouring arcs at the pairs of the arcs' predictions: Cd nudged (v), Cd held (h)."""
    first = np.searchsorted(estimates["track"], np.unique(predictions["i"]))
    started, before = estimates.iloc[first], past.iloc[first]
    moves = {"v": np.full(len(first), _NUDGE), "h": held_cd(started, before) - started["cd"].to_numpy()}
    found = {}
    for turn, (name, move) in enumerate(moves.items()):
        states, _ = fly_pairs(
            model,
            rso,
            predictions,
            started[STATE].to_numpy() + move[:, None] * shift_with_cd(started),
            cd=started["cd"].to_numpy() + move,
            integrator=integrator,
            threads=threads,
            progress=part_of(progress, turn, len(moves)),
        )
        found[name] = pd.DataFrame(
            states, columns=STATE, index=pd.MultiIndex.from_frame(predictions[["i", "j"]])
        )
    return found


def past_cd(estimates: pd.DataFrame, *, apriori: float, memory_days: float) -> pd.DataFrame:
    """What is known of Cd at each estimate: `mean` with its own, `prior` and `variance` without.

    Each estimate that converged counts by 1 / (its formal variance + SPREAD^2), fading by e in memory_days;
    `apriori`, the value of the sheet, counts as one with the variance APRIORI_SIGMA^2. So a fit that tells
    nothing of Cd moves nothing, and of many good ones none counts alone.
    """
    t, own = estimates["t"].to_numpy(), estimates["cov_cd_cd"].to_numpy()
    trusted = estimates["converged"].to_numpy() & (own > 0.0)
    values = np.where(trusted, estimates["cd"].to_numpy(), 0.0)
    age = (t[:, None] - t[None, :]) / (memory_days * DAY)
    fading = np.where(trusted & (age >= 0.0), np.exp(-np.maximum(age, 0.0)), 0.0)
    weight = fading / (np.where(trusted, own, 0.0) + (SPREAD * apriori) ** 2)
    earlier, apriori_weight = np.tril(weight, -1), (APRIORI_SIGMA * apriori) ** -2.0
    mean, prior = (
        (one @ values + apriori_weight * apriori) / (one.sum(axis=1) + apriori_weight)
        for one in (weight, earlier)
    )
    variance = (SPREAD * apriori) ** 2 + 1.0 / (earlier.sum(axis=1) + apriori_weight)
    return pd.DataFrame({"mean": mean, "prior": prior, "variance": variance})


def held_cd(estimates: pd.DataFrame, past: pd.DataFrame) -> np.ndarray:
    """Cd (n,) of fits that know its past: the mean of their own and the prior, weighted by 1/variance.

    For a linear fit it is what an a-priori value of Cd with that variance gives.
    """
    cd, own = estimates["cd"].to_numpy(), estimates["cov_cd_cd"].to_numpy()
    prior, variance = past["prior"].to_numpy(), past["variance"].to_numpy()
    held: np.ndarray = (cd * variance + prior * own) / (variance + own)
    return held
