"""The dataset that captures the orbit prediction error model: learning variables and targets of every pair.

A pair (i, j) is the prediction from the estimate at t_i to a later track start t_j. Its learning variables,
except the duration, belong to t_i alone, so they are computed once per estimate. Its errors are the true
errors, or labels from later estimates, which count from the time when they are known.

Source: the paper, section 'Dataset Capturing the Orbit Prediction Error Model'.
"""

from collections.abc import Iterable, Sequence
from os import PathLike

import numpy as np
import pandas as pd

from opml.base.errors import InputError
from opml.learning.data.cleaning import OUTSIDE_FENCES, Cleaning, tukey_fences
from opml.learning.data.splits import in_days, known_at
from opml.orbits.elements import coe_from_cartesian, in_rsw, wrap_half_turn
from opml.orbits.manoeuvres import Manoeuvre, contain_any
from opml.tables import COMPONENTS, SCHEMAS, STATE, mechanism_schema, read_kind, read_metadata, read_table

COE = ["a", "e", "inc", "argp", "raan", "nu"]
COE_DIFFERENCE = ["d_a", "d_e", "d_i", "d_argp", "d_raan", "d_nu"]
RSW_DIFFERENCE = ["eps_x", "eps_y", "eps_z", "eps_vx", "eps_vy", "eps_vz"]
MEASUREMENT = ["elevation_max", "azimuth_at_max", "range_at_max"]

NO_PREVIOUS = -1  # in column b: no earlier estimate qualifies

# Why a row is dropped: the first reason that holds, in this order. A failed prediction adds its own reason.
CROSSES_MANOEUVRE = "crosses a manoeuvre"
FIT_NOT_CONVERGED = "estimate not converged"
NO_PREDICTION = "no prediction"
CD_OUTSIDE = "drag coefficient outside bounds"
NO_PREVIOUS_ESTIMATE = "no kept previous estimate"
NO_RELATIVE_ERROR = "no prediction from previous estimate"
NO_TRUE_STATE = "no true state"
NO_NUMBERS = "no numbers in another table"
NO_LABEL = "no label"


def build(
    estimates: pd.DataFrame,
    predictions: pd.DataFrame,
    tracking: pd.DataFrame,
    *,
    gm: float,
    cleaning: Cleaning,
    manoeuvres: Sequence[Manoeuvre] = (),
    window: float = 0.0,
    labels: pd.DataFrame | None = None,
) -> pd.DataFrame:
    """Build the `dataset` table: one row per pair of `predictions`, in the order of (i, j), none removed.

    estimates, predictions, tracking: those tables (SI units, radians, GCRF); `fixes` may stand for tracking
    gm: for the orbital elements [m3/s2]
    window: how long before an estimate its oldest measurement may be [s]
    labels: that table, whose errors replace those of the predictions; the table is `labelled` then

    Learning variables are NaN where they do not exist, as those of stations for fixes. With `kept_estimate`
    as `cleaning.previous`, t_b is the time of the last earlier estimate that converged with Cd inside the
    bounds. With `track` it is the time of the track just before, if its estimate did so.

    A row without a true error, or without a label, is dropped for that reason unless another holds first. A
    row is dropped where a manoeuvre lies between the oldest measurement of its earlier estimate and t_i and
    was known at t_i, or lies from there to the time when its error is known and was known by then; likewise a
    burn that the estimates show. Tukey's fences come from rows with t_j in fence_days that survive all else,
    and hold for every row.

    Raises InputError where the tables do not belong together.
    """
    at_estimate = of_estimates(estimates, predictions, tracking, gm=gm, cleaning=cleaning)
    pairs = predictions.sort_values(["i", "j"], ignore_index=True)
    pairs = pairs.rename(columns={"reason": "prediction_reason"}).drop(columns=STATE)
    rows = _with_labels(pairs, labels).join(at_estimate, on="i")
    rows["duration"] = rows["t_j"] - rows["t_i"]
    rows["reason"] = _reasons(rows, cleaning)
    begin = rows[["t_b", "t_i"]].min(axis=1).to_numpy()
    t_i, end = rows["t_i"].to_numpy(), rows["t_known"].to_numpy()
    known = _and_shown(manoeuvres, estimates)
    crosses = contain_any(begin, t_i, known, window=window) | contain_any(t_i, end, known)
    rows.loc[crosses, "reason"] = CROSSES_MANOEUVRE
    rows["keep"] = rows["reason"] == ""
    return rows[SCHEMAS["dataset" if labels is None else "labelled"].names]


