"""Forces that a force model may have or not: those that it has are added to its acceleration, in their order.

A force is a kernel of the parameters of `relativity` below. What it needs of time is in columns of its own,
which `opml.dynamics.forces` tabulates.
"""

from collections.abc import Callable, Iterable
from functools import reduce
from typing import Any

from opml.dynamics.kernels import relativity as general_relativity
from opml.dynamics.kernels.lanes import compiled
from opml.dynamics.kernels.surroundings import AXIS, BODIES

OFF = -1  # in the place of a force's first column, where a model is without the force


@compiled
def relativity(state, reflection, model, values, own):
    """Return the acceleration by general relativity in GCRF [m/s2].

    state: position [m], velocity [m/s] and 1/r [1/m] in GCRF, seven lanes
    reflection: Cr times area over mass [m2/kg]
    values: from `surroundings.look_up` at the same time
    own: the columns of the force at that time; here the precession of velocities
    """
    x, y, z, vx, vy, vz, inverse_r = state
    axis = values[AXIS : AXIS + 3]
    return general_relativity.relativity(x, y, z, vx, vy, vz, inverse_r, model.gm, axis, own)


FORCES: dict[str, Callable[..., Any]] = {"relativity": relativity}
"""Kernels of forces, by their names in the settings."""


def sum_of(forces: Iterable[Callable[..., Any]]) -> Callable[..., Any]:
    """Return the kernel that adds to a total those of some forces that a model has."""
    return reduce(_with, enumerate(forces), _nothing)


@compiled
def _nothing(state, reflection, model, values, total):
    return total


def _with(others: Callable[..., Any], added: tuple[int, Callable[..., Any]]) -> Callable[..., Any]:
    """Return the kernel of others and one force more, with its index: Numba unrolls no list of kernels."""
    index, force = added

    @compiled
    def total_of(state, reflection, model, values, total):
        ax, ay, az = others(state, reflection, model, values, total)
        if model.added[index] != OFF:
            own = values[BODIES + model.bodies.shape[1] + model.added[index] :]
            bx, by, bz = force(state, reflection, model, values, own)
            ax, ay, az = ax + bx, ay + by, az + bz
        return ax, ay, az

    return total_of
