"""The true orbits of RSOs: one arc of each under the truth model."""

from collections.abc import Callable, Sequence

import numpy as np
import pandas as pd

from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.dynamics.ensemble import REASONS, Arcs, Integrator, propagate
from opml.dynamics.kernels.surroundings import ForceModel
from opml.orbits.elements import cartesian_from_coe, true_from_mean_anomaly
from opml.orbits.sheets import Rso
from opml.tables import STATE


def initial_state(rso: Rso, gm: float) -> np.ndarray:
    """GCRF state (6,) [m, m/s] at the epoch, from the RSO's osculating elements (paper, table of RSOs)."""
    nu = float(true_from_mean_anomaly(np.array(rso.mean_anomaly), np.array(rso.e)))
    return cartesian_from_coe(np.array([rso.a, rso.e, rso.i, rso.argp, rso.raan, nu]), gm)


def simulate(
    model: ForceModel,
    rso: Rso,
    *,
    duration: float,
    step: float,
    integrator: Integrator,
    progress: Callable[[float], None] | None = None,
) -> pd.DataFrame:
    """The `truth` table of an RSO: GCRF states every `step` from the epoch to `duration` [s].

    model: the true one. Raises InputError where the RSO does not stay in
    orbit that long (paper, sec. Truth Dynamic Models).
    """
    [table] = simulate_together(
        model, [rso], duration=duration, step=step, integrator=integrator, progress=progress
    )
    return table


def simulate_together(
    model: ForceModel,
    rsos: Sequence[Rso],
    *,
    duration: float,
    step: float,
    integrator: Integrator,
    threads: int = 1,
    progress: Callable[[float], None] | None = None,
) -> list[pd.DataFrame]:
    """The `truth` tables of RSOs that fly side by side, each as `simulate` gives it, in less time."""
    t = np.arange(0.0, duration + 0.5 * step, step)
    starts = np.array([initial_state(rso, model.gm) for rso in rsos])
    arcs = propagate(
        model,
        t,
        starts,
        first=[0] * len(rsos),
        last=[len(t) - 1] * len(rsos),
        ballistic=[rso.cd * rso.area_to_mass for rso in rsos],
        reflection=[rso.cr * rso.area_to_mass for rso in rsos],
        integrator=integrator,
        threads=threads,
        progress=progress,
    )
    return [_table(rso, t, start, arcs, k) for k, (rso, start) in enumerate(zip(rsos, starts, strict=True))]


def _table(rso: Rso, t: np.ndarray, start: np.ndarray, arcs: Arcs, arc: int) -> pd.DataFrame:
    """The table of one arc; raises InputError where it was retired."""
    if arcs.status[arc]:
        flown = np.isfinite(arcs.of(arc)[:, 0]).sum() * t[1] / DAY
        raise InputError(
            f"{rso.name}: expected an orbit that lasts {t[-1] / DAY:g} days, "
            f"but it {REASONS[arcs.status[arc]]} after {flown:.2f} days"
        )
    states = np.vstack([start, arcs.of(arc)])
    return pd.DataFrame({"t": t, **dict(zip(STATE, states.T, strict=True))})
