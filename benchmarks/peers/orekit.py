"""Orekit through orekit-jpype, as the paper used it: https://www.orekit.org, Apache-2.0."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from benchmarks import case
from benchmarks.case import Arcs
from benchmarks.peers.settings import step_limits
from validation import orekit


def _to_edges(*limits):
    """Return the settings whose steps also end at the edges of the shadow, by what a report calls them."""
    return {f"{name}, edges": integrator for name, integrator in step_limits(*limits).items()}


class Models:
    """The paper's own tool; its data come from a folder that the user has."""

    title = f"Orekit {'.'.join(orekit.version().split('.')[:3])}"

    def __init__(self, data: Path):
        found = orekit.Data.find(data)
        orekit.start(found)
        self.models = orekit.Orekit(case.paper().epoch)
        self.field = str(found.path("gravity field"))
        self.gm = self.models.field(0, 0).getMu()


class Orekit(Models):
    """Orekit's propagation at the paper's settings."""

    model = "EIGEN-6S 20x20, Sun, Moon, Jupiter (DE430), DTM2000 with MSAFE, radiation pressure with shadow"
    method = "Dormand-Prince 8(5,3)"
    way = "tolerance 0.1 m (the paper's settings), stops at midnights"
    settings = step_limits(300.0, 180.0, 120.0, 90.0, 30.0)
    raced = "≤ 90 s"
    tight = _to_edges(90.0, 60.0)
    pressure = True
    share = sample = 2

    def fly(self, arcs: Arcs, setting: str) -> np.ndarray:
        """Fly at one of the settings."""
        propagate = self.models.propagate_by_edges if setting in self.tight else self.models.propagate
        integrator = (self.settings | self.tight)[setting]
        forces = self._forces(arcs)
        return np.array(
            [
                propagate(state, self.gm, arcs.stops(t), forces, integrator, begin=t)[-1]
                for t, state in zip(arcs.t, arcs.states, strict=True)
            ]
        )

    def _forces(self, arcs):
        rso = case.paper().rsos["iss"]
        rso = replace(rso, cd=arcs.ballistic / rso.area_to_mass, cr=arcs.reflection / rso.area_to_mass)
        return self.models.forces(case.paper().force_models["assumed"], rso)

    def twin(self, arcs: Arcs) -> np.ndarray:
        """Fly ours on the same gravity field."""
        return case.fly(case.force_model("assumed", field=self.field), arcs)
