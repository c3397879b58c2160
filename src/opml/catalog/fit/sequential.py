"""Estimates by a sequential filter: an extended Kalman filter whose drag coefficient is never at rest.

Track by track, the state and its covariance are carried to the next track's start and meet its measurements
there; all that came before is in them, and fades as the noise of the drag has it. So no window is chosen, and
a passing error of the density does not pull at measurements of another day.

    Cd(t) = c + d(t)         c: the slow mean, a random walk
    <d(t) d(t')> = sigma^2 exp(-|t - t'| / tau)       d: a Gauss-Markov process of the first order

The parts of the transition come from neighbouring arcs, as those of the batch fits do. Several filters run
side by side on the same arcs, each with another noise of the drag. At each track speaks the one whose
innovations up to then were likeliest, so that no row rests on what came later.

Covariances are carried as roots, P = L L', which stay positive: after a step L is the triangle of [F L, Q],
and a track with the weighted partial derivatives A = H L, of residuals r, gives

    u = (I + A'A)^-1 A'r,  x + L u,  L (I + A'A)^(-1/2)
    chi2 = (r - A u)'(r - A u) + u'u,  ln likelihood = -(chi2 + ln det(I + A'A)) / 2 + constant

Tapley, Schutz & Born 2004, Statistical Orbit Determination, ch. 4.7, 4.9 and 5.7; Wright 1981, Sequential
orbit determination with auto-correlated gravity modeling errors; Magill 1965, IEEE Transactions on Automatic
Control 10, 434-439 (the bank of filters).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pandas as pd

from opml.base.constants import DAY
from opml.catalog.fit.estimation import NUDGES, Measured, fly_beside
from opml.catalog.flight import Flight
from opml.dynamics.ensemble import REASONS
from opml.tables import PARAMETER_COVARIANCES, PARAMETERS

STEP = 1800.0
"""Longest time for which the drag coefficient keeps its value [s]."""

KICK = 1e-14
"""Noise of the velocity that stands for errors of the other forces [m2/s3]."""

APRIORI_SIGMA = 0.5
"""Uncertainty of the sheet's Cd, as a part of it."""

_PASSES = 3
"""How often a track's measurements are met, each time where the last left the state."""

_SCALES = np.array([1e3, 1e3, 1e3, 1.0, 1.0, 1.0])
_CD = PARAMETERS.index("cd")


@dataclass(frozen=True)
class DragNoise:
    """How Cd varies, as a part of the sheet's.

    walk: what a day changes it by, for good
    gust: what the mean over a day is off by, of that which does not last
    """

    walk: float
    gust: float


BANK = tuple(DragNoise(walk, gust) for walk in (0.02, 0.05, 0.1, 0.2) for gust in (0.025, 0.05, 0.1, 0.2))
"""The noises of the filters that run side by side."""


@dataclass(frozen=True)
class Leg:
    """The arc from one track's start to the next, and how arcs beside it part from it.

    cd: of the arc
    steps: (n,) lengths [s]
    path: (n + 1, 6) GCRF [m, m/s] at the ends of the steps
    transitions: (n, 6, 7) partial derivatives by the state before each step, and by Cd within it
    seen: (epochs, 6) states at the next track's epochs
    to_seen: (epochs, 6, 6) their partial derivatives by the state at the track's start
    """

    cd: float
    steps: np.ndarray
    path: np.ndarray
    transitions: np.ndarray
    seen: np.ndarray
    to_seen: np.ndarray


class LostError(Exception):
    """The arc does not reach the next track."""


def fly_leg(flight: Flight, parameters: np.ndarray, begin: float, seen: np.ndarray) -> Leg:
    """Return the leg from parameters (7,) at `begin` [s] to the epochs `seen` of the next track.

    It flies under what is known when that track begins. Raises LostError where it comes down.
    """
    gap = seen[0] - begin
    grid = np.linspace(begin, seen[0], int(np.ceil(gap / STEP)) + 1)
    epochs = np.append(grid, seen[1:])
    known = replace(flight, model=flight.model.known_at(float(seen[0])))
    states, status = fly_beside(known, epochs, parameters)
    if status:
        raise LostError(f"arc {REASONS[status]}")
    partials = ((states[1:] - states[0]) / NUDGES[:, None, None]).transpose(1, 2, 0)
    steps = len(grid) - 1
    transitions = np.empty((steps, 6, 7))
    for k in range(steps):
        transitions[k, :, :6] = _divided(partials[k + 1, :, :6], partials[k, :, :6])
        transitions[k, :, 6] = partials[k + 1, :, 6] - transitions[k, :, :6] @ partials[k, :, 6]
    to_seen = np.array([_divided(partial, partials[steps, :, :6]) for partial in partials[steps:, :, :6]])
    return Leg(parameters[6], np.diff(grid), states[0, : steps + 1], transitions, states[0, steps:], to_seen)


