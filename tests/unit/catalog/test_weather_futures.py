"""Ensembles of futures: what their fans say, and how good they are."""

import numpy as np
import pandas as pd
import pytest
from support import force_model
from weather_files import outlook

from opml.base.constants import DAY, HOUR
from opml.catalog.predict import prediction, weather_futures
from opml.catalog.propagator import Propagator
from opml.catalog.simulate.truth import initial_state
from opml.dynamics.forces import with_outlooks
from opml.tables import PARAMETER_COVARIANCES, SCHEMAS, STATE

RNG = np.random.default_rng(3)


def pairs(count, **columns):
    table = {"i": np.zeros(count, int), "j": 1 + np.arange(count), "t_i": 0.0, "t_j": DAY}
    return pd.DataFrame(table | columns)


def ensemble_of(errors):
    """A table whose members say that the predictions err by `errors` (members, pairs)."""
    count, rows = np.shape(errors)
    table = pd.concat([pairs(rows)[["i", "j"]].assign(member=k) for k in range(count)], ignore_index=True)
    return table.assign(d_x=0.0, d_y=-np.ravel(errors), d_z=0.0)


def test_score_of_a_normal_sample_is_gneitings_closed_form():
    # CRPS of N(0, 1) at 0 is (sqrt 2 - 1) / sqrt pi.
    found = weather_futures.crps(RNG.normal(size=(4000, 50)), np.zeros(50)).mean()
    assert found == pytest.approx((np.sqrt(2.0) - 1.0) / np.sqrt(np.pi), rel=0.01)


def test_score_of_one_member_is_its_error_and_of_two_the_mean_of_pairs():
    assert weather_futures.crps(np.array([[3.0]]), np.array([5.0])) == pytest.approx([2.0])
    assert weather_futures.crps(np.array([[4.0], [1.0]]), np.array([0.0])) == pytest.approx([2.5 - 3.0 / 4.0])


def test_a_fan_that_is_the_errors_own_distribution_covers_its_level():
    said, true = RNG.normal(5.0, 2.0, size=(200, 3000)), RNG.normal(5.0, 2.0, size=3000)
    fan = weather_futures.fan(ensemble_of(said), pairs(3000, e_y=true), level=0.9)
    assert list(fan.columns) == SCHEMAS["fan"].names
    scores = weather_futures.scores(fan)
    assert set(scores.columns) == set(SCHEMAS["scores"].names)
    assert scores["inside"].item() == pytest.approx(0.9, abs=0.02)
    assert scores["rows"].item() == 3000
    assert fan["mean"].mean() == pytest.approx(5.0, abs=0.05)
    assert scores["crps"].item() < 0.8 * scores["error"].item()


def test_few_members_cover_their_level_too():
    said, true = RNG.normal(size=(20, 4000)), RNG.normal(size=4000)
    fan = weather_futures.fan(ensemble_of(said), pairs(4000, e_y=true), level=0.9)
    assert weather_futures.scores(fan)["inside"].item() == pytest.approx(0.9, abs=0.012)


def test_predictions_without_numbers_are_not_scored():
    fan = weather_futures.fan(ensemble_of(np.ones((3, 2))), pairs(2, e_y=[1.0, np.nan]), level=0.5)
    assert weather_futures.scores(fan)["rows"].tolist() == [1]


def test_the_future_that_was_forecast_has_no_difference_and_a_calmer_one_leads(iss):
    model = force_model(2)
    known = outlook(60, days=1)
    calm = known.assign(kp_3h=0.0, kp_24h=0.0, member=1)
    futures = pd.concat([known.assign(member=0), calm], ignore_index=True)
    start = initial_state(iss, model.gm)
    times = np.array([0.0, 6.0, 20.0]) * HOUR
    states = dict(zip(STATE, np.tile(start, (3, 1)).T, strict=True))
    sure = dict.fromkeys(PARAMETER_COVARIANCES, 0.0)
    estimates = pd.DataFrame({"track": range(3), "t": times, **states, "cd": 2.2, "converged": True, **sure})
    truth = estimates[["t", *STATE]]
    forecasting = Propagator(with_outlooks(model, known), iss)
    predictions = prediction.predict_all(forecasting, truth, estimates, max_days=1)
    propagator = Propagator(model, iss)
    found = weather_futures.sample(propagator, futures, estimates, predictions, window=DAY, seed=1)
    assert list(found.columns) == SCHEMAS["ensemble"].names
    forecast, calmer = (found[found["member"] == k] for k in (0, 1))
    assert (forecast[["d_x", "d_y", "d_z"]] == 0.0).all(axis=None)
    # Less drag leaves the orbit higher and so behind.
    assert calmer["d_y"].iloc[1] < calmer["d_y"].iloc[0] < 0.0
    # Where the fit is uncertain, members lie apart under one future.
    uncertain = estimates.assign(cov_cd_cd=0.1**2)
    same = pd.concat([known.assign(member=k) for k in range(2)], ignore_index=True)
    draws = [
        weather_futures.sample(propagator, same, uncertain, predictions, window=DAY, seed=seed)
        for seed in (1, 1, 2)
    ]
    pd.testing.assert_frame_equal(draws[0], draws[1], check_exact=True)
    assert not draws[0].equals(draws[2])
    # More Cd is ahead, as far as more density is.
    one, other = (draws[0].loc[draws[0]["member"] == k, "d_y"].to_numpy() for k in (0, 1))
    assert np.all(np.abs(one[:2] - other[:2]) > 1.0)


def test_draws_have_the_covariance_and_none_where_there_is_none():
    columns = RNG.normal(size=(7, 9)) * np.array([1e2, 1e2, 1e2, 0.1, 0.1, 0.1, 1e-2])[:, None]
    covariance = np.stack([columns @ columns.T, np.full((7, 7), np.nan)])
    covariance[0, 6], covariance[0, :, 6] = 0.0, 0.0
    root = weather_futures.square_root(covariance)
    np.testing.assert_allclose(root[0] @ root[0].T, covariance[0], rtol=1e-9)
    assert not root[1].any()
