"""Ephemeris that a morning issues: of the model that left the least so far, with the sizes of its errors.

The row of the model that is selected is of the table `issued`. The ephemeris is the path of that model, with
covariances, on a message's epochs.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd

from opml.base.constants import DAY
from opml.base.progress import counted
from opml.ephemerides.fit_sizes import VAGUE, FitSizes
from opml.learning.data.splits import are_over
from opml.learning.judge.model_choice import best_model
from opml.learning.models.contract import ResolvedSettings
from opml.orbits.manoeuvres import Manoeuvre
from opml.tables import SIGMA_STATE, SIZES

LEAST_ROWS = 20  # judged predictions of a model that choose it
USUAL = "typical errors of such fits: their own covariance, density, and the weather ahead"


@dataclass(frozen=True)
class SelectedModel:
    """The model that is selected."""

    model: str
    past: pd.DataFrame  # rows of `judged` of its ephemerides of earlier mornings, known by now
    sizes: FitSizes

    @property
    def basis(self) -> str:
        """Evidence behind covariances, in words."""
        if self.past.empty:
            return f"from {USUAL}"
        mornings, longest = self.past["morning"].nunique(), self.past["duration"].max() / DAY
        judged = f"{counted(len(self.past), 'prediction')} on {counted(mornings, 'morning')}"
        return f"from {judged} before, up to {longest:.1f} days long, and {USUAL}"


def select(
    judged: pd.DataFrame,
    models: Mapping[str, ResolvedSettings],
    formal: pd.Series,
    past_formal: pd.DataFrame,
    *,
    now: float,
) -> SelectedModel:
    """Return the model that left the least by `now` [s], with the sizes of its errors.

    judged: rows of that table of all mornings
    formal: errors of the ephemeris, of `fit_sizes.formal_errors`
    past_formal: those of the ephemerides that were judged, by the track that they start from

    Where the past is too short, it is a fit's own Cd, or the mean of the past where the fit hardly knows it.
    """
    past = judged[judged["model"].isin([*models]) & are_over(judged, now)]
    over = past["model"].value_counts()
    if often := [name for name in models if over.get(name, 0) >= LEAST_ROWS]:
        model = best_model(past, often, now=now)
    else:
        is_vague = bool(formal["c"] >= VAGUE)
        model = next((name for name in models if holds_cd(models[name]) == is_vague), next(iter(models)))
    own = past[past["model"] == model].drop(columns="model")
    return SelectedModel(model, own, FitSizes.learned(formal, own, past_formal))


def holds_cd(model: ResolvedSettings) -> bool:
    """Return whether a model's drag is the mean of its past."""
    return "cd_past" in model.variables


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
    sizes = selected.sizes.row if selected else dict.fromkeys(SIZES, np.nan)
    burned = {"burn_t": burn.t if burn else np.nan}
    return pd.DataFrame([{"morning": now, **begin, **what, **burned, **sizes}])


def no_start() -> pd.DataFrame:
    """Return what stands in the place of an estimate that a morning's ephemerides start from."""
    return pd.DataFrame({"track": [-1], "t": [np.nan]})


def with_sigmas(judged: pd.DataFrame, issued: pd.DataFrame) -> pd.DataFrame:
    """Return rows of `judged` with the standard deviations that were stated of the selected models."""
    sigmas = judged[SIGMA_STATE].to_numpy(copy=True)
    selected = issued[(issued["model"] != "") & issued["morning"].isin(judged["morning"])]
    for row in selected.to_dict("records"):
        rows = ((judged["model"] == row["model"]) & (judged["morning"] == row["morning"])).to_numpy()
        sigmas[rows] = FitSizes.from_row(row).sigmas(judged[rows])
    return judged.assign(**dict(zip(SIGMA_STATE, sigmas.T, strict=True)))


def epochs(paths: pd.DataFrame, step: float) -> np.ndarray:
    """Return the multiples (n,) of a step [s] along the ephemerides of a morning, a table `paths`."""
    t = paths["t_j"].to_numpy()
    return np.arange(np.ceil(t[0] / step), np.floor(t[-1] / step) + 1.0) * step
