"""Rotation from GCRF to ITRF at many times."""

import numpy as np
import pandas as pd
from support import EXCERPTS

from opml.dynamics.frames import gcrf_to_itrf


def test_rotations_are_orekits(earth_orientation):
    cases = pd.read_csv(EXCERPTS / "earth_orientation.csv", comment="#")
    expected = cases[[f"r{i}{j}" for i in range(3) for j in range(3)]].to_numpy().reshape(-1, 3, 3)
    assert np.abs(gcrf_to_itrf(earth_orientation, cases["t"].to_numpy()) - expected).max() < 1e-10
