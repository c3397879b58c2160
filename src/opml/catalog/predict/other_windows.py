"""What a catalogue can do without a truth: fits over another window, and Cd held by its own past.

All of it comes from estimates that are over at t_i and from the assumed model.
"""

from collections.abc import Iterator, Sequence

import numpy as np
import pandas as pd

from opml.base.constants import DAY
from opml.catalog.flight import Flight
from opml.catalog.predict.neighbours import Neighbours
from opml.catalog.predict.sensitivity import CD_NUDGE, shift_with_cd
from opml.orbits.elements import in_rsw
from opml.orbits.manoeuvres import contain_any
from opml.tables import STATE

CD_SPREAD = 0.1
"""How much the Cd of a body varies as a model feels it, beside the fits' noise, as a part of it.

Models of the thermosphere err by 10 to 15 % (Emmert 2015, Thermospheric mass density: A review, sec. 5).
"""

APRIORI_SIGMA = 0.5
"""Uncertainty of the sheet's Cd, as a part of it."""


def undisturbed(estimates: pd.DataFrame, *, manoeuvres: Sequence[float], window: float) -> pd.DataFrame:
    """Return the estimates, of which those with a manoeuvre in their window count as not converged.

    manoeuvres: times [s]
    window: of the fits [s]
    """
    t = estimates["t"].to_numpy()
    disturbed = contain_any(t - window, t, manoeuvres)
    return estimates.assign(converged=estimates["converged"] & ~disturbed)


def build(
    flight: Flight,
    predictions: pd.DataFrame,
    *,
    arc_estimates: pd.DataFrame,
    arc_predictions: pd.DataFrame,
    memory_days: float,
) -> pd.DataFrame:
    """Return the `arcs` table: one row per pair of `predictions`, in their order.

    flight: under the assumed model
    arc_estimates, arc_predictions: of the same tracks, estimated over another window, or over the same
    memory_days: of the arcs' Cd, see `past_cd`

    In RSW of the predicted state [m, m/s]: l_arc_* is the prediction less that of the arc; v_arc_* how the
    arc's prediction answers to its Cd along the fit's covariance; h_arc_* the prediction less that of the arc
    with its Cd held by its past. cd_past is the mean of the arcs' Cd up to t_i. Where the arc did not
    converge or does not reach t_j, it tells nothing: l, v and h are 0.
    """
    pairs = pd.MultiIndex.from_frame(predictions[["i", "j"]])
    past = past_cd(arc_estimates, apriori=flight.rso.cd, memory_days=memory_days)
    estimates = arc_estimates.assign(cd_past=past["mean"].to_numpy())
    estimates = estimates.set_index("track").reindex(predictions["i"])
    predicted = predictions[STATE].to_numpy()
    arc = arc_predictions.set_index(["i", "j"])[STATE].reindex(pairs).to_numpy()
    neighbours = _neighbours(flight, arc_estimates, arc_predictions, past)
    nudged, held = (states.reindex(pairs).to_numpy() for states in neighbours)
    differences = {"l_arc": predicted - arc, "v_arc": (nudged - arc) / CD_NUDGE, "h_arc": predicted - held}

    reached = np.isfinite(np.concatenate(list(differences.values()), axis=1)).all(axis=1)
    usable = estimates["converged"].to_numpy() & reached
    table = {
        "i": predictions["i"].to_numpy(),
        "j": predictions["j"].to_numpy(),
        "cd_arc": np.where(usable, estimates["cd"], estimates["cd_past"]),
        "cd_past": estimates["cd_past"].to_numpy(),
    }
    for name, difference in differences.items():
        turned = np.where(usable[:, None], in_rsw(difference, predicted), 0.0)
        table |= {f"{name}_{axis}": turned[:, k] for k, axis in enumerate(STATE)}
    return pd.DataFrame(table)


def _neighbours(
    flight: Flight, estimates: pd.DataFrame, predictions: pd.DataFrame, past: pd.DataFrame
) -> Iterator[pd.DataFrame]:
    """Yield the states at the pairs of the arcs' predictions: with Cd nudged, then with Cd held."""
    first = np.searchsorted(estimates["track"], np.unique(predictions["i"]))
    started, before = estimates.iloc[first], past.iloc[first]
    pairs = pd.MultiIndex.from_frame(predictions[["i", "j"]])
    states, cd = started[STATE].to_numpy(), started["cd"].to_numpy()
    shift, held = shift_with_cd(started), held_cd(started, before) - cd
    neighbours = Neighbours.beside(flight, predictions, started).part(0, 2)
    yield pd.DataFrame(neighbours.fly(states + CD_NUDGE * shift, cd + CD_NUDGE), columns=STATE, index=pairs)
    # Cd as held may be far from the estimate's own, so these arcs need the whole field.
    moved = states + held[:, None] * shift
    flown, _ = flight.part(1, 2).fly_pairs(predictions, moved, cd=cd + held)
    yield pd.DataFrame(flown, columns=STATE, index=pairs)


def past_cd(estimates: pd.DataFrame, *, apriori: float, memory_days: float) -> pd.DataFrame:
    """Return what is known of Cd at each estimate: `mean` with its own Cd, `prior` and `variance` without.

    Each estimate that converged counts by 1 / (its formal variance + SPREAD^2), fading by e in memory_days;
    `apriori`, the value of the sheet, counts as an estimate with the variance APRIORI_SIGMA^2. So a fit that
    tells nothing of Cd moves nothing, and of many good fits none counts alone.
    """
    t, formal = estimates["t"].to_numpy(), estimates["cov_cd_cd"].to_numpy()
    trusted = estimates["converged"].to_numpy() & (formal > 0.0)
    values = np.where(trusted, estimates["cd"].to_numpy(), 0.0)
    age = (t[:, None] - t[None, :]) / (memory_days * DAY)
    fading = np.where(trusted & (age >= 0.0), np.exp(-np.maximum(age, 0.0)), 0.0)
    weight = fading / (np.where(trusted, formal, 0.0) + (CD_SPREAD * apriori) ** 2)
    earlier, apriori_weight = np.tril(weight, -1), (APRIORI_SIGMA * apriori) ** -2.0
    mean, prior = (
        (weights @ values + apriori_weight * apriori) / (weights.sum(axis=1) + apriori_weight)
        for weights in (weight, earlier)
    )
    variance = (CD_SPREAD * apriori) ** 2 + 1.0 / (earlier.sum(axis=1) + apriori_weight)
    return pd.DataFrame({"mean": mean, "prior": prior, "variance": variance})


def held_cd(estimates: pd.DataFrame, past: pd.DataFrame) -> np.ndarray:
    """Return Cd (n,) of fits that know its past: mean of their own Cd and the prior, weighted by 1/variance.

    For a linear fit it is what an a-priori value of Cd with that variance gives.
    """
    cd, formal = estimates["cd"].to_numpy(), estimates["cov_cd_cd"].to_numpy()
    prior, variance = past["prior"].to_numpy(), past["variance"].to_numpy()
    held: np.ndarray = (cd * variance + prior * formal) / (variance + formal)
    return held
