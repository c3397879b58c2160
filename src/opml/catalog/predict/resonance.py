"""Along-track drift by the harmonics of the Earth's field that the assumed model leaves out.

Of all harmonics beyond its degree, those matter that an orbit meets again and again in nearly the same phase:
k (w + M) + m (W - theta) turns slowly, as m revolutions take about k turns of the Earth below the node. For
each such pair the harmonics of all degrees act together as one along-track acceleration, A cos + B sin of
that phase, with lumped coefficients A and B (Kaula 1966, Theory of Satellite Geodesy; King-Hele 1987,
Satellite Orbits in an Atmosphere, on resonance). They belong to the field, the inclination and the height,
not to
an arc, so they can be learned. This module gives what they multiply.
"""

from collections.abc import Sequence

import numpy as np
import pandas as pd

from opml.base.constants import EARTH_RATE, HOUR
from opml.orbits.elements import coe_from_cartesian
from opml.tables import STATE

STEP = 1800.0
"""Step of the sums that replace integrals [s]: about a hundred per turn of the fastest phase, two days."""


def columns(pairs: Sequence[tuple[int, int]]) -> list[str]:
    """Names of the columns of `drifts`, two per pair (k, m)."""
    return [f"{part}_{k}_{m}" for k, m in pairs for part in ("cos", "sin")]


def drifts(
    estimates: pd.DataFrame,
    predictions: pd.DataFrame,
    *,
    pairs: Sequence[tuple[int, int]],
    window_hours: float,
    gm: float,
) -> pd.DataFrame:
    """Along-track drift [s2] of each prediction per unit of a lumped acceleration, in `columns(pairs)`.

    A prediction that lacks an acceleration a(t) drifts off by y, y'' = 3 a (the factor is left to the
    coefficient: a drift forwards costs height and so falls behind). The fit over the window before t_i has
    met the same y and put a straight line through it, from which the prediction goes on; so the line is taken
    off. Its curvature is not: that went into Cd, and V (Cd - c) has it. The phase is that of the prediction
    itself, a parabola in time through its pairs. gm [m3/s2] is for the elements.
    """
    reach = float((predictions["t_j"] - predictions["t_i"]).max())
    before = int(np.ceil(window_hours * HOUR / STEP))
    grid = STEP * np.arange(-before, int(np.ceil(reach / STEP)) + 1)
    window = grid <= 0.0
    line = np.stack([np.ones(len(grid)), grid], axis=1)
    through_window = line @ np.linalg.pinv(line[window])

    started = estimates.set_index("track").loc[predictions["i"].unique()]
    row = pd.Index(started.index).get_indexer(predictions["i"])
    place = (predictions["t_j"] - predictions["t_i"]).to_numpy() / STEP + before
    low = np.minimum(place.astype(int), len(grid) - 2)
    found: dict[str, np.ndarray] = {}
    for (k, m), names in zip(pairs, np.reshape(columns(pairs), (-1, 2)), strict=True):
        phase = _phases(started, predictions, row, k, m, gm) @ np.stack([np.ones(len(grid)), grid, grid**2])
        moved = _twice_integrated(np.exp(1j * phase), origin=before)
        moved = moved - moved[:, window] @ through_window[:, : window.sum()].T
        part = place - low
        drift = (1.0 - part) * moved[row, low] + part * moved[row, low + 1]
        found |= {names[0]: drift.real, names[1]: drift.imag}
    return pd.DataFrame(found, index=predictions.index)


def _twice_integrated(f: np.ndarray, *, origin: int) -> np.ndarray:
    """Double integral in time of f (n, grid), zero with its slope at the grid's index `origin`."""
    speed = np.zeros_like(f)
    speed[:, 1:] = np.cumsum(0.5 * STEP * (f[:, 1:] + f[:, :-1]), axis=1)
    speed -= speed[:, [origin]]
    moved = np.zeros_like(f)
    moved[:, 1:] = np.cumsum(0.5 * STEP * (speed[:, 1:] + speed[:, :-1]), axis=1)
    moved -= moved[:, [origin]]
    return moved


def _phases(
    started: pd.DataFrame, predictions: pd.DataFrame, row: np.ndarray, k: int, m: int, gm: float
) -> np.ndarray:
    """Coefficients (estimates, 3) of 1, s, s^2 of each estimate's phase, s [s] since its epoch."""
    at_start, a = _phase(started[STATE].to_numpy(), started["t"].to_numpy(), k, m, gm)
    at_end, _ = _phase(predictions[STATE].to_numpy(), predictions["t_j"].to_numpy(), k, m, gm)
    rate = k * np.sqrt(gm / a**3) - m * EARTH_RATE
    s = (predictions["t_j"] - predictions["t_i"]).to_numpy()
    # What the phase is ahead of its rate at the start: slow, so unwrapping along the arc is safe.
    ahead = np.angle(np.exp(1j * (at_end - at_start[row] - rate[row] * s)))
    found = np.zeros((len(started), 3))
    for n in range(len(started)):
        own = (row == n) & np.isfinite(ahead)
        basis = np.stack([s[own], s[own] ** 2], axis=1)
        scale = np.array([reach := s[own].max(initial=1.0), reach**2])
        slope = np.linalg.lstsq(basis / scale, np.unwrap(ahead[own]))[0] / scale
        found[n] = [at_start[n], rate[n] + slope[0], slope[1]]
    return found


def _phase(states: np.ndarray, t: np.ndarray, k: int, m: int, gm: float) -> tuple[np.ndarray, np.ndarray]:
    """Phase [rad], the Earth's turn counted from the epoch, and semi-major axis [m] of GCRF states (n, 6)."""
    coe = coe_from_cartesian(states, gm)
    return k * (coe[:, 3] + coe[:, 5]) + m * (coe[:, 4] - EARTH_RATE * t), coe[:, 0]
