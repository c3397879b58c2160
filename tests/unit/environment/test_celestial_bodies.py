"""Ephemerides against Orekit's DE430."""

import numpy as np
import pandas as pd
from support import EXCERPTS

from opml.base.constants import BODIES
from opml.environment import celestial_bodies

EPOCH = "2016-09-28T12:09:45"
REFERENCE = EXCERPTS / "ephemerides.csv"


def test_positions_are_orekits_but_for_the_step_from_de430_to_de440():
    # Differences as seen from Earth, relative to the distance: 6e-9 for the Moon (2 m), 1e-9 for Sun and
    # inner planets (what Earth's own place moved), 2e-7 for the outermost, whose orbits DE440 refitted.
    reference = pd.read_csv(REFERENCE, comment="#")
    ours = celestial_bodies.tabulate(EPOCH, reference["t"].to_numpy())
    far = {"moon": 1e-8, "jupiter": 5e-8, "uranus": 2e-7, "neptune": 2e-7, "pluto": 3e-7}
    limits = dict.fromkeys(BODIES, 2e-9) | far
    for body, limit in limits.items():
        columns = [f"{body}_{axis}" for axis in "xyz"]
        distance = np.linalg.norm(reference[columns], axis=1)
        assert (np.linalg.norm(ours[columns] - reference[columns], axis=1) / distance).max() < limit, body
