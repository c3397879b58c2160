"""Sizes of the errors of the orbit inside an object's newest set: by its last weeks, and by its drag.

The errors of the orbits of past sets, at later ones so many days on, are those that the newest will have. A
few errors of the size that is typical of its drag count with them, as a short past decides little. What
neighbouring sets have in common they do not show: precise orbits do, and that floor is added. Errors a week
apart are three in three weeks, so intervals are those of Student's t with as many degrees of freedom.
"""

import numpy as np
import pandas as pd
from scipy.special import ndtri, stdtrit
from sgp4.api import Satrec

from opml.base.constants import DAY
from opml.element_sets.inside.inside_now import PAST, InsideNow
from opml.interop.element_sets.element_set import decay
from opml.interop.predicted_orbit import LEADS

FLOOR = {"r": 5.0, "s": 30.0, "w": 15.0}
"""Errors that neighbouring sets have in common [m]: of Sentinel-3A and Jason-3, by precise orbits."""

_LEADS = np.array(LEADS, float)
_TYPICAL = 4.0  # errors of the typical size that count with an object's own
_MINUTE = 60.0
_FEWEST = 3  # errors that tell a size alone
_GROSS = 3.0  # robust standard deviations that an error counts at most: single sets are wrong
_ROBUST = 1.4826  # standard deviation of Gauss in medians of sizes
_REACH = 0.75  # an error counts for a time that is at most so far from its own [d]
_AT_EPOCH = 75.0, 0.4
"""Error along the track at the epoch: with a decay of a metre a day [m], and the power of the decay.

By the largest tenth of 462 pairs of sets a day apart, of 120 objects in April 2026.
"""
_QUANTILE = 0.95  # at which intervals of Student's t and of Gauss are as wide
_ROUND = {"r": 10.0, "w": 18.0}  # typical errors without drag [m]
_ACROSS = 0.1, 30.0  # with it: a metre of decay a day makes so many across the track, and at most [m]
_FREE = 25.0, 15.0  # typical error along the track without drag [m], and its growth [m/d]
_DRAG = 12.0, 1.65  # with it: errors of a day by a metre of decay a day [m]; power of the time


def typical(sinking: float, days: np.ndarray, motion: float) -> pd.DataFrame:
    """Return typical errors r, s, w [m] of the orbits inside sets so many days (n,) after their epochs.

    sinking: decay [m/d]; motion: mean motion [rad/s]
    """
    constant, rate = _FREE
    factor, power = _DRAG
    free, dragged = constant + rate * days, factor * max(sinking, 0.0) * days**power
    along = np.hypot(free, dragged)
    gained = (free * rate + dragged**2 * power / np.maximum(days, 0.1)) / along
    lower = gained / DAY / (1.5 * motion)  # an orbit that is too low by x gains 3/2 of its rate times x
    part, most = _ACROSS
    across = _ROUND["w"] + min(part * max(sinking, 0.0), most)
    columns = {"r": np.hypot(_ROUND["r"], lower), "s": along, "w": np.full(len(days), across)}
    return pd.DataFrame(columns, index=days)


def at_epoch(satellite: Satrec) -> np.ndarray:
    """Return the standard deviations (3,) in RSW [m] of the orbit inside a set at its epoch."""
    [usual] = typical(decay(satellite), np.zeros(1), satellite.no_kozai / _MINUTE).itertuples()
    return np.hypot([usual.r, 0.0, usual.w], _common(satellite))


def _common(satellite: Satrec) -> np.ndarray:
    """Return the errors (3,) in RSW [m] that neighbouring sets have in common."""
    part, power = _AT_EPOCH
    return np.hypot([*FLOOR.values()], [0.0, part * max(decay(satellite), 0.0) ** power, 0.0])


def rms(now: InsideNow) -> pd.DataFrame:
    """Return rms r, s, w [m] of the object's own errors and typical ones, by LEADS [d] from the date on."""
    satellite = now.orbit.beginning.satellite
    since = _LEADS + now.age
    usual = typical(decay(satellite), since, satellite.no_kozai / _MINUTE)
    measured = usual.copy()
    for day in since:
        own = _bounded(_near(now, day)[["r", "s", "w"]], usual.loc[day])
        squares = (own**2).sum() + _TYPICAL * usual.loc[day] ** 2
        measured.loc[day] = np.sqrt(squares / (len(own) + _TYPICAL))
    return measured.cummax().set_axis(list(LEADS))


def sizes(now: InsideNow, rms: pd.DataFrame) -> pd.DataFrame:
    """Return the standard deviations r, s, w [m] at LEADS, and sgp4, those of SGP4 along the track, NaN where
    too few errors tell; rms: of that function.
    """
    common = _common(now.orbit.beginning.satellite)
    # Intervals are wider, as few independent errors tell them.
    independent = PAST / np.maximum(_LEADS + now.age, 1.0) + _TYPICAL
    wider = stdtrit(independent, _QUANTILE) / ndtri(_QUANTILE)
    errors = [_bounded(_near(now, lead + now.age)[["sgp4_s"]])["sgp4_s"] for lead in _LEADS]
    by_sgp4 = np.array([np.sqrt((one**2).mean()) if len(one) >= _FEWEST else np.nan for one in errors])
    sgp4 = np.hypot(np.fmax.accumulate(by_sgp4) * wider, common[1])
    sgp4[np.isnan(by_sgp4)] = np.nan
    return np.hypot(rms.mul(wider, axis=0), common).assign(sgp4=sgp4)


def _bounded(errors: pd.DataFrame, least: pd.Series | float = 0.0) -> pd.DataFrame:
    """Return errors without gross ones; least: standard deviations that are usual [m]."""
    most = _GROSS * np.fmax(_ROBUST * errors.abs().median(), least)
    return errors.clip(-most, most, axis=1)


def _near(now: InsideNow, day: float) -> pd.DataFrame:
    """Return the errors of past orbits about so many days after the epochs of their sets."""
    errors = now.calibration.errors
    return errors[np.abs(errors["days"] - max(day, 1.0)) <= _REACH]


def lower(along: pd.Series, motion: float) -> np.ndarray:
    """Return by what orbits (leads,) are too low [m] that gain so much along the track [m]; motion [rad/min].

    An orbit that is too low by x gains 3/2 of its rate times x.
    """
    gained = np.gradient(np.maximum.accumulate(along), along.index.to_numpy(float), edge_order=2) / DAY
    return np.asarray(np.maximum.accumulate(gained.clip(0.0)) / (1.5 * motion / _MINUTE))
