"""What predictions are worth in conjunctions: alarms per collision, and collisions that raise one."""

import numpy as np
import pandas as pd
import pytest

from opml.base.constants import DAY
from opml.conjunctions.collision_alarms import Screening, _alarm_area, _crossing, alarms_by_day, compare
from opml.learning.judge.model_choice import Mornings

SCREENING = Screening(radius=20.0, threshold=1e-4)


@pytest.fixture
def few_draws(monkeypatch):
    """Draw few collisions, and fewer areas of alarms."""
    monkeypatch.setattr("opml.conjunctions.collision_alarms._DRAWS", 128)
    monkeypatch.setattr("opml.conjunctions.collision_alarms._AREAS", 32)


def replay(stated, real, count=300):
    """Predictions of a day whose errors have sizes `real` [m], and which state others."""
    rng = np.random.default_rng(3)
    columns = {"duration": np.full(count, DAY)}
    for axis, size, sigma in zip("xyz", real, stated, strict=True):
        columns |= {f"e_{axis}": size * rng.normal(size=count), f"sigma_{axis}": np.full(count, sigma)}
    return pd.DataFrame(columns)


def alarms_and_flagged(stated, real):
    row, *_ = alarms_by_day(replay(stated, real), SCREENING, days=[1.0, 5.0], seed=1).itertuples()
    assert (row.day, row.crossing, row.predictions) == (1.0, "any", 300)
    return row.alarms, row.flagged


@pytest.mark.usefixtures("few_draws")
def test_angles_divide_the_draws_and_head_on_the_error_along_the_track_hardly_counts():
    table = alarms_by_day(replay([10, 500, 10], [10, 500, 10]), SCREENING, days=[1.0], seed=1).set_index(
        "crossing"
    )
    whole, *parts = table["alarms"]
    assert whole == pytest.approx(np.mean(parts), rel=0.1)
    assert table.loc["over 120", "alarms"] < 0.5 * table.loc["below 60", "alarms"]
    np.testing.assert_allclose(table["per_approach"], table["alarms"] * 0.02**2)


def test_small_errors_that_are_known_raise_few_alarms_and_miss_no_collision():
    small, large = (alarms_and_flagged(sizes, sizes) for sizes in ([5, 50, 5], [20, 800, 20]))
    assert small[0] < 0.3 * large[0]
    assert small[1] > 0.98
    assert large[1] > 0.95


def test_a_covariance_that_is_too_small_misses_collisions():
    honest, naive = (alarms_and_flagged(stated, [10, 500, 10]) for stated in ([10, 500, 10], [1, 30, 1]))
    assert naive[1] < 0.5 < honest[1]
    assert naive[0] < honest[0]


def test_a_covariance_that_dilutes_the_probability_misses_all():
    assert alarms_and_flagged([3000, 90000, 3000], [3000, 90000, 3000]) == (0.0, 0.0)


def test_what_both_share_leaves_their_distance_as_it_was(few_draws):
    """Both are late by the same on each morning: who knows it raises fewer alarms."""
    late = 20_000.0 * np.random.default_rng(3).normal(size=50).repeat(6)
    own = replay([10, 50, 10], [10, 50, 10])
    known = own.assign(
        morning=np.arange(50).repeat(6), e_y=own["e_y"] + late, sigma_y=np.hypot(50.0, 20_000.0)
    )
    told = [known, known.assign(common=20_000.0), known.assign(common=20_000.0).drop(columns="morning")]
    alone, shared, apart = (alarms_by_day(one, SCREENING, days=[1.0], seed=1).iloc[0] for one in told)
    assert shared["flagged"] > 0.9
    assert shared["alarms"] < 0.5 * alone["alarms"]
    assert apart["flagged"] < 0.2


@pytest.mark.parametrize("sigmas", [(400.0, 3000.0), (500.0, 500.0)])
def test_the_area_of_alarms_is_that_of_an_ellipse_where_the_radius_is_small(sigmas):
    most = SCREENING.radius**2 / (2.0 * sigmas[0] * sigmas[1])
    expected = 2.0 * np.pi * sigmas[0] * sigmas[1] * max(np.log(most / SCREENING.threshold), 0.0)
    assert _alarm_area(np.array(sigmas), SCREENING) == pytest.approx(expected, rel=0.01)


def test_the_area_of_alarms_is_the_circle_where_all_is_known():
    area = _alarm_area(np.array([0.002, 0.002]), SCREENING)
    assert area == pytest.approx(np.pi * SCREENING.radius**2, rel=0.01)


@pytest.mark.parametrize("angle", [0.3, 1.5, 3.0, 5.0])
def test_the_plane_lies_across_the_relative_velocity(angle):
    plane, turn = _crossing(angle)
    relative = turn @ [0.0, 1.0, 0.0] - np.array([0.0, 1.0, 0.0])
    np.testing.assert_allclose(plane @ relative, 0.0, atol=1e-12)
    np.testing.assert_allclose(plane @ plane.T, np.eye(2), atol=1e-12)


@pytest.mark.usefixtures("few_draws")
def test_draws_repeat_by_seed():
    table = replay([10, 100, 10], [10, 100, 10])
    one, again, other = (alarms_by_day(table, SCREENING, days=[1.0], seed=seed) for seed in (1, 1, 2))
    pd.testing.assert_frame_equal(one, again)
    assert not one.equals(other)


def test_seeds_hardly_matter():
    """Predictions state sizes over two decades, as mornings do."""
    table = replay([10, 100, 10], [10, 100, 10])
    wide = table.assign(sigma_y=np.random.default_rng(4).permutation(np.geomspace(20.0, 2000.0, len(table))))
    alarms = [alarms_by_day(wide, SCREENING, days=[1.0], seed=seed)["alarms"].iloc[0] for seed in range(3)]
    assert max(alarms) < 1.02 * min(alarms)


@pytest.mark.usefixtures("few_draws")
def test_models_are_compared_with_both_covariances_of_the_fits():
    one = replay([10, 100, 10], [10, 100, 10]).assign(i=range(300), j=range(1, 301), morning=0.0)
    best, worse = one, one.assign(e_y=3.0 * one["e_y"], e_x=one["e_x"])
    models = {"none": worse, "sgp4": worse, "fit96": worse, "running": best, "law": best}
    mornings = Mornings(models, best, {}, 0)
    fits = one[["i", "j"]].assign(**{f"cov_{axis}_{axis}": 1.0 for axis in "xyz"})
    table = compare(mornings, fits, SCREENING, weather="forecast", laws=["law"], days=[1.0], seed=1)
    table = table[table["crossing"] == "any"]
    assert table[["model", "covariance"]].to_numpy().tolist() == [
        ["none", "the fit's own"],
        ["none", "of past errors"],
        ["sgp4", "of past errors"],
        ["fit96", "of past errors"],
        ["running", "of past errors"],
        ["selected each day", "of past errors"],
    ]
    assert table["flagged"].iloc[0] < 0.3 < table["flagged"].iloc[-1]
