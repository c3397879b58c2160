"""The catalogue as a thermometer: what the drag coefficients of many RSOs say of the density together.

Where the assumed density is wrong by a factor, the fits of all RSOs take it up in their Cd at the same time.
So ln Cd of RSO k over a window is c_k, of its body, plus what all share of the density: a level, which lasts,
and the mean over the window of x, one value per step, with a memory (Ornstein-Uhlenbeck). A Kalman filter
finds all of them, from what was estimated up to each step (Doornbos, Klinkrad & Visser 2008, Adv. Space Res.
41, 1115-1125, for TLEs; Storz et al. 2005, HASDM).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from opml.constants import DAY, HOUR
from opml.tables import STATE

COMMON_CD = 2.2
"""Cd of a body of which nothing is known: that of most satellites (Vallado 2013, sec. 8.6.2)."""

WORST = 0.3
"""Relative formal error of a Cd beyond which a fit says nothing: its logarithm would be biased."""


@dataclass(frozen=True)
class Thermometer:
    """How the factor of the density and the bodies vary: settings of the filter, deviations in ln Cd.

    window_hours: of the fits; step_hours: of one value of the factor; decay_days: its memory; factor_sigma:
    how far it goes; body_sigma: of a body's Cd before any fit; drift_sigma: its change in a day; noise_sigma:
    of a fit, beside its formal error; level_sigma: how far the level may be from nothing, 0 for none.
    """

    window_hours: float
    step_hours: float
    decay_days: float
    factor_sigma: float
    body_sigma: float
    drift_sigma: float
    noise_sigma: float
    level_sigma: float = 0.0

    @property
    def step(self) -> float:
        """Length of a step [s]."""
        return self.step_hours * HOUR

    @property
    def window(self) -> float:
        """Length of the fits' window [s]."""
        return self.window_hours * HOUR

    @property
    def lags(self) -> int:
        """Steps that a window may touch."""
        return math.ceil(self.window / self.step) + 1

    @property
    def memory(self) -> float:
        """Part of the factor that outlives a step."""
        return math.exp(-self.step_hours / (24.0 * self.decay_days))

    def shares(self, t: np.ndarray) -> np.ndarray:
        """Parts of the windows before times t (n,) [s] in their own step and in each before: (n, lags)."""
        begins = self.step * (np.floor(t / self.step)[:, None] - np.arange(self.lags))
        ends = np.minimum(begins + self.step, t[:, None])
        inside = ends - np.maximum(begins, t[:, None] - self.window)
        found: np.ndarray = np.maximum(inside, 0.0) / self.window
        return found

    def ahead(self, duration: np.ndarray) -> np.ndarray:
        """What is left of the factor over a prediction: its mean, where earlier drag counts more (n,)."""
        z = np.maximum(duration / (DAY * self.decay_days), 1e-4)
        found: np.ndarray = 2.0 * (z - 1.0 + np.exp(-z)) / z**2
        return found


@dataclass(frozen=True)
class Belief:
    """Mean (n,) and covariance (n, n) of the factor at a step and those before, the level, then bodies."""

    mean: np.ndarray
    covariance: np.ndarray

    def updated(self, row: np.ndarray, value: float, variance: float) -> "Belief":
        """The belief after a measurement of row (n,) times the state (Kalman 1960)."""
        toward = self.covariance @ row
        gain = toward / (row @ toward + variance)
        return Belief(self.mean + gain * (value - row @ self.mean), self.covariance - np.outer(gain, toward))

    def later(self, settings: Thermometer) -> "Belief":
        """The belief a step later: the factor decays towards 0, bodies may have changed."""
        count, lags, memory = len(self.mean), settings.lags, settings.memory
        move = np.eye(count)
        move[:lags, :lags] = np.eye(lags, k=-1)
        move[0, 0] = memory
        noise = np.full(count, settings.drift_sigma**2 * settings.step_hours / 24.0)
        noise[: lags + 1] = 0.0
        noise[0] = settings.factor_sigma**2 * (1.0 - memory**2)
        return Belief(move @ self.mean, move @ self.covariance @ move.T + np.diag(noise))

    def of(self, body: int | None, settings: Thermometer) -> "Belief":
        """The belief of the factor and one body alone; None is a body of which nothing is known."""
        shared = settings.lags + 1
        if body is not None:
            chosen = [*range(shared), shared + body]
            return Belief(self.mean[chosen], self.covariance[np.ix_(chosen, chosen)])
        covariance = np.diag([*np.zeros(shared), settings.body_sigma**2])
        covariance[:shared, :shared] = self.covariance[:shared, :shared]
        return Belief(np.append(self.mean[:shared], math.log(COMMON_CD)), covariance)


