"""Rotation from GCRF to ITRF at many times."""

import numpy as np
import pandas as pd
from support import EXCERPTS

from opml.base.constants import DAY, EARTH_RATE
from opml.dynamics.frames import gcrf_to_itrf


def test_rotations_are_orekits(earth_orientation):
    cases = pd.read_csv(EXCERPTS / "earth_orientation.csv", comment="#")
    expected = cases[[f"r{i}{j}" for i in range(3) for j in range(3)]].to_numpy().reshape(-1, 3, 3)
    assert np.abs(gcrf_to_itrf(earth_orientation, cases["t"].to_numpy()) - expected).max() < 1e-10


def test_rotations_are_orthonormal_and_do_not_depend_on_their_company(earth_orientation):
    t = np.random.default_rng(1).uniform(0.0, 50 * DAY, 200)
    rotations = gcrf_to_itrf(earth_orientation, t)
    assert rotations.shape == (200, 3, 3)
    identities = np.einsum("nij,nkj->nik", rotations, rotations)
    assert np.abs(identities - np.eye(3)).max() < 2e-15
    np.testing.assert_allclose(np.linalg.det(rotations), 1.0, rtol=0.0, atol=2e-15)
    np.testing.assert_array_equal(gcrf_to_itrf(earth_orientation, t[7:8])[0], rotations[7])


def test_a_station_moves_eastward(earth_orientation):
    t = np.array([0.0, 10.0])
    place = np.einsum("nij,i->nj", gcrf_to_itrf(earth_orientation, t), [6.4e6, 0.0, 0.0])
    velocity = (place[1] - place[0]) / 10.0
    np.testing.assert_allclose(velocity, np.cross([0.0, 0.0, EARTH_RATE], place.mean(axis=0)), atol=1.0)
