"""What only a simulation knows: perfect estimates, and which part of an error comes from what."""

import numpy as np
import pandas as pd
import pytest

from opml.base.constants import DAY
from opml.catalog.simulate import oracle
from opml.orbits.elements import cartesian_from_coe, rsw_rotation
from opml.tables import SCHEMAS, STATE

GM = 3.986004418e14
ELEMENTS = np.array([6.8e6, 1e-3, 0.9, 0.3, 0.4, 0.5])
ERROR = 10.0  # m, of the estimate's semi-major axis


def estimates(states):
    """A table of one estimate at t = 0, track 0."""
    columns = {name: [0.0] for name in SCHEMAS["estimates"].names} | {"track": [0], "reason": ["diverged"]}
    return pd.DataFrame(columns).assign(**dict(zip(STATE, np.transpose([states]), strict=True)), cd=5.0)


@pytest.fixture
def truth():
    state = cartesian_from_coe(ELEMENTS, GM)
    return pd.DataFrame({"t": [0.0]} | {name: [value] for name, value in zip(STATE, state, strict=True)})


def test_perfect_estimates_are_the_truth(truth):
    found = oracle.perfect(estimates(np.zeros(6)), truth, cd=2.2)
    assert set(found) == set(SCHEMAS["estimates"].names)
    assert np.array_equal(found[STATE], truth[STATE])
    assert found["cd"].item() == 2.2
    assert found["converged"].item() is True
    assert found["reason"].item() == ""


def test_error_of_the_semi_major_axis_drifts_as_kepler_has_it(truth):
    shifted = cartesian_from_coe(ELEMENTS + [ERROR, 0, 0, 0, 0, 0], GM)
    duration = 2.0 * DAY
    pair = {"i": [0], "j": [1], "t_i": [0.0], "t_j": [duration]}
    nowhere = pd.DataFrame({"i": [0], "j": [1]} | {f"e_{axis}": [7.0] for axis in STATE})
    perfect = oracle.perfect(estimates(shifted), truth, cd=2.2)
    found = oracle.build(estimates(shifted), pd.DataFrame(pair), perfect, nowhere, gm=GM)

    def moved(a):
        mean_motion = np.sqrt(GM / a**3)
        nu = ELEMENTS[5] + mean_motion * duration  # the eccentricity makes no difference at this accuracy
        return cartesian_from_coe(np.array([a, 0.0, *ELEMENTS[2:5], nu % (2 * np.pi)]), GM)

    true, predicted = moved(ELEMENTS[0]), moved(ELEMENTS[0] + ERROR)
    along = (rsw_rotation(true) @ (predicted - true)[:3])[1]
    assert found["drift"].item() == pytest.approx(along, rel=5e-3)
    assert found["floor_y"].item() == 7.0
    assert set(found) == set(SCHEMAS["oracle"].names)
