"""Covariances of fits carried to predictions, against arcs that start from draws of the fit's covariance."""

import numpy as np
from fits import estimates_on, on_orbit

from opml.base.constants import DAY
from opml.catalog.predict import prediction
from opml.catalog.predict.covariance import of_positions, propagated
from opml.catalog.propagator import Propagator
from opml.orbits.elements import in_rsw
from opml.tables import POSITION_COVARIANCES, SCHEMAS, STATE, symmetric_matrices

TIMES = np.array([0.0, 0.4, 1.0]) * DAY
DRAWS = 400


def covariance_of_a_fit():
    """Ten metres, a centimetre per second and a tenth of Cd, the latter along with the velocity."""
    sigma = np.array([10.0, 20.0, 15.0, 0.01, 0.02, 0.015, 0.1])
    correlation = np.eye(7)
    correlation[1, 3] = correlation[3, 1] = -0.8
    correlation[4, 6] = correlation[6, 4] = 0.5
    return correlation * np.outer(sigma, sigma)


def test_carried_covariances_are_those_of_many_arcs(assumed_model, iss):
    fit = covariance_of_a_fit()
    states = on_orbit(TIMES, assumed_model.gm)
    table = estimates_on(TIMES, states, covariance=fit, cd=2.2)
    propagator = Propagator(assumed_model, iss)
    pairs = prediction.predict_all(propagator, table[["t", *STATE]], table, max_days=2.0)
    carried = propagated(propagator, table, pairs)
    found = of_positions(pairs, carried)
    assert list(found.columns) == SCHEMAS["covariances"].names
    assert found[["i", "j"]].to_numpy().tolist() == [[10, 11], [10, 12], [11, 12]]

    draws = np.random.default_rng(1).multivariate_normal(np.zeros(7), fit, DRAWS)
    arcs = propagator.propagate(
        TIMES,
        table.loc[0, STATE].to_numpy(float) + draws[:, :6],
        cd=2.2 + draws[:, 6],
        first=np.zeros(DRAWS, int),
        last=np.full(DRAWS, 2),
    )
    for k in (0, 1):
        predicted = pairs[STATE].to_numpy()[k]
        reached = arcs.states[k::2]
        spread = in_rsw(reached - predicted, np.broadcast_to(predicted, reached.shape))[:, :3]
        stated = symmetric_matrices(found, POSITION_COVARIANCES)[k]
        whitened = np.linalg.solve(np.linalg.cholesky(stated), spread.T)
        # A sample of 400 has variances within a fifth of the true ones.
        np.testing.assert_allclose(np.cov(whitened), np.eye(3), atol=0.25)
