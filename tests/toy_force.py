"""A force that is declared as any other, in a process of its own: a heavier Earth.

    python tests/toy_force.py

Prints where an orbit is after a day with it, and under an Earth of that mass, as JSON.
"""

import json

import numpy as np

from opml.dynamics.kernels import added_forces
from opml.dynamics.kernels.lanes import compiled

NAME = "heavier"
SHARE = 1e-6  # of the Earth's mass that the force adds


@compiled
def heavier(state, reflection, model, values, own):
    """The pull of more mass at the Earth's centre; its column has the mass, as GM."""
    x, y, z, _, _, _, inverse_r = state
    pull = -own[0] * inverse_r * inverse_r * inverse_r
    return pull * x, pull * y, pull * z


added_forces.FORCES[NAME] = heavier


def main():
    """Fly the orbit with the force and without it."""
    from opml.dynamics import forces, settings

    forces.TABULATED[NAME] = lambda environment: np.full(
        (len(environment.ephemerides), 1), SHARE * environment.gm
    )
    settings.FORCES[NAME] = "a heavier Earth"

    from support import surroundings

    from opml.dynamics.ensemble import Departures, propagate

    def end(model):
        state = [7e6, 0.0, 0.0, 0.0, 5e3, 5.5e3]
        arcs = Departures([state], first=[0], last=[1], ballistic=[0.0], reflection=[0.0])
        tight = settings.Integrator(position_tolerance_m=1e-6)
        return propagate(model, [0.0, 86400.0], arcs, integrator=tight).states[-1].tolist()

    def model(names):
        values = {"degree": 0, "order": 0, "third_bodies": [], "forces": names}
        return forces.build(surroundings("EGM2008"), settings.ForceModelSettings.read(values, "model"))

    alone, beside = model([NAME]), model(["relativity", NAME])
    without, with_relativity = model([]), model(["relativity"])
    mass = without.gm * (1.0 + SHARE)
    print(
        json.dumps(
            {
                "added": end(alone),
                "in the mass": end(without._replace(gm=mass)),
                "left out": end(without),
                "added beside relativity": end(beside),
                "in the mass beside relativity": end(with_relativity._replace(gm=mass)),
            }
        )
    )


if __name__ == "__main__":
    main()
