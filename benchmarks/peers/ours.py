"""opml's ensemble under the paper's assumed model."""

import numpy as np

from benchmarks import case
from benchmarks.case import Arcs
from benchmarks.peers.settings import step_limits
from opml import __version__


class Opml:
    """The product as the workflow runs it."""

    title = f"opml {__version__}"
    model = "EGM2008 20x20, Sun, Moon, Jupiter (DE440), DTM2000 with MSAFE, radiation pressure with shadow"
    method = "Dormand-Prince 8(5,3)"
    way = "tolerance 0.1 m, 16 arcs in lock step"
    settings = step_limits(300.0, 240.0, 180.0, 120.0, 90.0)
    raced = "≤ 90 s"
    tight = step_limits(20.0, 10.0)
    pressure = True
    share = sample = 100

    def __init__(self):
        self.forces = case.force_model("assumed")

    def fly(self, arcs: Arcs, setting: str) -> np.ndarray:
        """Fly at one of the settings."""
        return case.fly(self.forces, arcs, integrator=(self.settings | self.tight)[setting])

    def twin(self, arcs: Arcs) -> np.ndarray:
        """Fly at the paper's settings."""
        return self.fly(arcs, self.raced)