def _divided(later: np.ndarray, earlier: np.ndarray) -> np.ndarray:
    """Return the partial derivatives (6, 6) of a later state by an earlier one, from those by the first."""
    scale = _SCALES / _SCALES[:, None]
    quotient: np.ndarray = np.linalg.solve((earlier * scale).T, (later * scale).T).T / scale
    return quotient


@dataclass(frozen=True)
class Filters:
    """Filters at one epoch, side by side.

    means: (filters, 7) of the state [m, m/s] and Cd
    roots: (filters, 7, 7) of their covariances
    scores: (filters,) ln likelihood of all innovations so far, but for a constant
    chi2: (filters,) of the last track's
    """

    means: np.ndarray
    roots: np.ndarray
    scores: np.ndarray
    chi2: np.ndarray

    @property
    def chosen(self) -> int:
        """The filter whose innovations were the likeliest so far."""
        return int(np.argmax(self.scores))

    def carried(self, leg: Leg, bank: Sequence[DragNoise], cd: float) -> "Filters":
        """Return the filters at the end of a leg. cd: of the sheet, which the noise is a part of."""
        means, roots = self.means, self.roots
        walk, gust = (cd * np.array([getattr(noise, name) for noise in bank]) for name in ("walk", "gust"))
        for k, step in enumerate(leg.steps):
            transition = np.vstack([leg.transitions[k], np.eye(7)[_CD]])
            days = step / DAY
            noise = np.zeros((len(bank), 7, 5))
            noise[:, 3:6, :3] = np.sqrt(KICK * step) * np.eye(3)
            noise[:, :6, 3] = np.outer(gust / np.sqrt(days), transition[:6, _CD])
            noise[:, _CD, 4] = walk * np.sqrt(days)
            means = np.append(leg.path[k + 1], leg.cd) + (means - np.append(leg.path[k], leg.cd)) @ transition.T
            wide = np.concatenate([transition @ roots, noise], axis=2)
            roots = np.linalg.qr(wide.transpose(0, 2, 1), mode="r").transpose(0, 2, 1)
        return replace(self, means=means, roots=roots)

    def met(self, measured: Measured, track: int, leg: Leg, *, light_time: bool) -> "Filters":
        """Return the filters with the measurements of the track where the leg ends."""
        means, roots = np.empty_like(self.means), np.empty_like(self.roots)
        chi2, scores = np.empty(len(means)), self.scores.copy()
        window = measured.track(track)
        for f, (prior, root) in enumerate(zip(self.means, self.roots, strict=True)):
            u = np.zeros(7)
            for _ in range(_PASSES):
                state = (prior + root @ u)[:6]
                own = leg.seen + leg.to_seen @ (state - leg.path[-1])
                beside = np.zeros((7, *own.shape))
                beside[:6] = NUDGES[:6, None, None] * leg.to_seen.transpose(2, 0, 1)
                states = np.concatenate([own[None], own + beside])
                evaluation = measured.evaluation(window, states, light_time=light_time)
                partials = evaluation.jacobian[:, :6] @ root[:6]
                pulled = evaluation.residuals + partials @ u
                normal = np.eye(7) + partials.T @ partials
                u = np.linalg.solve(normal, partials.T @ pulled)
            low = np.linalg.cholesky(normal)
            means[f], roots[f] = prior + root @ u, np.linalg.solve(low, root.T).T
            chi2[f] = np.sum((pulled - partials @ u) ** 2) + u @ u
            scores[f] -= 0.5 * chi2[f] + np.sum(np.log(np.diag(low)))
        return Filters(means, roots, scores, chi2)
