"""Sizes of errors of an object's improved set: by the corrector, and by the object's own past.

Along the track the sigma is the corrector's, times how far the object's own past left it, and larger after a
geomagnetic storm; radially and across it is measured on that past. A short past counts against what is usual
at that height.
"""

import math
from dataclasses import dataclass

import numpy as np
import pandas as pd

from opml.base import epochs
from opml.element_sets import corrector, density, set_errors
from opml.element_sets.catalogue import ElementCatalogue
from opml.element_sets.improve import Improved
from opml.element_sets.inside.inside_sizes import lower
from opml.environment import nrlmsis
from opml.environment.space_weather import INTERVALS
from opml.interop.element_sets import sgp4_errors
from opml.interop.predicted_orbit import LEADS

MORNINGS = 12  # mornings before the date whose predictions tell an object's own sizes, radial and cross-track

ALONG_MORNINGS = 20
"""Mornings before the date whose predictions tell an object's own sigma along the track: more would hide a
burn, or a month of storms."""

USUAL = 8.0  # predictions that err as the corrector says that an object's own count against

USUAL_SIZES = 2.0
"""Errors of the usual size that an object's own count against, axis by axis and lead by lead."""

FEWEST = 4
"""Least number of an object's own predictions where nothing is usual: eccentric, deep space, below 300 km."""

STORM = 80.0
"""Daily mean ap from which on storms of the last days more than double the variance along the track.

Of what improved sets left of 749 objects on 523 mornings of 2022-23 and 2025, intervals of 90 % held 93 %
after days up to an ap of 50, and 83 % above; with this 93 and 92 %.
"""

STORM_DAYS = 3  # days before the date whose storms count
FEW_JUDGED = f"fewer than {FEWEST} of its predictions have a later set to judge them"
_GROSS = 4.0  # sigmas that a past error counts at most: some are burns


@dataclass(frozen=True, eq=False)
class ExpectedErrors:
    """The errors that are expected of a prediction from element sets, whatever orbit it is.

    sizes: by lead [d] r, s, w, standard deviations of the prediction, and sgp4, that of the published set
    along the track [m]; past: the judged predictions that tell them; basis: what they rest on, in words
    """

    sizes: pd.DataFrame
    past: pd.DataFrame
    basis: str


def of_object(
    own: ElementCatalogue, how: pd.Series, better: Improved, *, storm: float, is_burning: bool
) -> ExpectedErrors:
    """Return the expected errors of an object's improved set.

    own: its sets; how: its row of the table `improved_sets` of `better`
    storm: of `after_storm`; is_burning: whether it burned lately, or thrusts
    """
    today = epochs.mjd(better.date)
    errors = set_errors.in_rsw(own, today - np.arange(MORNINGS, 0, -1), LEADS)
    past = better.past[
        (better.past["number"] == how["number"]) & (better.past["morning"] >= today - ALONG_MORNINGS)
    ]
    past = past.reset_index(drop=True)
    if past.empty:
        past = errors[["morning", "lead"]].assign(error=errors["s"], left=errors["s"], sigma=np.nan)
    published = own.satellites[-1]
    sigmas = sgp4_errors.usual_sigmas(published, how["age"] + np.array(LEADS, float))
    usual = pd.DataFrame(sigmas, columns=list(sgp4_errors.AXES), index=list(LEADS))
    is_corrected = bool(np.isfinite(how[f"sigma_{LEADS[-1]}d"]))
    if len(errors) >= FEWEST or is_corrected:
        measured = _measured(errors, usual)
        basis = (
            f"from {len(past)} predictions on {past['morning'].nunique()} mornings of the object, compared "
            f"with later sets; radial and cross-track from at most {MORNINGS} mornings. Typical errors of "
            "objects of that height count as eight more predictions, and errors common to all sets are added"
        )
    elif sgp4_errors.are_known(published):
        measured = usual
        basis = f"typical errors of sets at its height, kind and age: its past is short: {FEW_JUDGED}"
    else:
        measured = usual * np.nan
        few = f"errors of such orbits were not learned, and its past is short: {FEW_JUDGED}"
        basis = f"no covariance: {few}"
    sizes = _sizes(how, past, measured, storm, is_corrected=is_corrected)
    if is_burning:  # along the track at least what the past missed, burns and all
        missed = past["left"].abs().groupby(past["lead"]).quantile(corrector.LEVEL) / corrector.NORMAL
        least = missed.reindex(sizes.index, fill_value=0.0).cummax()
        sizes = sizes.assign(**{name: np.maximum(sizes[name], least) for name in ("s", "sgp4")})
    return ExpectedErrors(sizes, past, basis)


def after_storm(kp: np.ndarray, height: float) -> float:
    """Return by how much errors along the track are larger after the last days' geomagnetic activity.

    kp: three-hourly, up to the date
    height: of the object [m]; above the tables of densities drag is too small
    """
    if height > density.HEIGHTS[-1]:
        return 1.0
    ap = nrlmsis.ap_of_kp(kp[-INTERVALS * STORM_DAYS :]).reshape(STORM_DAYS, INTERVALS).mean(axis=1)
    return math.hypot(1.0, ap.max() / STORM)


def _sizes(
    how: pd.Series, past: pd.DataFrame, measured: pd.DataFrame, storm: float, *, is_corrected: bool
) -> pd.DataFrame:
    """Return the sizes of errors by lead; measured: of `_measured`, or the usual ones."""
    sizes = measured.copy()
    sizes["sgp4"] = sizes["s"]
    if is_corrected:
        factor = _factor(past)
        sigma = factor * np.array([how[f"sigma_{lead}d"] for lead in LEADS[1:]], float)
        correction = np.sqrt([how[f"sgp4_{lead}d"] ** 2 - how[f"sigma_{lead}d"] ** 2 for lead in LEADS[1:]])
        sizes.loc[LEADS[1:], "s"] = sigma
        sizes.loc[LEADS[1:], "sgp4"] = np.hypot(sigma, correction)
        sizes.loc[0, ["s", "sgp4"]] = min(sizes.loc[0, "s"], sizes.loc[1, "s"])
    sizes[["s", "sgp4"]] *= storm
    sizes["r"] = np.hypot(sizes["r"], lower(sizes["s"], how["motion"]))
    unseen = dict(zip(sgp4_errors.AXES, sgp4_errors.UNSEEN, strict=True))
    for name in sizes:
        sizes[name] = np.hypot(np.maximum.accumulate(sizes[name]), unseen["s" if name == "sgp4" else name])
    return sizes


def _measured(errors: pd.DataFrame, usual: pd.DataFrame) -> pd.DataFrame:
    """Return root mean squares by lead and axis, the object's own against USUAL_SIZES of the usual size."""
    squares = (errors[list(usual)] ** 2).groupby(errors["lead"])
    total = squares.sum().reindex(usual.index, fill_value=0.0)
    count = squares.size().reindex(usual.index, fill_value=0)
    return np.sqrt((total + USUAL_SIZES * usual**2).div(count + USUAL_SIZES, axis=0))


def _factor(past: pd.DataFrame) -> float:
    """Return by how much the object's own past errs more than its sigmas, against USUAL that err as these."""
    # Errors of seven days hardly change from one morning to the next.
    counts = 1.0 / past["lead"].clip(lower=1)
    ratios = np.minimum((past["left"] / past["sigma"]) ** 2, _GROSS**2)
    return float(np.sqrt(((counts * ratios).sum() + USUAL) / (counts.sum() + USUAL)))