def at_first(bodies: int, settings: Thermometer) -> Belief:
    """The belief before any fit: a factor as it may be at any time, bodies as any."""
    lags = settings.lags
    apart = np.abs(np.subtract.outer(np.arange(lags), np.arange(lags)))
    covariance = np.diag(np.full(lags + 1 + bodies, settings.body_sigma**2))
    covariance[:lags, :lags] = settings.factor_sigma**2 * settings.memory**apart
    covariance[lags, lags] = settings.level_sigma**2
    return Belief(np.repeat([0.0, math.log(COMMON_CD)], [lags + 1, bodies]), covariance)


def beliefs(estimates: Sequence[pd.DataFrame], settings: Thermometer) -> list[Belief]:
    """What is believed at the start of each step, from the fits of all RSOs before it.

    estimates: the tables over the settings' window. Of each RSO the last fit of a step counts, as the windows
    of one after the other share their tracks.
    """
    fits = pd.concat([_fits(table, settings).assign(body=k) for k, table in enumerate(estimates)])
    by_step = dict(iter(fits.groupby("step")))
    belief, found = at_first(len(estimates), settings), []
    for step in range(int(fits["step"].max()) + 1):
        found.append(belief)
        for fit in by_step.get(step, fits[:0]).groupby("body").tail(1).itertuples():
            row = np.zeros(len(belief.mean))
            row[: settings.lags], row[settings.lags] = fit.shares, 1.0
            row[settings.lags + 1 + fit.body] = 1.0
            belief = belief.updated(row, fit.value, fit.variance)
        belief = belief.later(settings)
    return found


def _fits(estimates: pd.DataFrame, settings: Thermometer) -> pd.DataFrame:
    """What fits say of ln Cd: step, shares of the steps, value and variance; the useless left out."""
    t, cd = estimates["t"].to_numpy(), estimates["cd"].to_numpy()
    relative = np.divide(estimates["cov_cd_cd"], cd**2, out=np.zeros(len(cd)), where=cd > 0.0)
    use = estimates["converged"].to_numpy() & (relative > 0.0) & (relative < WORST**2)
    return pd.DataFrame(
        {
            "track": estimates["track"],
            "step": np.floor(t / settings.step).astype(int),
            "shares": list(settings.shares(t)),
            "value": np.log(np.where(use, cd, 1.0)),
            "variance": relative + settings.noise_sigma**2,
        }
    )[use]


def read(
    estimates: pd.DataFrame, told: list[Belief], body: int | None, settings: Thermometer
) -> pd.DataFrame:
    """What the thermometer says of an RSO at each of its estimates, a row of it; `body` is with the level.

    told: from `beliefs`; body: its number there, None for one left out, of which only the fit at t_i is used.
    Of the other RSOs nothing counts that was estimated in the step of t_i or later.
    """
    fits = _fits(estimates, settings).set_index("track")
    rows = []
    for track, t in zip(estimates["track"], estimates["t"], strict=True):
        belief = told[min(int(t // settings.step), len(told) - 1)].of(body, settings)
        shares = settings.shares(np.array([t]))[0]
        row = np.append(shares, [1.0, 1.0])
        if track in fits.index:
            belief = belief.updated(row, fits.at[track, "value"], fits.at[track, "variance"])
        lasts = belief.mean[-2] + belief.mean[-1]
        rows.append((track, t, lasts, belief.mean[0], math.exp(row @ belief.mean)))
    return pd.DataFrame(rows, columns=["track", "t", "body", "factor", "cd_window"])


def corrections(
    predictions: pd.DataFrame,
    told: pd.DataFrame,
    arcs: pd.DataFrame,
    sensitivities: pd.DataFrame,
    settings: Thermometer,
) -> pd.DataFrame:
    """The `thermometer` table: one row per pair of `predictions`, in their order.

    told: from `read`; arcs: over the settings' window; sensitivities: of the predictions. The arc's Cd is
    moved to what the thermometer makes of it, with the state along the fit's covariance; from t_i on the
    factor decays, which moves nothing but the drag to come.
    """
    of_arc = told.set_index("track").loc[predictions["i"]]
    duration = (predictions["t_j"] - predictions["t_i"]).to_numpy()
    within = of_arc["cd_window"].to_numpy()
    ahead = np.exp(of_arc["body"].to_numpy() + of_arc["factor"].to_numpy() * settings.ahead(duration))
    table = {"i": predictions["i"].to_numpy(), "j": predictions["j"].to_numpy()}
    table |= {"factor": of_arc["factor"].to_numpy(), "cd_window": within, "cd_ahead": ahead}
    for axis in STATE:
        moved = arcs[f"l_arc_{axis}"] + arcs[f"v_arc_{axis}"] * (arcs["cd_arc"] - within)
        table[f"thermo_{axis}"] = (moved + sensitivities[f"s_{axis}"] * (within - ahead)).to_numpy()
    return pd.DataFrame(table)
