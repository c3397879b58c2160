"""Sizes of errors of predictions from fits: typical ones, scaled by those of the object's own past.

The variance of each axis has a part of the fit and a part of drag,

    sigma^2 = f^2 (a^2 + (b D)^2) + g^2 ((c drag)^2 + (w weather)^2),

D the duration, `drag` the displacement by a tenth more drag and `weather` the spread of the futures of the
space weather (`opml.catalog.predict.weather_spread`). a and b are the fit's formal errors where Cd is known,
and what the forces leave, also of light, whose pressure goes by a body that may be a guess; along the track a
has a hundredth of a day's drag, too. c is the typical error of the density that a fit estimates, more over
less than two days, with the formal error of Cd. So they follow height and measurements. Without a past f and
g are 1. A past error counts for each by the part of its variance that is of it, and for less the more it
overlaps others. Errors are differences from later estimates, whose own variance is taken off.

A velocity error follows from the position's (`opml.orbits.rsw_covariance`).

The constants were chosen in hindsight; notes/uncertainty.md has what they gave where others were left out.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
import pandas as pd

from opml.base.constants import DAY, HOUR, SRP_PRESSURE, WGS84_A
from opml.catalog.predict import labels
from opml.catalog.predict.weather_spread import TENTH, mean_cd
from opml.orbits.elements import rsw_rotation
from opml.orbits.rsw_covariance import AXES, rates
from opml.orbits.sheets import Rso
from opml.tables import COMPONENTS, DOUBT, PARAMETER_COVARIANCES, SIGMAS, SIZES, STATE, symmetric_matrices

CONSTANT = np.array([1.0, 1.5, 1.0])  # what forces leave in a fit, in RSW [m]
RATE = np.array([1.2, 2.0, 1.0])  # by what that grows [m/day]
GUESSED, GIVEN = 0.9, 0.3  # part of light's pressure that errs: as of Cd, or of Cr and attitude alone
DAILY = 0.1  # part of a tenth of a day's drag that is left in a fit along the track
DENSITY = 0.6  # error of the density that a fit over LONG hours estimates, in tenths of it

LONG = 48.0
"""Window over which density hardly errs more by chance; its mean over fewer hours does, by their root."""

VAGUE = 5.0  # most of that error. A fit that knows drag no better takes the mean of the past
FAR = 3.0  # root mean square of weighted residuals from which on their noise is larger than given
WEATHER = 0.6  # part of the spread of the weather's futures that errors have
USUAL = 3.0  # independent errors of a past that the typical sizes count as

_CONSTANT, _RATE = SIZES[:3], SIZES[3:6]
FORMAL, _SCALES = SIZES[:7], SIZES[7:]  # columns of formal errors, and of f and g
_LEAST_CD = 1e-6
J2 = 1.08263e-3  # the Earth's flattening in its gravity (EGM2008)
_GROSS = 10.0  # sizes that an error counts as at most


def formal_errors(
    estimates: pd.DataFrame, daily: pd.Series, *, base: float, rso: Rso, light: float
) -> pd.DataFrame:
    """Return a [m], b [m/day] by axis and c [tenths of the drag] of ephemerides, by track: a_x ... b_z, c.

    estimates: table `kept_estimates`
    daily: displacement [m] by a tenth more drag after a day, by the track that ephemerides start from
    base: window [h] of the fits that they start from; the longest window tells Cd
    rso: the body; light: the part of light's pressure on it that errs

    Where Cd is known, an orbit that is higher by x and faster by v falls back by 3 (n x + v), n its angular
    rate. An unknown acceleration g towards the Sun adds 3 g / 2 n each second to an orbit's radial wave, and
    twice that along the track; a fit has it by half its window. (Gauss's equations, over a revolution.)
    A plane is known as position and velocity across it are; its node regresses by its inclination.
    """
    known = estimates[estimates["converged"].astype(bool) & estimates["track"].isin(daily.index)]
    known = labels.with_sigmas(_as_they_miss(known))
    started = known[known["window_hours"] == base].set_index("track")
    covariance = symmetric_matrices(started, PARAMETER_COVARIANCES)
    states = started[STATE].to_numpy(float)
    outwards, ahead, _ = rsw_rotation(states).transpose(1, 0, 2)
    falls = np.hstack([rates(states)[:, None] * outwards, ahead])
    by_cd, of_cd = np.einsum("nk,nk->n", falls, covariance[:, 6, :6]), covariance[:, 6, 6]
    whole = np.einsum("nj,njk,nk->n", falls, covariance[:, :6, :6], falls)
    given_cd = whole - np.divide(by_cd**2, of_cd, out=np.zeros(len(whole)), where=of_cd > 0.0)
    drift = 3.0 * DAY * np.sqrt(np.maximum(given_cd, 0.0))
    longest = known.sort_values("window_hours", kind="stable").groupby("track").last().loc[started.index]
    # The drag of a spread is that of this mean.
    mean = mean_cd(estimates[estimates["window_hours"] == base], rso.cd)[started.index].abs()
    cd = np.sqrt(longest["cov_cd_cd"]) / TENTH / np.maximum(mean, _LEAST_CD)
    hours = np.clip((longest["t"] - estimates["t"].min()) / HOUR, 1.0, LONG).to_numpy(float)
    known_to = started[SIGMAS].to_numpy(float)
    plane = np.sqrt(0.5 * (known_to[:, 2] ** 2 + (known_to[:, 5] / rates(states)) ** 2))
    constant = np.hypot(CONSTANT, np.column_stack([known_to[:, :2], plane]))
    constant[:, 1] = np.hypot(constant[:, 1], DAILY * daily[started.index])
    pushed = light * SRP_PRESSURE * rso.cr * rso.area_to_mass * DAY / rates(states)
    wave = pushed[:, None] * np.array([1.5, 3.0, 0.0]) / np.sqrt(2.0)
    constant = np.hypot(constant, wave * HOUR * base / 2.0 / DAY)
    rate = np.hypot(np.hypot(RATE, wave), np.stack([0.0 * drift, drift, plane * _regression(states)], axis=1))
    density = np.minimum(np.hypot(DENSITY * np.sqrt(LONG / hours), cd), VAGUE)
    return pd.DataFrame(np.column_stack([constant, rate, density]), index=started.index, columns=FORMAL)


def _regression(states: np.ndarray) -> np.ndarray:
    """Return how much farther apart planes are each day (n,), in parts of their distance, by Earth's J2."""
    momentum = np.cross(states[:, :3], states[:, 3:])
    square_sine = 1.0 - momentum[:, 2] ** 2 / np.sum(momentum**2, axis=1)
    flat = 1.5 * J2 * WGS84_A**2 / np.sum(states[:, :3] ** 2, axis=1)
    return np.asarray(flat * rates(states) * square_sine * DAY / np.sqrt(2.0))


def _as_they_miss(estimates: pd.DataFrame) -> pd.DataFrame:
    """Return estimates, with covariances of the noise that they leave where it is FAR beyond that given."""
    rms = estimates["weighted_rms"]
    larger = rms.where(rms > FAR, 1.0) ** 2
    return estimates.assign(**{name: estimates[name] * larger for name in PARAMETER_COVARIANCES})


@dataclass(frozen=True, eq=False)
class FitSizes:
    """Sizes of errors of an ephemeris, in the terms of the module's formula."""

    formal: pd.Series  # a_x ... b_z, c
    scales: np.ndarray  # (2, 3) f and g by axis

    @classmethod
    def learned(cls, formal: pd.Series, past: pd.DataFrame, past_formal: pd.DataFrame) -> Self:
        """Return the sizes of an ephemeris, its formal errors scaled by a past.

        past: rows of `judged` of its model that are known by now
        past_formal: of `formal_errors`, of the tracks that these started from; others do not count
        """
        return cls(formal, _scales(past[past["i"].isin(past_formal.index)], past_formal))

    @classmethod
    def from_row(cls, row: Mapping[str, Any]) -> Self:
        """Return the sizes in a row of the table `issued`."""
        scales = np.array([row[name] for name in _SCALES]).reshape(2, 3)
        return cls(pd.Series({name: row[name] for name in FORMAL}), scales)

    @property
    def row(self) -> dict[str, float]:
        """Columns of the table `issued`."""
        scales = dict(zip(_SCALES, self.scales.ravel().tolist(), strict=True))
        return {name: float(self.formal[name]) for name in FORMAL} | scales

    def sigmas(self, rows: pd.DataFrame) -> np.ndarray:
        """Return standard deviations (n, 6) [m, m/s] of the parts for `rsw_covariance.rsw_covariances`.

        rows: duration [s], rate [rad/s], drag_* and weather_* [m]
        """
        fit, drag = np.sqrt(_variances(self.formal.to_frame().T, rows))
        position = np.hypot(self.scales[0] * fit, self.scales[1] * drag)
        velocity = rows["rate"].to_numpy()[:, None] * position[:, [0, 0, 2]]
        return np.hstack([position, velocity])


def _variances(formal: pd.DataFrame, rows: pd.DataFrame) -> np.ndarray:
    """Return the variances (2, n, 3) [m2] of the fit and of drag, at rows (n,); formal: of each row."""
    days = rows["duration"].to_numpy()[:, None] / DAY
    drag, weather = (rows[[f"{name}_{axis}" for axis in AXES]].to_numpy() for name in ("drag", "weather"))
    return np.array(
        [
            formal[_CONSTANT].to_numpy() ** 2 + (formal[_RATE].to_numpy() * days) ** 2,
            (formal[["c"]].to_numpy() * drag) ** 2 + (WEATHER * weather) ** 2,
        ]
    )


def _scales(past: pd.DataFrame, formal: pd.DataFrame) -> np.ndarray:
    """Return f and g by axis (2, 3)."""
    days = past["duration"].to_numpy() / DAY
    parts = _variances(formal.loc[past["i"]], past)
    square = parts.sum(axis=0) + past[DOUBT].to_numpy(float) ** 2
    ratio = np.minimum(past[list(COMPONENTS[:3])].to_numpy() ** 2 / square, _GROSS**2)
    alike = past.groupby([past["i"], np.floor(days)])["i"].transform("size").to_numpy()
    weight = parts / square / (alike * np.maximum(days, 1.0))[:, None]
    return np.asarray(np.sqrt(((weight * ratio).sum(axis=1) + USUAL) / (weight.sum(axis=1) + USUAL)))
