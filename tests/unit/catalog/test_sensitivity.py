"""Sensitivities to the drag coefficient, against differences made by hand."""

import numpy as np
import pandas as pd
import pytest
from fits import estimates_on, on_orbit

from opml.base.constants import DAY
from opml.catalog.predict import prediction, sensitivity
from opml.catalog.propagator import Propagator
from opml.orbits.elements import rsw_rotation
from opml.tables import SCHEMAS, STATE

TIMES = np.array([0.0, 0.3, 1.1, 2.0, 2.9]) * DAY
CD = np.array([2.25, 2.1, 4.0, 2.3, 2.2])
ALONE = np.eye(7)  # a covariance without correlations


def estimates(gm, covariance):
    """Estimates on one low orbit, each with the same covariance (7, 7) of PARAMETERS."""
    return estimates_on(TIMES, on_orbit(TIMES, gm), covariance=covariance, cd=CD)


@pytest.fixture(scope="module")
def run(assumed_model, iss):
    """Predictions and sensitivities of estimates with a covariance."""

    def make(covariance=ALONE, keep=lambda pairs: pairs):
        table = estimates(assumed_model.gm, covariance)
        truth = table[["t", *STATE]]
        propagator = Propagator(assumed_model, iss)
        pairs = keep(prediction.predict_all(propagator, truth, table, max_days=2.5))
        found = sensitivity.sensitivities(propagator, table, pairs)
        return table, pairs, found

    return make


def flown(model, rso, state, cd, span):
    """State after `span` [s] of an arc."""
    return (
        Propagator(model, rso).propagate(np.array(span), state[None], cd=cd, first=[0], last=[1]).path(0)[-1]
    )


def turned(pairs, row, difference):
    rotation = rsw_rotation(pairs[STATE].to_numpy()[row])
    return np.concatenate([rotation @ difference[:3], rotation @ difference[3:]])


def test_s_is_the_difference_of_two_arcs_in_rsw_of_the_prediction(run, assumed_model, iss):
    table, pairs, found = run()
    assert set(found.columns) == set(SCHEMAS["sensitivities"].names)
    row = np.flatnonzero((pairs["i"] == 10) & (pairs["j"] == 13))[0]
    start, span = table.loc[0, STATE].to_numpy(float), (TIMES[0], TIMES[3])
    up, down = (flown(assumed_model, iss, start, CD[0] + d, span) for d in (0.05, -0.05))
    expected = turned(pairs, row, up - down) / 0.1
    np.testing.assert_allclose(
        found.loc[row, [f"s_{a}" for a in STATE]].to_numpy(float), expected, rtol=0.02, atol=1.0
    )
    assert expected[1] > 1e4  # more drag is ahead along the track


def test_v_is_s_where_state_and_cd_are_not_correlated(run):
    _, _, found = run(np.diag([1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]))
    for axis in STATE:
        np.testing.assert_allclose(found[f"v_{axis}"], found[f"s_{axis}"], rtol=1e-9, atol=1e-9)


def test_v_moves_the_state_along_the_covariance(run, assumed_model, iss):
    covariance, shift = np.eye(7), np.array([30.0, -20.0, 10.0, 0.01, -0.03, 0.02])
    covariance[6, :6] = covariance[:6, 6] = 0.25 * shift
    covariance[6, 6] = 0.25
    table, pairs, found = run(covariance)
    np.testing.assert_allclose(sensitivity.shift_with_cd(table), np.tile(shift, (len(table), 1)))
    start, span = table.loc[0, STATE].to_numpy(float), (TIMES[0], TIMES[2])
    up, down = (flown(assumed_model, iss, start + d * shift, CD[0] + d, span) for d in (0.05, -0.05))
    row = np.flatnonzero((pairs["i"] == 10) & (pairs["j"] == 12))[0]
    expected = turned(pairs, row, up - down) / 0.1
    np.testing.assert_allclose(
        found.loc[row, [f"v_{a}" for a in STATE]].to_numpy(float), expected, rtol=0.02, atol=1.0
    )
    assert abs(expected[1] - found["s_y"][row]) > 100.0


def test_a_held_cd_has_no_shift(assumed_model):
    assert not sensitivity.shift_with_cd(estimates(assumed_model.gm, np.zeros((7, 7)))).any()


def test_estimates_without_pairs_are_passed_over(run):
    _, _, whole = run()
    _, pairs, part = run(keep=lambda pairs: pairs[pairs["i"] % 2 == 0].reset_index(drop=True))
    expected = whole[whole["i"] % 2 == 0].reset_index(drop=True)
    assert part["i"].tolist() == pairs["i"].tolist()
    pd.testing.assert_frame_equal(part, expected, check_exact=True)
