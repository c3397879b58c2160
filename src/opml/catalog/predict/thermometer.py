"""The catalogue as a thermometer: what the drag coefficients of many RSOs say of the density together.

Where the assumed density is wrong by a factor, the fits of all RSOs take it up in their Cd at the same time.
So ln Cd of RSO k over a window is c_k, of its body, plus what all share of the density: a level, which lasts,
and a mean over the window of x, one value per step, with a memory (Ornstein-Uhlenbeck). A Kalman filter
estimates all of them, from the fits before each time (Doornbos, Klinkrad & Visser 2008, Adv. Space Res. 41,
1115-1125, for TLEs; Storz et al. 2005, HASDM).

The steps' weights in that mean are not even. Drag moves an RSO along its track by its double integral, and a
fit lays a parabola through what its tracks see of that: Cd is the parabola's curvature. It weighs the middle
of the window most and the last hours hardly; their drag is in the error of the state instead.
"""

import math
from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from opml.base.constants import DAY, HOUR
from opml.tables import STATE

COMMON_CD = 2.2
"""Cd of an unknown body: that of most satellites (Vallado 2013, sec. 8.6.2)."""

WORST = 0.3
"""Relative formal error of a Cd beyond which a fit does not count: its logarithm would be biased."""


@dataclass(frozen=True)
class Thermometer:
    """How the factor of the density and the bodies vary: settings of the filter, deviations in ln Cd.

    window_hours: of the fits
    step_hours: of one value of the factor
    decay_days: memory of the factor
    factor_sigma: how far the factor goes
    body_sigma: of a body's Cd before any fit
    drift_sigma: change of a body's Cd in a day
    noise_sigma: of a fit, beside its formal error
    excess: by how much the assumed forces make a fit err more than its formal error says
    level_sigma: how far the level may be from nothing, 0 for none
    """

    window_hours: float
    step_hours: float
    decay_days: float
    factor_sigma: float
    body_sigma: float
    drift_sigma: float
    noise_sigma: float
    excess: float = 1.0
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

    def step_of(self, t: np.ndarray) -> np.ndarray:
        """Return the numbers of the steps of times t (n,) [s]."""
        numbers: np.ndarray = np.floor(t / self.step).astype(int)
        return numbers

    def ahead(self, duration: np.ndarray) -> np.ndarray:
        """Return the part (n,) of the factor that is left over predictions of `duration` (n,) [s].

        It is a mean in which earlier drag counts more.
        """
        z = np.maximum(duration / (DAY * self.decay_days), 1e-4)
        left: np.ndarray = 2.0 * (z - 1.0 + np.exp(-z)) / z**2
        return left


@dataclass(frozen=True)
class Seen:
    """How a fit saw the drag of each step that its window touches, the newest first; times in windows.

    begins, ends: (lags,) of the steps, from t_i, within the window
    parabola: (3, lags) place, rate and curvature at t_i that the tracks made of a unit of drag in each step;
    a unit in all steps has the curvature 1
    """

    begins: np.ndarray
    ends: np.ndarray
    parabola: np.ndarray

    @property
    def shares(self) -> np.ndarray:
        """Parts (lags,) of the steps in Cd; they add up to 1."""
        curvature: np.ndarray = self.parabola[2]
        return curvature

    def within(self, reach: np.ndarray) -> np.ndarray:
        """Return the error (n, lags) of predictions over `reach` (n,) windows by drag in each step.

        Its unit is the error of a prediction by an error of Cd.
        """
        half = 0.5 * reach[:, None] ** 2
        predicted = _powers(reach) @ self.parabola
        error: np.ndarray = (predicted - _moved(reach, self.begins, self.ends)) / half
        return error


def seen(t: float, tracks: np.ndarray, settings: Thermometer) -> Seen:
    """Return how a fit at t [s] saw the drag, by the tracks of its window; tracks: (n,) beginnings [s]."""
    at = (tracks[(tracks > t - settings.window) & (tracks <= t)] - t) / settings.window
    length = settings.step_hours / settings.window_hours
    newest = t // settings.step * length - t / settings.window
    begins = newest - length * np.arange(settings.lags)
    ends = np.clip(begins + length, at[0], 0.0)
    begins = np.clip(begins, at[0], 0.0)
    return Seen(begins, ends, np.linalg.pinv(_powers(at)) @ _moved(at, begins, ends))


