"""Orekit's batch least squares; see `benchmarks.peers.orekit`."""

import numpy as np

from benchmarks import case, windows
from benchmarks.peers.orekit import Models
from benchmarks.windows import Answers, Windows
from opml.catalog.fit.least_squares import Fit
from opml.tables import STATE
from validation import estimation


class Orekit(Models):
    """Its `BatchLSEstimator` as it comes: measurements with light time, as it has none without."""

    model = (
        "EIGEN-6S 20x20, Sun, Moon, Jupiter (DE430), DTM2000 with MSAFE, radiation pressure with shadow; "
        "light time"
    )
    method = "state and Cd, variational equations"
    way = "Gauss-Newton, steps ≤ 90 s"
    share = 1

    def prepare(self, fitted: Windows) -> None:
        """Find out nothing: the settings are known."""

    def fit(self, fitted: Windows) -> Answers:
        """Fit state and Cd."""
        paper = case.paper()
        problem = estimation.Problem(self.models, paper, paper.rsos["iss"], self.gm, paper.integrator)
        found = [
            problem.fit(t, start, problem.measurements(fitted.rows(number)))
            for number, (t, start) in enumerate(zip(fitted.t, fitted.starts, strict=True))
        ]
        return Answers(
            np.array([[one[name] for name in STATE] for one in found]),
            np.array([one["iterations"] for one in found]),
        )

    def twin(self, fitted: Windows) -> list[Fit]:
        """Fit by ours on the same gravity field, with light time."""
        return windows.fit(case.force_model("assumed", field=self.field), fitted, light_time=True)