def read(path: str | PathLike[str], others: Iterable[str | PathLike[str]] = ()) -> pd.DataFrame:
    """Read a dataset, and the columns of tables of the same pairs.

    others: files of those tables

    Raises InputError where a file is missing or damaged, or tables do not belong together.
    """
    dataset = read_table(path, "labelled" if read_kind(path) == "labelled" else "dataset")
    for other in others:
        kind = read_kind(other)
        if kind == "mechanism":
            schema = mechanism_schema(read_metadata(other)["resonances"])
        else:
            schema = SCHEMAS[kind]
        dataset = join_table(dataset, read_table(other, schema))
    return dataset


def join_table(dataset: pd.DataFrame, other: pd.DataFrame) -> pd.DataFrame:
    """Return the dataset and the columns of a table of the same pairs.

    A row without numbers in the other table (a neighbour of its arc decayed) is dropped for that reason, if
    it was kept or dropped by the fences alone. Raises InputError for a row that the other table lacks.
    """
    pairs = pd.MultiIndex.from_frame(dataset[["i", "j"]])
    known = other.set_index(["i", "j"])
    missing = ~pairs.isin(known.index)
    if missing.any():
        i, j = pairs[missing.argmax()]
        raise InputError(f"pairs: i, j: expected every pair of the dataset, got none of {i}, {j}")
    joined = dataset.join(known.loc[pairs].reset_index(drop=True).set_axis(dataset.index))
    lost = joined["reason"].isin(["", OUTSIDE_FENCES]) & joined[known.columns].isna().any(axis=1)
    return joined.assign(keep=joined["keep"] & ~lost, reason=joined["reason"].mask(lost, NO_NUMBERS))


def _with_labels(pairs: pd.DataFrame, labels: pd.DataFrame | None) -> pd.DataFrame:
    """Return pairs with their errors, true or labels, when these are known, and why a label is missing."""
    if labels is None:
        return pairs.assign(t_known=pairs["t_j"], label_reason="")
    errors = labels.rename(columns={"reason": "label_reason"})
    return pairs.drop(columns=list(COMPONENTS)).merge(errors, on=["i", "j"], validate="one_to_one")


def of_estimates(
    estimates: pd.DataFrame,
    predictions: pd.DataFrame,
    tracking: pd.DataFrame,
    *,
    gm: float,
    cleaning: Cleaning,
) -> pd.DataFrame:
    """Return what belongs to t_i: learning variables, b, t_b, gap and flags of the estimate, by track.

    estimates, predictions, tracking, gm: as for `build`; only the states from t_b to t_i of predictions count

    Raises InputError where the tables do not belong together.
    """
    estimates = estimates.sort_values("track").set_index("track")
    if unknown := set(predictions["i"]) - set(estimates.index):
        raise InputError(f"predictions: i: expected tracks that have an estimate, got {min(unknown)}")

    inside = cleaning.keeps(estimates["cd"].to_numpy())
    converged = estimates["converged"].to_numpy(dtype=bool)
    table = pd.DataFrame({"converged": converged, "cd_inside": inside}, index=estimates.index)
    table["b"] = _previous(estimates.index.to_numpy(), converged & inside, cleaning.previous)

    # The state of a failed fit may be no orbit at all, so it gives no learning variables.
    states = np.where(converged[:, None], estimates[STATE].to_numpy(), np.nan)
    previous = estimates[["t", "cd"]].reindex(table["b"])
    table["t_b"] = previous["t"].to_numpy()
    table["gap"] = estimates["t"] - table["t_b"]
    table["cd_b"] = previous["cd"].to_numpy()
    table["d_cd"] = table["cd_b"] - estimates["cd"].where(converged)

    coe = coe_from_cartesian(states, gm)
    pairs = pd.MultiIndex.from_arrays([table["b"], table.index])
    arrivals = predictions[predictions["reason"] == ""].set_index(["i", "j"])[STATE]
    predicted = arrivals.reindex(pairs).to_numpy(dtype=float)  # NaN without a prediction from t_b to t_i
    difference = coe_from_cartesian(predicted, gm) - coe
    difference[:, 2:] = wrap_half_turn(difference[:, 2:])
    relative = in_rsw(predicted - states, states)
    table[COE], table[COE_DIFFERENCE], table[RSW_DIFFERENCE] = coe, difference, relative
    return table.join(_highest_measurements(tracking, table.index))


