"""Arcs of an RSO under a force model: what its body feels, as the ensemble takes it."""

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from opml.dynamics.ensemble import Arcs, Integrator, propagate
from opml.dynamics.surroundings import ForceModel
from opml.sheets import Rso


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


def part_of(
    progress: Callable[[float], None] | None, part: int, parts: int
) -> Callable[[float], None] | None:
    """Progress of one of several equal parts."""
    return progress and (lambda share: progress((part + share) / parts))
