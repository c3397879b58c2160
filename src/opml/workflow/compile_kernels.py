"""Compile the kernels that a first figure needs when opml is installed: else all jobs wait for the first."""

import numpy as np

from opml.base.constants import HOUR
from opml.dynamics.ensemble import Departures, propagate
from opml.dynamics.forces import build, tabulated
from opml.dynamics.frames import gcrf_to_itrf
from opml.dynamics.settings import ForceModelSettings, Integrator
from opml.environment import nodes, solar_activity
from opml.learning.models import smo

_EPOCH = "2016-09-28T12:00:00"


def compile_kernels() -> None:
    """Call each kernel of propagations, frames and the SVR with the least it takes; the cache keeps them."""
    t = nodes(_EPOCH, HOUR)
    activity = solar_activity.tabulate("MSAFE", _EPOCH, t, 50)
    environment = tabulated(_EPOCH, t, activity, gravity="EGM2008", degree=2)
    model = build(environment, ForceModelSettings(degree=2, order=2, third_bodies=["sun"]))
    arc = Departures(
        [[7e6, 0.0, 0.0, 0.0, 7.5e3, 0.0]], first=[0], last=[1], ballistic=[0.01], reflection=[0.01]
    )
    propagate(model, [0.0, 60.0], arc, integrator=Integrator())
    gcrf_to_itrf(environment.earth_orientation, t)
    smo.solve(np.array([[0.0], [1.0], [2.0]]), np.array([0.0, 1.0, 3.0]), np.ones(3), epsilon=0.01, tol=1e-3)


if __name__ == "__main__":
    compile_kernels()
