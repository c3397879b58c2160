"""What a morning issues: the model that left the least so far, its ephemeris with the sizes of its errors.

The row of the model that is selected is of the table `issued`. The ephemeris is the path of that model, with
covariances, on a message's epochs.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.base.progress import counted
from opml.learning.data.splits import are_over
from opml.learning.judge.error_sizes import LEAST_ROWS, Sizes
from opml.learning.judge.model_choice import best_model
from opml.orbits.manoeuvres import Manoeuvre
from opml.tables import SIGMA_STATE, SIZES

_GROUPS = {"constant": "xyz", "rate": "xyz", "drag": "xyz", "velocity": "xyz", "inflation": "01234"}
_TIMES = ("days", "reach")


@dataclass(frozen=True)
class SelectedModel:
    """The model that is selected."""

    model: str
    past: pd.DataFrame  # rows of `judged` of its ephemerides of earlier mornings
    sizes: Sizes


def choose_model(judged: pd.DataFrame, models: Sequence[str], *, now: float) -> SelectedModel:
    """Return the model that left the least by `now` [s]; raise InputError where the past is too short.

    judged: rows of that table of all mornings
    """
    past = judged[judged["model"].isin(models) & are_over(judged, now)]
    if past.empty:
        raise InputError("no ephemeris of an earlier morning was judged yet")
    over = past["model"].value_counts()
    if (most := over.max()) < LEAST_ROWS:
        judged_so_far = f"judged so far: {counted(most, 'prediction')}"
        raise InputError(f"{judged_so_far}, fewer than the {LEAST_ROWS} needed for sizes of errors")
    # A model that is new in the menu waits for a past of its own.
    judged_often = [name for name in models if over.get(name, 0) >= LEAST_ROWS]
    model = best_model(past, judged_often, now=now)
    own = judged[judged["model"] == model].drop(columns="model")
    return SelectedModel(model, own, Sizes.learned(own, now=now))


def basis(past: pd.DataFrame, now: float) -> str:
    """Return what covariances as of `now` [s] rest on, in words; past: rows of `judged`."""
    past = past[are_over(past, now)]
    mornings, longest = past["morning"].nunique(), past["duration"].max() / DAY
    return (
        f"covariances from {len(past)} predictions of {mornings} mornings that were over by "
        f"day {now / DAY:g}, up to {longest:.1f} days long"
    )


def row(
    now: float,
    start: pd.DataFrame,
    selected: SelectedModel | None,
    verdict: str,
    *,
    burn: Manoeuvre | None = None,
) -> pd.DataFrame:
    """Return the row of a morning whose ephemerides start from an estimate; no model without a past.

    burn: that the morning found
    """
    begin = {"i": int(start["track"].iloc[0]), "t_i": float(start["t"].iloc[0])}
    what = {"model": selected.model if selected else "", "verdict": verdict}
    sizes = _columns(selected.sizes) if selected else dict.fromkeys([*SIZES, *_TIMES], np.nan)
    found = {"burn_t": burn.t if burn else np.nan}
    return pd.DataFrame([{"morning": now, **begin, **what, **found, **sizes}])


def no_start() -> pd.DataFrame:
    """Return what stands in the place of an estimate that a morning's ephemerides start from."""
    return pd.DataFrame({"track": [-1], "t": [np.nan]})


def with_sigmas(judged: pd.DataFrame, issued: pd.DataFrame) -> pd.DataFrame:
    """Return rows of `judged` with the standard deviations that were stated of the selected models."""
    sigmas = judged[SIGMA_STATE].to_numpy(copy=True)
    selected = issued[(issued["model"] != "") & issued["morning"].isin(judged["morning"])]
    for row in selected.to_dict("records"):
        rows = ((judged["model"] == row["model"]) & (judged["morning"] == row["morning"])).to_numpy()
        sigmas[rows] = _sizes(row).sigmas(judged[rows])
    return judged.assign(**dict(zip(SIGMA_STATE, sigmas.T, strict=True)))


def _columns(sizes: Sizes) -> dict[str, float]:
    values = {
        f"{group}_{part}": float(value)
        for group, parts in _GROUPS.items()
        for part, value in zip(parts, getattr(sizes, group), strict=True)
    }
    return values | {name: getattr(sizes, name) for name in _TIMES}


def _sizes(row: Mapping[str, Any]) -> Sizes:
    values: dict[str, Any] = {
        group: np.array([row[f"{group}_{part}"] for part in parts]) for group, parts in _GROUPS.items()
    }
    return Sizes(**values, **{name: row[name] for name in _TIMES})


def epochs(paths: pd.DataFrame, step: float) -> np.ndarray:
    """Return the multiples (n,) of a step [s] along the ephemerides of a morning, a table `paths`."""
    t = paths["t_j"].to_numpy()
    at: np.ndarray = np.arange(np.ceil(t[0] / step), np.floor(t[-1] / step) + 1.0) * step
    return at


def next_to_whole_days(at: np.ndarray, begin: float) -> np.ndarray:
    """Return of epochs (n,) the ends, and those next to whole days after `begin` [s]."""
    after = np.searchsorted(at, np.arange(begin, at[-1] + DAY, DAY))
    return at[np.unique(np.clip([after - 1, after], 0, len(at) - 1))]
