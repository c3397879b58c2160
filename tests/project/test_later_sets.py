"""Later sets against an orbit: what a shift of the orbit changes, and what it does not."""

import numpy as np
import pytest
from catalogue_files import FIRST_DAY, write_sets

from opml.base.constants import DAY
from opml.conjunctions.screening import EPOCH
from opml.element_sets import catalogue
from opml.element_sets.catalogue import modified_julian_day
from opml.interop import known_orbits
from validation import later_sets

AHEAD = 100.0  # m


class Shifted:
    """What later sets say, over two mornings, farther along the track."""

    def __init__(self, sets, ahead):
        self.sets, self.ahead = sets, ahead
        self.t = DAY * (FIRST_DAY + 38.0 - modified_julian_day(EPOCH) + np.array([0.0, 2.0]))

    def at(self, t):
        states = self.sets.at(t)
        speed = np.linalg.norm(states[:, 3:], axis=1, keepdims=True)
        return np.hstack([states[:, :3] + self.ahead * states[:, 3:] / speed, states[:, 3:]])


@pytest.fixture(scope="module")
def sets(tmp_path_factory):
    return write_sets(tmp_path_factory.mktemp("sets") / "sets.tle", objects=4, days=45)


@pytest.mark.parametrize("ahead", [0.0, AHEAD])
def test_errors_by_the_orbit_are_those_by_the_set_less_its_shift(sets, ahead):
    orbit = Shifted(known_orbits.read([sets], "1"), ahead)
    found = later_sets.errors(orbit, 1, catalogue.read([sets]))
    assert set(found["lead"]) >= {1.0, 3.0}
    for name in ("sgp4", "improved"):
        off = found[f"{name} by the orbit"] - found[f"{name} by the set"]
        np.testing.assert_allclose(off, -ahead, atol=2.0)
    assert found["sgp4 by the set"].abs().max() > 10.0 * AHEAD