def _powers(t: np.ndarray) -> np.ndarray:
    """Return the displacement (n, 3) at times t (n,) by a unit of place, rate and curvature at 0."""
    return np.column_stack([np.ones(len(t)), t, 0.5 * t**2])


def _moved(t: np.ndarray, begins: np.ndarray, ends: np.ndarray) -> np.ndarray:
    """Return the displacement (n, m) at times t (n,) by a unit of drag from `begins` to `ends` (m,)."""
    since = np.maximum(t[:, None] - begins, 0.0), np.maximum(t[:, None] - ends, 0.0)
    displacement: np.ndarray = 0.5 * (since[0] ** 2 - since[1] ** 2)
    return displacement


@dataclass(frozen=True)
class Belief:
    """Mean (n,) and covariance (n, n) of the factor at a step and those before, the level, then bodies."""

    mean: np.ndarray
    covariance: np.ndarray

    def updated(self, row: np.ndarray, value: float, variance: float) -> "Belief":
        """Return the belief after a measurement of row (n,) times the state (Kalman 1960)."""
        toward = self.covariance @ row
        gain = toward / (row @ toward + variance)
        return Belief(self.mean + gain * (value - row @ self.mean), self.covariance - np.outer(gain, toward))

    def later(self, settings: Thermometer) -> "Belief":
        """Return the belief a step later: the factor decays towards 0, bodies may have changed."""
        count, lags, memory = len(self.mean), settings.lags, settings.memory
        move = np.eye(count)
        move[:lags, :lags] = np.eye(lags, k=-1)
        move[0, 0] = memory
        noise = np.full(count, settings.drift_sigma**2 * settings.step_hours / 24.0)
        noise[: lags + 1] = 0.0
        noise[0] = settings.factor_sigma**2 * (1.0 - memory**2)
        return Belief(move @ self.mean, move @ self.covariance @ move.T + np.diag(noise))

    def about(self, body: int | None, settings: Thermometer) -> "Belief":
        """Return the belief of the factor, the level and one body alone; None for an unknown body."""
        shared = settings.lags + 1
        if body is not None:
            chosen = [*range(shared), shared + body]
            return Belief(self.mean[chosen], self.covariance[np.ix_(chosen, chosen)])
        covariance = np.diag([*np.zeros(shared), settings.body_sigma**2])
        covariance[:shared, :shared] = self.covariance[:shared, :shared]
        return Belief(np.append(self.mean[:shared], math.log(COMMON_CD)), covariance)


def at_first(bodies: int, settings: Thermometer) -> Belief:
    """Return the belief before any fit: a factor as at any time, bodies as any."""
    lags = settings.lags
    apart = np.abs(np.subtract.outer(np.arange(lags), np.arange(lags)))
    covariance = np.diag(np.full(lags + 1 + bodies, settings.body_sigma**2))
    covariance[:lags, :lags] = settings.factor_sigma**2 * settings.memory**apart
    covariance[lags, lags] = settings.level_sigma**2
    return Belief(np.repeat([0.0, math.log(COMMON_CD)], [lags + 1, bodies]), covariance)


