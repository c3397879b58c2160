"""The true orbit of an RSO: one arc under the truth model."""

from collections.abc import Callable

import numpy as np
import pandas as pd

from opml.catalog.flying import fly
from opml.constants import DAY
from opml.dynamics.ensemble import REASONS, Integrator
from opml.dynamics.surroundings import ForceModel
from opml.elements import cartesian_from_coe, true_from_mean_anomaly
from opml.errors import InputError
from opml.sheets import Rso
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
    t = np.arange(0.0, duration + 0.5 * step, step)
    start = initial_state(rso, model.gm)
    last = [len(t) - 1]
    arcs = fly(
        model, rso, t, start[None], cd=rso.cd, first=[0], last=last, integrator=integrator, progress=progress
    )
    if arcs.status[0]:
        flown = np.isfinite(arcs.states[:, 0]).sum() * step / DAY
        raise InputError(
            f"{rso.name}: expected an orbit that lasts {duration / DAY:g} days, "
            f"but it {REASONS[arcs.status[0]]} after {flown:.2f} days"
        )
    states = np.vstack([start, arcs.of(0)])
    return pd.DataFrame({"t": t, **dict(zip(STATE, states.T, strict=True))})