def may_depart(
    estimates: pd.DataFrame,
    at_estimate: pd.DataFrame,
    *,
    manoeuvres: Sequence[Manoeuvre] = (),
    window: float = 0.0,
) -> np.ndarray:
    """Return the estimates (bool, n) whose predictions a model may correct, as `build` would keep their rows.

    at_estimate: from `of_estimates`
    manoeuvres: of those known at t_i none may lie from `window` [s] before t_b up to t_i
    """
    known = at_estimate.loc[estimates["track"]]
    t = estimates["t"].to_numpy()
    whole = known["converged"] & known["cd_inside"] & known["eps_y"].notna()
    begin = np.fmin(known["t_b"].to_numpy(), t)
    crosses = contain_any(begin, t, _and_shown(manoeuvres, estimates), window=window)
    return whole.to_numpy() & ~crosses


def _and_shown(manoeuvres: Sequence[Manoeuvre], estimates: pd.DataFrame) -> list[Manoeuvre]:
    """Return manoeuvres and the burns that `estimates` show, which count from their detection."""
    shown = estimates[estimates["burn_t"].notna()] if "burn_t" in estimates else estimates.iloc[:0]
    return [*manoeuvres, *(Manoeuvre(row["burn_t"], row["t"], restarts=True) for _, row in shown.iterrows())]


def _previous(tracks: np.ndarray, usable: np.ndarray, setting: str) -> np.ndarray:
    """Return the track of t_b of each estimate, or NO_PREVIOUS.

    tracks: (n,) ascending
    usable: (n,) whether an estimate qualifies for t_b
    """
    position = np.arange(len(tracks))
    if setting == "kept_estimate":
        last_usable = np.maximum.accumulate(np.where(usable, position, -1))
    else:
        last_usable = np.where(usable, position, -1)
    before = np.concatenate([[-1], last_usable[:-1]])
    return np.where(before >= 0, tracks[before], NO_PREVIOUS)


def _highest_measurements(tracking: pd.DataFrame, tracks: pd.Index) -> pd.DataFrame:
    """Return the measurement with the highest elevation of each track, by any radar; NaN without one."""
    if missing := set(tracks) - set(tracking["track"]):
        raise InputError(
            f"tracking: track: expected measurements of every estimated track, got none of {min(missing)}"
        )
    by_radars = tracking.reindex(columns=["track", "elevation", "azimuth", "range"]).dropna()
    highest = by_radars.loc[by_radars.groupby("track")["elevation"].idxmax()].set_index("track")
    return highest.set_axis(MEASUREMENT, axis=1).reindex(tracks)


def _reasons(rows: pd.DataFrame, cleaning: Cleaning) -> pd.Series:
    failed = rows["prediction_reason"]
    reason = pd.Series("", index=rows.index, dtype="str")
    # From the last reason to the first, so that the first overwrites.
    reason[rows["e_y"].isna()] = NO_TRUE_STATE
    reason[rows["label_reason"] != ""] = NO_LABEL + ": " + rows["label_reason"]
    reason[rows["eps_y"].isna()] = NO_RELATIVE_ERROR
    reason[rows["b"] == NO_PREVIOUS] = NO_PREVIOUS_ESTIMATE
    reason[~rows["cd_inside"]] = CD_OUTSIDE
    reason[failed != ""] = NO_PREDICTION + ": " + failed
    reason[~rows["converged"]] = FIT_NOT_CONVERGED

    reason[_outside_fences(rows, (reason == "").to_numpy(), cleaning)] = OUTSIDE_FENCES
    return reason


def _outside_fences(rows: pd.DataFrame, kept: np.ndarray, cleaning: Cleaning) -> np.ndarray:
    if cleaning.fence is None or not kept.any():
        return np.zeros(len(rows), dtype=bool)
    days, e_y = cleaning.fence_days, rows["e_y"].to_numpy()
    within = kept if days is None else kept & in_days(known_at(rows), days)
    lower, upper = tukey_fences(e_y[within], fence=cleaning.fence)
    return kept & ((e_y < lower) | (e_y > upper))
