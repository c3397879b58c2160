"""The true orbits of RSOs: one arc of each under the truth model."""

from collections.abc import Sequence

import numpy as np
import pandas as pd

from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.catalog.propagator import Propagator
from opml.dynamics.ensemble import REASONS, Departures, propagate
from opml.orbits.elements import cartesian_from_coe, true_from_mean_anomaly
from opml.orbits.sheets import Rso
from opml.orbits.state_polynomials import FEWEST, StatePolynomials
from opml.tables import STATE

_LONGEST = 60.0
"""Longest time between two states that are integrated, the others lie on the polynomials through them [s].

Integrated every 20 s instead, the paper's orbits are the same to 4 mm after a week, to 10 cm after 50 days.
"""

_GAP = 1.5  # steps of a truth's grid that make a gap


def initial_state(rso: Rso, gm: float) -> np.ndarray:
    """Return the GCRF state (6,) [m, m/s] of an RSO's osculating elements at the epoch; gm [m3/s2].

    Source: the paper's table of RSOs.
    """
    nu = float(true_from_mean_anomaly(np.array(rso.mean_anomaly), np.array(rso.e)))
    return cartesian_from_coe(np.array([rso.a, rso.e, rso.i, rso.argp, rso.raan, nu]), gm)


def simulate(propagator: Propagator, *, duration: float, step: float) -> pd.DataFrame:
    """Return the `truth` table of a propagator's RSO: GCRF states every `step` to `duration` [s].

    propagator: under the true model. Raises InputError where it does not stay in orbit that long. Source:
    paper, sec. Truth Dynamic Models.
    """
    [table] = simulate_together(propagator, [], duration=duration, step=step)
    return table


def simulate_together(
    propagator: Propagator, others: Sequence[Rso], *, duration: float, step: float
) -> list[pd.DataFrame]:
    """Return the `truth` tables of a propagator's RSO and of others, in about the time of one.

    Each table is that of `simulate`, to the bit.
    """
    rsos = [propagator.rso, *others]
    t = np.arange(0.0, duration + 0.5 * step, step)
    starts = np.array([initial_state(rso, propagator.model.gm) for rso in rsos])
    is_node = _are_nodes(len(t), step)
    nodes = t[is_node]
    departures = Departures(
        starts,
        first=[0] * len(rsos),
        last=[len(nodes) - 1] * len(rsos),
        ballistic=[rso.cd * rso.area_to_mass for rso in rsos],
        reflection=[rso.cr * rso.area_to_mass for rso in rsos],
    )
    arcs = propagate(
        propagator.model,
        nodes,
        departures,
        integrator=propagator.integrator,
        threads=propagator.threads,
        progress=propagator.progress,
    )
    for k, rso in enumerate(rsos):
        if reason := REASONS[arcs.status[k]]:
            reached = nodes[np.isfinite(arcs.path(k)[:, 0]).sum()] / DAY
            raise InputError(
                f"{rso.name}: expected an orbit that lasts {t[-1] / DAY:g} days, "
                f"but it {reason} after {reached:.2f} days"
            )
    paths = (np.vstack([start, arcs.path(k)]) for k, start in enumerate(starts))
    return [_table(t, is_node, path) for path in paths]


def _are_nodes(count: int, step: float) -> np.ndarray:
    """Return which of epochs (count,) of a regular grid are integrated: the first, the last, some between."""
    every = max(int(_LONGEST // step), 1)
    rows = np.arange(count)
    return np.asarray((rows % every == 0) | (rows == count - 1) | (count < FEWEST * every))


def _table(t: np.ndarray, is_node: np.ndarray, path: np.ndarray) -> pd.DataFrame:
    """Return the `truth` table at times (n,) of an orbit's states at those (m, 6) that are integrated."""
    states = np.empty((len(t), 6))
    states[is_node] = path
    if not is_node.all():
        states[~is_node] = StatePolynomials(t[is_node], path).at(t[~is_node])
    return pd.DataFrame({"t": t, **dict(zip(STATE, states.T, strict=True))})


def interpolate(truth: pd.DataFrame, t: np.ndarray) -> np.ndarray:
    """Return true states (n, 6) at times t (n,) [s] off a truth's grid, NaN outside it or in a gap.

    Cubic in time: 5 mm off in a low orbit between epochs every 20 s.
    """
    from scipy.interpolate import CubicHermiteSpline  # takes half a second to import, and few jobs need it

    grid, states = truth["t"].to_numpy(), truth[STATE].to_numpy()
    path = CubicHermiteSpline(grid, states[:, :3], states[:, 3:], extrapolate=False)
    after = np.clip(np.searchsorted(grid, t), 1, len(grid) - 1)
    is_gap = grid[after] - grid[after - 1] > _GAP * np.diff(grid).min()
    interpolated: np.ndarray = np.hstack([path(t), path(t, 1)])
    return np.where(is_gap[:, None], np.nan, interpolated)
