"""Arcs of an RSO under a force model: what its body feels, as the ensemble takes it."""

from collections.abc import Callable

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike

from opml.dynamics.ensemble import Arcs, Integrator, propagate
from opml.dynamics.kernels.surroundings import ForceModel
from opml.orbits.sheets import Rso


def fly(
    model: ForceModel,
    rso: Rso,
    epochs: ArrayLike,
    states: np.ndarray,
    *,
    cd: np.ndarray | float,
    first: ArrayLike,
    last: ArrayLike,
    integrator: Integrator,
    threads: int = 1,
    progress: Callable[[float], None] | None = None,
) -> Arcs:
    """Propagate arcs of an RSO, each with its own drag coefficient; the rest is as in `ensemble.propagate`.

    states: (arcs, 6) GCRF [m, m/s]; cd: (arcs,), or one for all. Area, mass and Cr are the RSO's.
    """
    count = len(states)
    return propagate(
        model,
        epochs,
        states,
        first=first,
        last=last,
        ballistic=np.full(count, cd) * rso.area_to_mass,
        reflection=np.full(count, rso.cr * rso.area_to_mass),
        integrator=integrator,
        threads=threads,
        progress=progress,
    )


def fly_pairs(
    model: ForceModel,
    rso: Rso,
    pairs: pd.DataFrame,
    states: np.ndarray,
    *,
    cd: np.ndarray,
    integrator: Integrator,
    threads: int = 1,
    progress: Callable[[float], None] | None = None,
) -> tuple[np.ndarray, np.ndarray]:
    """(states, status) at t_j of pairs (n,), of one arc per estimate i that begins at t_i.

    pairs: rows of i, t_i and t_j in the order of i; states: (arcs, 6) GCRF [m, m/s] and cd: (arcs,), in the
    order of i. Returns GCRF states (n, 6), not finite where an arc does not reach, and indices (n,) into
    `ensemble.REASONS`.
    """
    epochs = np.unique(pairs[["t_i", "t_j"]])
    arc = np.unique(pairs["i"], return_inverse=True)[1]
    of_arc = pairs.groupby("i", sort=True)
    first = np.searchsorted(epochs, of_arc["t_i"].first())
    last = np.searchsorted(epochs, of_arc["t_j"].max())
    arcs = fly(
        model,
        rso,
        epochs,
        states,
        cd=cd,
        first=first,
        last=last,
        integrator=integrator,
        threads=threads,
        progress=progress,
    )
    place = arcs.start[arc] + np.searchsorted(epochs, pairs["t_j"]) - first[arc] - 1
    return arcs.states[place], arcs.status[arc]


def part_of(
    progress: Callable[[float], None] | None, part: int, parts: int
) -> Callable[[float], None] | None:
    """Progress of one of several equal parts."""
    return progress and (lambda share: progress((part + share) / parts))
