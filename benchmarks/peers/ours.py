"""opml's ensemble under the paper's assumed model."""

import numpy as np

from benchmarks import case
from benchmarks.case import Arcs
from opml import __version__
from opml.dynamics.ensemble import Integrator


class Opml:
    """The product as the workflow runs it."""

    title = f"opml {__version__}"
    model = "EGM2008 20x20, Sun, Moon, Jupiter (DE440), DTM2000 with MSAFE, radiation pressure with shadow"
    integrator = "Dormand-Prince 8(5,3), 0.1 m, at most 90 s; 16 arcs in lock step"
    share = 100

    def __init__(self):
        self.model = case.force_model("assumed")

    def fly(self, arcs: Arcs) -> np.ndarray:
        """At the paper's settings."""
        return case.fly(self.model, arcs)

    def fly_tightly(self, arcs: Arcs) -> np.ndarray:
        """In steps of at most five seconds, since shadow edges are stepped over."""
        return case.fly(self.model, arcs, integrator=Integrator(1e-6, 1e-4, 5.0))

    twin = fly
