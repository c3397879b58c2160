"""Positions moved along their path, against a body that flies there."""

import numpy as np
import pandas as pd
import pytest

from opml.elements import cartesian_from_coe, in_rsw
from opml.learning import paths
from opml.learning.baselines import Repredicted
from opml.tables import STATE

GM = 3.986004415e14
COE = np.array([6.8e6, 1e-3, 0.9, 0.3, 1.2, 0.7])


def state(**changes):
    coe = COE.copy()
    for place, value in changes.items():
        coe[["a", "e", "inc", "argp", "raan", "nu"].index(place)] += value
    return cartesian_from_coe(coe, GM)


def described(predicted, true):
    """Errors in RSW of the true state, radius and climb of the predicted one."""
    predicted = np.atleast_2d(predicted)
    errors = in_rsw(predicted - true, np.broadcast_to(true, predicted.shape))[:, :3]
    dataset = pd.DataFrame({"i": 0, "j": np.arange(len(predicted))})
    table = paths.with_paths(dataset, dataset.join(pd.DataFrame(predicted, columns=STATE)))
    return errors, table["radius"].to_numpy(), table["climb"].to_numpy()


@pytest.mark.parametrize("ahead", [-0.015, 0.001, 0.015])
def test_a_prediction_ahead_on_the_same_orbit_comes_back_to_the_truth(ahead):
    errors, radius, climb = described(state(nu=ahead), state())
    along = radius * np.arcsin(errors[:, 1] / radius)
    assert abs(errors[0, 0]) > 8e5 * ahead**2  # the path leaves its tangent
    np.testing.assert_allclose(paths.moved(errors, along, radius, climb), 0.0, atol=1.0)


def test_other_errors_stay_as_they_are():
    true = state()
    beside = true + np.array([30.0, -20.0, 50.0, 0.0, 0.0, 0.0])
    errors, radius, climb = described(beside, true)
    np.testing.assert_allclose(paths.moved(errors, np.zeros(1), radius, climb), errors, atol=1e-6)
    back = paths.moved(errors, np.array([40.0]), radius, climb)
    np.testing.assert_allclose(back, errors - [[0.0, 40.0, 0.0]], atol=0.1)


def test_what_is_left_is_what_the_model_does_not_predict():
    errors, radius, climb = described(state(nu=0.01), state())
    rows = pd.DataFrame(errors, columns=paths.POSITION).assign(radius=radius, climb=climb, r_y=6e4)
    left = paths.left(Repredicted(("r_y",)), rows)
    assert left[0, 1] == pytest.approx(errors[0, 1] - 6e4, abs=1.5)


def test_errors_as_large_as_the_orbit_have_numbers():
    errors = np.array([[-1e7, 6e6, 1e5], [0.0, 0.0, 0.0]])
    found = paths.moved(errors, np.array([2e6, 0.0]), np.full(2, 5e6), np.zeros(2))
    assert np.isfinite(found).all()
