"""Alternatives that need no truth: fits over another window, and the mean of their Cd.

All of it comes from estimates that are over at t_i and from the assumed model.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd

from opml.base.constants import DAY, HOUR
from opml.catalog.associate.innovations import CD_SPREAD
from opml.catalog.fit.apriori import APRIORI_SIGMA
from opml.catalog.predict.neighbours import propagate_neighbours
from opml.catalog.predict.sensitivity import CD_NUDGE, shift_with_cd
from opml.catalog.propagator import Propagator
from opml.orbits.elements import in_rsw
from opml.orbits.manoeuvres import Manoeuvre, read_manoeuvres, when_burns_are_known
from opml.tables import STATE, read_table

_KEYS = ["i", "j"]  # of pairs


def exclude_burns(estimates: pd.DataFrame, *, manoeuvres: Sequence[Manoeuvre], window: float) -> pd.DataFrame:
    """Return the estimates, of which those with a manoeuvre in their window count as not converged.

    manoeuvres: of which those count that were known at an estimate
    window: of the fits [s]

    `burn_known` is when such a manoeuvre became known [s], infinite without one: from then on no mean has it.
    """
    t = estimates["t"].to_numpy()
    known = when_burns_are_known(t - window, t, manoeuvres)
    return estimates.assign(converged=estimates["converged"] & (known > t), burn_known=known)


def read_estimates(files: Any, *, window_hours: float) -> pd.DataFrame:
    """Return the `arc_estimates` of a job, which are over another window [h], with `exclude_burns`.

    files: the job's input, with the table whose metadata hold the manoeuvres. Raises InputError where a table
    is missing or damaged.
    """
    return exclude_burns(
        read_table(files.arc_estimates, "estimates"),
        manoeuvres=read_manoeuvres(files.manoeuvres),
        window=HOUR * window_hours,
    )


def build_arcs(
    propagator: Propagator,
    predictions: pd.DataFrame,
    *,
    arc_estimates: pd.DataFrame,
    arc_predictions: pd.DataFrame,
) -> pd.DataFrame:
    """Return the `arcs` table of `arcs_table`, whose neighbours are propagated here."""
    larger = perturbed_predictions(propagator, arc_estimates, arc_predictions)
    apriori = propagator.rso.cd
    return arcs_table(predictions, arc_predictions, larger, arc_estimates=arc_estimates, apriori=apriori)


def arcs_table(
    predictions: pd.DataFrame,
    arc_predictions: pd.DataFrame,
    larger: pd.DataFrame,
    *,
    arc_estimates: pd.DataFrame,
    apriori: float,
) -> pd.DataFrame:
    """Return the `arcs` table: one row per pair of `predictions`, in their order.

    arc_predictions: of the same tracks, estimated over another window, or over the same
    larger: the same arcs with a larger Cd, from `perturbed`
    arc_estimates: the estimates over that window
    apriori: Cd of the sheet

    In RSW of the predicted state [m, m/s]: l_arc_* is the prediction less that of the arc; v_arc_* how the
    arc's prediction answers to its Cd along the fit's covariance. Where the arc did not converge or does not
    reach t_j, it says nothing: l and v are 0, cd_arc is that of the sheet.
    """
    predicted = predictions[STATE].to_numpy()
    arc, perturbed = (_at_pairs(states, predictions) for states in (arc_predictions, larger))
    differences = {"l_arc": predicted - arc, "v_arc": (perturbed - arc) / CD_NUDGE}
    at = _estimate_of(predictions, arc_estimates)
    usable = _usable(at, arc_estimates, differences)
    cd = np.where(usable, arc_estimates["cd"].to_numpy()[at], apriori)
    return _of_pairs(predictions, {"cd_arc": cd} | _turned(differences, predicted, usable))


def arc_departures(
    predictions: pd.DataFrame, *, arc_estimates: pd.DataFrame, arc_predictions: pd.DataFrame
) -> pd.DataFrame:
    """Return i, j and the columns l_arc_* of the table `arcs`; arguments as of `build_arcs`."""
    predicted = predictions[STATE].to_numpy()
    differences = {"l_arc": predicted - _at_pairs(arc_predictions, predictions)}
    usable = _usable(_estimate_of(predictions, arc_estimates), arc_estimates, differences)
    return _of_pairs(predictions, _turned(differences, predicted, usable))


def build_past(
    predictions: pd.DataFrame, *, arc_estimates: pd.DataFrame, apriori: float, memory_days: float
) -> pd.DataFrame:
    """Return the `cd_past` table: `past_cd` at t_i of each pair of `predictions`.

    arc_estimates: of the same tracks, estimated over another window, or over the same
    apriori, memory_days: as for `past_cd`
    """
    past = past_cd(arc_estimates, apriori=apriori, memory_days=memory_days)
    return _of_pairs(predictions, {"cd_past": past[_estimate_of(predictions, arc_estimates)]})


def perturbed_predictions(
    propagator: Propagator, estimates: pd.DataFrame, predictions: pd.DataFrame
) -> pd.DataFrame:
    """Return predictions of estimates over another window, propagated from `perturbed` of these."""
    first = np.searchsorted(estimates["track"], np.unique(predictions["i"]))
    started = estimates.iloc[first]
    departing = perturbed(started)
    states, cd = departing[STATE].to_numpy(), departing["cd"].to_numpy()
    [propagated] = propagate_neighbours(propagator, predictions, started, states, cd)
    # Differences are taken of columns of tables, as sums of another layout in memory round differently.
    return _of_pairs(predictions, dict(zip(STATE, propagated.T, strict=True)))


def perturbed(estimates: pd.DataFrame) -> pd.DataFrame:
    """Return estimates with Cd larger by CD_NUDGE and the states that go with it."""
    moved = estimates[STATE].to_numpy() + CD_NUDGE * shift_with_cd(estimates)
    return estimates.assign(**dict(zip(STATE, moved.T, strict=True)), cd=estimates["cd"] + CD_NUDGE)


def _of_pairs(predictions: pd.DataFrame, columns: Mapping[str, np.ndarray]) -> pd.DataFrame:
    """Return a table of i and j of pairs, and of further columns (n,)."""
    return pd.DataFrame({key: predictions[key] for key in _KEYS} | dict(columns), index=predictions.index)


def _at_pairs(states: pd.DataFrame, predictions: pd.DataFrame) -> np.ndarray:
    """Return the states (n, 6) of a table at the pairs of predictions, NaN where it has none."""
    if all(np.array_equal(states[key].to_numpy(), predictions[key].to_numpy()) for key in _KEYS):
        return states[STATE].to_numpy()
    pairs = pd.MultiIndex.from_frame(predictions[_KEYS])
    return states.set_index(_KEYS)[STATE].reindex(pairs).to_numpy()


def _estimate_of(predictions: pd.DataFrame, estimates: pd.DataFrame) -> np.ndarray:
    """Return the row (n,) of the estimate that each pair starts from; tracks of estimates ascend.

    Raises KeyError where one has none.
    """
    tracks, wanted = estimates["track"].to_numpy(), predictions["i"].to_numpy()
    rows = np.searchsorted(tracks, wanted)
    if not np.array_equal(tracks.take(rows, mode="clip"), wanted):
        raise KeyError("tracks without an estimate")
    return rows


def _usable(at: np.ndarray, estimates: pd.DataFrame, differences: Mapping[str, np.ndarray]) -> np.ndarray:
    """Return which pairs (n,) tell something: their estimate, in row `at`, converged, and all are numbers."""
    reached = np.isfinite(np.concatenate(list(differences.values()), axis=1)).all(axis=1)
    return estimates["converged"].to_numpy(bool)[at] & reached


def _turned(
    differences: Mapping[str, np.ndarray], predicted: np.ndarray, usable: np.ndarray
) -> dict[str, np.ndarray]:
    """Return the columns of differences (n, 6) by their names, in RSW of the predicted states (n, 6)."""
    columns: dict[str, np.ndarray] = {}
    for name, difference in differences.items():
        turned = np.where(usable[:, None], in_rsw(difference, predicted), 0.0)
        columns |= {f"{name}_{axis}": turned[:, k] for k, axis in enumerate(STATE)}
    return columns


def past_cd(estimates: pd.DataFrame, *, apriori: float, memory_days: float) -> np.ndarray:
    """Return the mean (n,) of Cd as it is known at each estimate, by its own fit and all before.

    Each estimate that converged counts by 1 / (its formal variance + spread^2), fading by e in memory_days,
    until a burn in its window is known, where burns are excluded. `apriori`, the value of the sheet, counts
    as an estimate with a deviation of APRIORI_SIGMA of itself. So a fit that says nothing about Cd moves
    nothing, and of many good fits none counts alone. The spread is CD_SPREAD of the mean before each
    estimate, which is the sheet's value until there is a past.
    """
    t, formal = estimates["t"].to_numpy(), estimates["cov_cd_cd"].to_numpy()
    trusted = estimates["converged"].to_numpy() & (formal > 0.0)
    values = np.where(trusted, estimates["cd"].to_numpy(), 0.0)
    age = (t[:, None] - t[None, :]) / (memory_days * DAY)
    counts = trusted & (age >= 0.0)
    if "burn_known" in estimates:
        counts &= t[:, None] < estimates["burn_known"].to_numpy()
    fading = np.where(counts, np.exp(-np.maximum(age, 0.0)), 0.0)
    apriori_weight = (APRIORI_SIGMA * apriori) ** -2.0

    def mean(fading: np.ndarray, spread: np.ndarray) -> np.ndarray:
        weights = fading / (np.where(trusted, formal, 0.0) + np.square(spread)[:, None])
        return np.asarray(
            (weights @ values + apriori_weight * apriori) / (weights.sum(axis=1) + apriori_weight)
        )

    # With the spread of the sheet's Cd the mean is near enough to take the spread of.
    before = mean(np.tril(fading, -1), np.full(len(t), CD_SPREAD * apriori))
    return mean(fading, CD_SPREAD * before)
