"""The judge: shares, P_ML, coverage and their intervals, by hand."""

import numpy as np
import pandas as pd
import pytest
from scipy.stats import norm

from opml.element_sets import corrector_scores


def residuals(error, scaled, learned, **columns):
    """Residuals of one band and lead: each prediction of an object and a week of its own."""
    count = len(error)
    table = {
        "number": np.arange(count),
        "morning": 7.0 * np.arange(count),
        "lead": 1,
        "band": 2,
        "error": error,
        "scaled": scaled,
        "learned": learned,
        "sigma": np.nan,
        "improved": learned,
        "improved_sigma": np.nan,
        "applied": "learned",
        "judge": "set",
    }
    return pd.DataFrame(table | columns)


def test_numbers_of_a_band_are_shares_of_sgp4():
    judges = ["orbit", "set", "set"]
    table = residuals([-10.0, 20.0, 40.0], [5.0, -10.0, 30.0], [4.0, 5.0, -16.0], judge=judges)
    every, band = corrector_scores.scores(table, seed=1).to_dict("records")
    assert (every["band"], band["band"]) == (corrector_scores.ALL, 2)
    assert {
        name: every[name] for name in every if name[-4:] not in ("band", "_low", "high")
    } == pytest.approx(
        {name: band[name] for name in band if name[-4:] not in ("band", "_low", "high")}, nan_ok=True
    )
    assert (band["predictions"], band["objects"], band["weeks"]) == (3, 3, 3)
    assert band["by_orbits"] == pytest.approx(100.0 / 3.0)
    assert band["sgp4_median"] == 20.0
    assert band["sgp4_p95"] == pytest.approx(38.0)
    assert (band["scaled_median"], band["learned_median"]) == (50.0, 25.0)
    assert (band["scaled_p_ml"], band["learned_p_ml"]) == pytest.approx((4500.0 / 70.0, 2500.0 / 70.0))
    assert band["learned_p95"] == pytest.approx(100.0 * 14.9 / 38.0)


def test_coverage_counts_what_has_a_sigma():
    left, sigma = pd.Series([1.6, -1.7, 0.0, 9.0]), pd.Series([1.0, 1.0, 1.0, np.nan])
    assert corrector_scores.coverage(left, sigma) == pytest.approx(100.0 * 2.0 / 3.0)
    assert np.isnan(corrector_scores.coverage(left, np.nan * sigma))


def test_the_worst_week_has_the_least_inside():
    left, sigma = [0.0, 0.0, 9.0, 0.0, 9.0, 9.0], np.ones(6)
    table = residuals(left, left, left, improved_sigma=sigma, morning=[0.0, 1.0, 2.0, 7.0, 8.0, 9.0])
    assert corrector_scores.worst_week(table) == pytest.approx(100.0 / 3.0)


def test_the_log_score_is_that_of_a_normal_law():
    left, sigma = pd.Series([1.0, -4.0]), pd.Series([1.0, 2.0])
    log_density = np.log(1.0 / np.sqrt(2.0 * np.pi)) - corrector_scores.log_score(left, sigma)
    assert log_density == pytest.approx(norm.logpdf(left, scale=sigma).mean())


def test_a_burn_does_not_make_the_log_score():
    errors = (pd.Series([error]) for error in (1e6, 5.0))
    assert [corrector_scores.log_score(one, pd.Series([1.0])) for one in errors] == [12.5, 12.5]


def test_sets_that_stay_are_counted():
    applied = ["unchanged", "learned", "density", "unchanged"]
    (_, band) = corrector_scores.scores(residuals(*np.ones((3, 4)), applied=applied), seed=1).to_dict(
        "records"
    )
    assert band["unchanged"] == 50.0


def test_intervals_of_one_week_and_one_object_are_their_number():
    table = residuals([10.0, 20.0, 30.0], [5.0, 10.0, 15.0], [4.0, 8.0, 12.0], number=7, morning=6.5)
    found = corrector_scores.intervals(table, np.random.default_rng(1))
    assert found == pytest.approx(
        {
            **{f"scaled_{end}": 50.0 for end in ("low", "high")},
            **{f"{way}_{end}": 40.0 for way in ("learned", "improved") for end in ("low", "high")},
        }
    )


def test_predictions_of_an_object_do_not_narrow_an_interval():
    rng = np.random.default_rng(3)
    error = rng.normal(size=40) * 100.0
    table = residuals(error, error * rng.uniform(0.2, 1.0, 40), error * rng.uniform(0.1, 0.9, 40))
    many = pd.concat([table] * 5)
    one, five = (corrector_scores.intervals(part, np.random.default_rng(5)) for part in (table, many))
    assert five == pytest.approx(one, rel=0.2)
    assert (
        five["learned_low"]
        < corrector_scores.scores(many, seed=5)["learned_median"].iloc[0]
        < five["learned_high"]
    )


def test_the_same_seed_gives_the_same_intervals_in_any_order():
    rng = np.random.default_rng(4)
    table = residuals(*rng.normal(size=(3, 30)), number=np.arange(30) % 5, morning=np.arange(30.0))
    found = corrector_scores.scores(table, seed=9)
    pd.testing.assert_frame_equal(found, corrector_scores.scores(table.iloc[::-1], seed=9))
    assert not found.equals(corrector_scores.scores(table, seed=10))
