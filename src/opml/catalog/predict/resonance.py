"""Along-track drift by the harmonics of the Earth's field that the assumed model leaves out.

Of all harmonics beyond its degree, those matter that an orbit meets again and again in nearly the same phase:
k u + m (W - theta) turns slowly, as m revolutions take about k turns of the Earth below the node. Kaula's
phase has w + M in the place of the argument of latitude u, which is the same for nearly round orbits. For
each such pair the harmonics of all degrees act together as one along-track acceleration, A cos + B sin of
that phase, with lumped coefficients A and B (Kaula 1966, Theory of Satellite Geodesy; King-Hele 1987,
Satellite Orbits in an Atmosphere, on resonance). The coefficients belong to the field, the inclination and
the height, not to an arc, so they can be learned. This module computes what they multiply.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from opml.base.constants import EARTH_RATE, HOUR
from opml.orbits.elements import coe_from_cartesian
from opml.tables import STATE

PHASE_STEP = 1800.0
"""Step of the sums that replace integrals [s]: about a hundred per turn of the fastest phase, two days."""


@dataclass(frozen=True)
class Resonances:
    """Resonances that are met, and the fits that meet them."""

    pairs: Sequence[tuple[int, int]]  # (k, m) of each resonance
    window_hours: float  # of the fits
    gm: float  # of the elements [m3/s2]


def columns(pairs: Sequence[tuple[int, int]]) -> list[str]:
    """Return the names of the columns of `drifts`, two per pair (k, m)."""
    return [f"{part}_{k}_{m}" for k, m in pairs for part in ("cos", "sin")]


def drifts(estimates: pd.DataFrame, predictions: pd.DataFrame, resonances: Resonances) -> pd.DataFrame:
    """Return the drift along-track [s2] of each prediction per unit of a lumped acceleration.

    Columns: `columns` of the resonances. A prediction that lacks an acceleration a(t) drifts off by y,
    y'' = 3 a (the factor is left to the coefficient: a drift forwards costs height and so falls behind). The
    fit over the window before t_i has met the same y and put a straight line through it, from which the
    prediction goes on; so the line is taken off. Its curvature is not: that went into Cd, and V (Cd - c) has
    it.
    """
    started = estimates.set_index("track").loc[predictions["i"].unique()]
    row = pd.Index(started.index).get_indexer(predictions["i"])
    duration = (predictions["t_j"] - predictions["t_i"]).to_numpy()
    # Time about t_i on an even grid s [s]: from where a fit's window begins to the longest prediction.
    origin = int(np.ceil(resonances.window_hours * HOUR / PHASE_STEP))
    s = PHASE_STEP * np.arange(-origin, int(np.ceil(duration.max() / PHASE_STEP)) + 1)
    place = duration / PHASE_STEP + origin
    low = np.minimum(place.astype(int), len(s) - 2)
    part = place - low
    table: dict[str, np.ndarray] = {}
    for pair in resonances.pairs:
        phase = _phases(started, predictions, row, pair, resonances.gm) @ np.stack([np.ones(len(s)), s, s**2])
        # Real and imaginary part are what cosine and sine of the phase do.
        moved = _without_line(_integral(_integral(np.exp(1j * phase), origin), origin), s)
        drift = (1.0 - part) * moved[row, low] + part * moved[row, low + 1]
        cosine, sine = columns([pair])
        table |= {cosine: drift.real, sine: drift.imag}
    return pd.DataFrame(table, index=predictions.index)


def _integral(f: np.ndarray, origin: int) -> np.ndarray:
    """Return the integral in time of f (n, grid) by the trapezoidal rule, zero at the origin of the grid."""
    integral = np.zeros_like(f)
    integral[:, 1:] = np.cumsum(0.5 * PHASE_STEP * (f[:, 1:] + f[:, :-1]), axis=1)
    return np.asarray(integral - integral[:, [origin]])


def _without_line(moved: np.ndarray, s: np.ndarray) -> np.ndarray:
    """Return values (n, grid) less the straight line through those of the window, where s is up to 0."""
    line, is_in_window = np.stack([np.ones(len(s)), s], axis=1), s <= 0.0
    # The least squares of a straight line, as a matrix from values in the window to the line everywhere.
    return moved - moved[:, is_in_window] @ (line @ np.linalg.pinv(line[is_in_window])).T


def _phases(
    started: pd.DataFrame, predictions: pd.DataFrame, row: np.ndarray, pair: tuple[int, int], gm: float
) -> np.ndarray:
    """Return coefficients (estimates, 3) of 1, s, s^2 of each estimate's phase, s [s] since its epoch.

    The parabola begins at the phase of the estimate and is fitted to the phases of its predictions.
    row: (predictions,) place in `started` of the estimate that each starts from
    """
    k, m = pair
    at_start, a = _phase(started[STATE].to_numpy(), started["t"].to_numpy(), pair, gm)
    at_end, _ = _phase(predictions[STATE].to_numpy(), predictions["t_j"].to_numpy(), pair, gm)
    rate = k * np.sqrt(gm / a**3) - m * EARTH_RATE
    s = (predictions["t_j"] - predictions["t_i"]).to_numpy()
    # What the phase is ahead of its rate at the start: slow, so unwrapping along the arc is safe.
    ahead = np.angle(np.exp(1j * (at_end - at_start[row] - rate[row] * s)))
    coefficients = np.zeros((len(started), 3))
    for n in range(len(started)):
        along = (row == n) & np.isfinite(ahead)
        basis = np.stack([s[along], s[along] ** 2], axis=1)
        scale = np.array([reach := s[along].max(initial=1.0), reach**2])
        slope = np.linalg.lstsq(basis / scale, np.unwrap(ahead[along]))[0] / scale
        coefficients[n] = [at_start[n], rate[n] + slope[0], slope[1]]
    return coefficients


def _phase(
    states: np.ndarray, t: np.ndarray, pair: tuple[int, int], gm: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return phase [rad] and semi-major axis [m] of GCRF states (n, 6).

    The Earth's turn is counted from the epoch.
    """
    k, m = pair
    coe = coe_from_cartesian(states, gm)
    return k * (coe[:, 3] + coe[:, 5]) + m * (coe[:, 4] - EARTH_RATE * t), coe[:, 0]
