"""Orekit through orekit-jpype, as the paper used it: https://www.orekit.org, Apache-2.0."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from benchmarks import case
from benchmarks.case import Arcs
from opml.dynamics.ensemble import Integrator
from validation import orekit


class Orekit:
    """The paper's own tool and settings; its data come from a folder that the user has."""

    title = f"Orekit {'.'.join(orekit.version().split('.')[:3])}"
    model = "EIGEN-6S 20x20, Sun, Moon, Jupiter (DE430), DTM2000 with MSAFE, radiation pressure with shadow"
    integrator = "Dormand-Prince 8(5,3), 0.1 m, at most 90 s (the paper's settings)"
    share = 2

    def __init__(self, data: Path):
        self.data = orekit.Data.find(data)
        orekit.start(self.data)
        self.models = orekit.Orekit(case.paper().epoch)
        self.field = str(self.data.path("gravity field"))

    def fly(self, arcs: Arcs) -> np.ndarray:
        """At the paper's settings."""
        return self._fly(arcs, case.paper().integrator)

    def fly_tightly(self, arcs: Arcs) -> np.ndarray:
        """In steps of at most fifteen seconds; Orekit stops at the edges of the shadow."""
        return self._fly(arcs, Integrator(1e-6, 1e-4, 15.0))

    def _fly(self, arcs, integrator):
        rso = case.paper().rsos["iss"]
        rso = replace(rso, cd=arcs.ballistic / rso.area_to_mass, cr=arcs.reflection / rso.area_to_mass)
        forces = self.models.forces(case.paper().force_models["assumed"], rso)
        gm = self.models.field(0, 0).getMu()
        return np.array(
            [
                self.models.propagate(state, gm, [t + arcs.duration], forces, integrator, begin=t)[-1]
                for t, state in zip(arcs.t, arcs.states, strict=True)
            ]
        )

    def twin(self, arcs: Arcs) -> np.ndarray:
        """Ours on the same gravity field."""
        return case.fly(case.force_model("assumed", field=self.field), arcs)
