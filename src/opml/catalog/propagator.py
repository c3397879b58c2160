"""An RSO under a force model, and its arcs."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any, Self

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike

from opml.base.section import JobSettings
from opml.dynamics import force_model
from opml.dynamics.ensemble import Arcs, Departures, propagate
from opml.dynamics.kernels.surroundings import ForceModel
from opml.dynamics.settings import ForceModelSettings, Integrator
from opml.orbits.elements import rsw_rotation
from opml.orbits.sheets import Rso

_LARGE = 21  # degree of the harmonics in the acceleration above which a gravity field is large
_NEAR = 8  # degree and order of the part of a large field that neighbours are propagated with
_STEP_NEAR = 300.0  # longest step of their integration at least [s]: this part of a field is smooth
Progress = Callable[[float], None]  # called with the share of the work that is done, from 0 to 1


def near_part(model: ForceModel) -> ForceModel:
    """Return the part of a force model with a large field that neighbours are propagated with."""
    return model.truncated(_NEAR).without_tides()


def neighbour_paths(path: np.ndarray, near: np.ndarray, neighbours: np.ndarray) -> np.ndarray:
    """Return the states (k, n, 6) of arcs that part from a path as neighbours do in the near part.

    path: (n, 6) under the whole field, GCRF [m, m/s]
    near, neighbours: (n, 6) the same path, and (k, n, 6) the arcs, under the near part

    The distance turns with the orbit, as it may be kilometres. At 430 km, over a week, arcs
    that drag or energy parts are off by up to 0.0003 of their distance, others on one orbit by up to 0.004.
    """
    turn = rsw_rotation(path).swapaxes(-1, -2) @ rsw_rotation(near)
    offsets = (neighbours - near).reshape(len(neighbours), -1, 2, 3)
    return path + (offsets @ turn.swapaxes(-1, -2)).reshape(neighbours.shape)


class PropagatorSettings(JobSettings):
    """Settings of a job that propagates an RSO."""

    epoch: str
    force_model: ForceModelSettings
    integrator: Integrator
    rso: Rso


@dataclass(frozen=True)
class Propagator:
    """An RSO under a force model, and how it is integrated.

    Area, mass and Cr of all arcs are the RSO's. threads: number that arcs are propagated on; progress: called
    with the share of the work that is done, if not None; propagate_arcs: as `ensemble.propagate`; near: the
    part of the model that neighbours are propagated with, where it is made already.
    """

    model: ForceModel
    rso: Rso
    integrator: Integrator = field(default_factory=Integrator)
    threads: int = 1
    progress: Progress | None = None
    propagate_arcs: Callable[..., Arcs] = propagate
    near: ForceModel | None = None

    @classmethod
    def read(
        cls, files: Any, settings: PropagatorSettings, *, threads: int = 1, progress: Progress | None = None
    ) -> Self:
        """Read the propagator of a job.

        files: the job's input, with the tables of the environment. Raises InputError where a table is missing
        or damaged.
        """
        model = force_model.read(files, epoch=settings.epoch, settings=settings.force_model)
        return cls(model, settings.rso, settings.integrator, threads, progress)

    def for_neighbours(self) -> Self:
        """Return the propagator of arcs of which only the distance from a neighbour is wanted.

        Neighbours part under the first degrees of a large field as they do under all of it. A small field
        stays as it is: to propagate the arc with them once more would cost as much as it saves.
        """
        if self.model.degree <= _LARGE:
            return self
        longer = self.integrator.evolve(max_step_s=max(self.integrator.max_step_s, _STEP_NEAR))
        return replace(self.under(self.near or near_part(self.model)), integrator=longer)

    def under(self, model: ForceModel) -> Self:
        """Return this propagator under another force model."""
        return replace(self, model=model, near=None)

    def without_progress(self) -> Self:
        """Return this propagator for work whose caller reports the progress itself."""
        return replace(self, progress=None)

    def propagate(
        self,
        epochs: ArrayLike,
        states: np.ndarray,
        *,
        cd: np.ndarray | float,
        first: ArrayLike,
        last: ArrayLike,
        outlook: np.ndarray | None = None,
    ) -> Arcs:
        """Propagate arcs, each with its own drag coefficient.

        epochs: (n,) times [s], ascending or descending
        cd: (arcs,) or one for all
        first, last: (arcs,) index of the epoch at which an arc begins and ends
        outlook: (arcs,) as in `ensemble.Departures`
        """
        count = len(states)
        departures = Departures(
            states,
            first=first,
            last=last,
            ballistic=np.full(count, cd) * self.rso.area_to_mass,
            reflection=np.full(count, self.rso.cr * self.rso.area_to_mass),
            outlook=outlook,
        )
        return self.propagate_arcs(
            self.model,
            epochs,
            departures,
            integrator=self.integrator,
            threads=self.threads,
            progress=self.progress,
        )

    def propagate_pairs(
        self, pairs: pd.DataFrame, states: np.ndarray, *, cd: np.ndarray, outlook: np.ndarray | None = None
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return (states, status) at t_j of pairs (n,), of one arc per estimate i that begins at t_i.

        pairs: rows of i, t_i and t_j in the order of i
        states: (arcs, 6) GCRF [m, m/s] in the order of i; of several families of arcs one behind the other
        cd: (arcs,) as the states
        outlook: (arcs,) as in `ensemble.Departures`

        The states returned are (n, 6) in GCRF, not finite where an arc does not reach; the status (n,) is an
        index into `ensemble.REASONS`. Of several families they are one behind the other.
        """
        epochs = np.unique(pairs[["t_i", "t_j"]])
        arc = np.unique(pairs["i"], return_inverse=True)[1]
        by_arc = pairs.groupby("i", sort=True)
        first = np.searchsorted(epochs, by_arc["t_i"].first())
        last = np.searchsorted(epochs, by_arc["t_j"].max())
        families = len(states) // len(first)
        ends = {"first": np.tile(first, families), "last": np.tile(last, families)}
        arcs = self.propagate(epochs, states, cd=cd, outlook=outlook, **ends)
        passed = np.searchsorted(epochs, pairs["t_j"]) - first[arc] - 1
        arc = (arc + len(first) * np.arange(families)[:, None]).ravel()
        return arcs.states[arcs.start[arc] + np.tile(passed, families)], arcs.status[arc]