def beliefs(
    catalogue: Sequence[pd.DataFrame], times: np.ndarray, body: int | None, settings: Thermometer
) -> Iterator[Belief]:
    """Yield the belief of the factor and one body at each of `times` (n,) [s], from the fits before it.

    catalogue: the tables of estimates over the settings' window, a row per track
    times: ascending
    body: as in `Belief.about`

    Of each RSO one fit counts in half a window.
    """
    tracks = [table["t"].to_numpy() for table in catalogue]
    fits = pd.concat(
        [_counted(_fits(table, settings), settings).assign(body=k) for k, table in enumerate(catalogue)]
    )
    waiting = deque(fits.sort_values(["t", "body"]).itertuples())
    belief, step = at_first(len(catalogue), settings), 0
    for t in times:
        while waiting and waiting[0].t < t:
            fit = waiting.popleft()
            belief, step = _until(belief, step, fit.step, settings), fit.step
            row = np.zeros(len(belief.mean))
            row[: settings.lags], row[settings.lags] = seen(fit.t, tracks[fit.body], settings).shares, 1.0
            row[settings.lags + 1 + fit.body] = 1.0
            belief = belief.updated(row, fit.value, fit.variance)
        now = int(t // settings.step)
        belief, step = _until(belief, step, now, settings), now
        yield belief.about(body, settings)


def _until(belief: Belief, step: int, end: int, settings: Thermometer) -> Belief:
    """Return the belief of a step carried to a later step `end`."""
    for _ in range(step, end):
        belief = belief.later(settings)
    return belief


def _counted(fits: pd.DataFrame, settings: Thermometer) -> pd.DataFrame:
    """Return the first fit of each half window: others share most of its tracks, and of its errors."""
    return fits.groupby(np.floor(fits["t"] / (0.5 * settings.window))).head(1)


def _fits(estimates: pd.DataFrame, settings: Thermometer) -> pd.DataFrame:
    """Return what fits tell of ln Cd: track, t, step, value and variance; useless fits are left out."""
    t, cd = estimates["t"].to_numpy(), estimates["cd"].to_numpy()
    relative = np.divide(estimates["cov_cd_cd"], cd**2, out=np.zeros(len(cd)), where=cd > 0.0)
    use = estimates["converged"].to_numpy() & (relative > 0.0) & (relative < WORST**2)
    return pd.DataFrame(
        {
            "track": estimates["track"].to_numpy()[use],
            "t": t[use],
            "step": settings.step_of(t[use]),
            "value": np.log(cd[use]),
            "variance": settings.excess**2 * relative[use] + settings.noise_sigma**2,
        }
    )


@dataclass(frozen=True)
class Reading:
    """What the thermometer shows at an estimate: the factor of each step of its window, and Cd over it."""

    factors: np.ndarray
    cd_window: float
    seen: Seen

    def cd_ahead(self, duration: np.ndarray, settings: Thermometer) -> np.ndarray:
        """Return Cd (n,) that makes up for what the factor does to predictions over `duration` (n,) [s].

        Predictions err by the drag that is to come, of which the decaying factor is known, and by the drag in
        the window, as far as the state at t_i took it up. The error of the state is not one of Cd, but over a
        short time as good as a large change of it.
        """
        within = self.seen.within(duration / settings.window) @ self.factors
        cd: np.ndarray = self.cd_window * (1.0 + self.factors[0] * settings.ahead(duration) - within)
        return cd


def read(
    estimates: pd.DataFrame, catalogue: Sequence[pd.DataFrame], body: int | None, settings: Thermometer
) -> dict[int, Reading]:
    """Return the readings for an RSO at each of its estimates, by their tracks.

    catalogue: as in `beliefs`
    body: number of the RSO there; None where it is left out, so that only its fit at t_i is used

    Of the other RSOs nothing counts that was estimated at t_i or later.
    """
    fits = _fits(estimates, settings).set_index("track")
    t = estimates["t"].to_numpy()
    readings = {}
    for track, when, belief in zip(estimates["track"], t, beliefs(catalogue, t, body, settings), strict=True):
        drag = seen(when, t, settings)
        row = np.append(drag.shares, [1.0, 1.0])
        if track in fits.index:
            belief = belief.updated(row, fits.at[track, "value"], fits.at[track, "variance"])
        factors = belief.mean[: settings.lags]
        readings[track] = Reading(factors, math.exp(row @ belief.mean), drag)
    return readings


def corrections(
    predictions: pd.DataFrame,
    readings: Mapping[int, Reading],
    arcs: pd.DataFrame,
    sensitivities: pd.DataFrame,
    settings: Thermometer,
) -> pd.DataFrame:
    """Return the `thermometer` table: one row per pair of `predictions`, in their order.

    readings: from `read`
    arcs: the table, over the settings' window
    sensitivities: the table of the predictions

    The arc's Cd is moved to that of the reading, with the state along the fit's covariance. From t_i on, it
    is the Cd that makes up for the factor.
    """
    duration = (predictions["t_j"] - predictions["t_i"]).to_numpy()
    factor, within, ahead = (np.zeros(len(predictions)) for _ in range(3))
    for track, rows in predictions.groupby("i").indices.items():
        reading = readings[track]
        factor[rows], within[rows] = reading.factors[0], reading.cd_window
        ahead[rows] = reading.cd_ahead(duration[rows], settings)
    table = {"i": predictions["i"].to_numpy(), "j": predictions["j"].to_numpy()}
    table |= {"factor": factor, "cd_window": within, "cd_ahead": ahead}
    for axis in STATE:
        moved = arcs[f"l_arc_{axis}"] + arcs[f"v_arc_{axis}"] * (arcs["cd_arc"] - within)
        table[f"thermo_{axis}"] = (moved + sensitivities[f"s_{axis}"] * (within - ahead)).to_numpy()
    return pd.DataFrame(table)
