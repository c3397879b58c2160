"""Uncertainty from rolling origins: nominal where the future is like the past, growing where the past did."""

from functools import partial

import numpy as np
import pandas as pd
import pytest
from scipy.stats import chi2

from opml.constants import DAY
from opml.errors import InputError
from opml.learning import learners, origins, splits, uncertainty
from opml.learning.baselines import NoCorrection
from opml.learning.paths import AXES, POSITION
from opml.learning.uncertainty import MAIN, Uncertainty
from opml.tables import LEVELS, SCHEMAS

SIGMA = {"x": 30.0, "y": 200.0, "z": 50.0}
"""Of one day's prediction [m]; it grows with the duration, and in some tests with the age."""

REACH = {"longest_days": 7.0, "block_hours": 24.0}
BINS = {"bin_hours": 24.0, "block_hours": 24.0}


def rolled(days=12.0, *, drift=0.0, seed=0, origins=3, count=6000):
    """Residuals behind some origins: normal, as large as the days of duration, more so by `drift` a day."""
    rng = np.random.default_rng(seed)
    duration, age = rng.uniform(1.0, 7.0, count) * DAY, rng.uniform(0.0, days, count) * DAY
    size = (duration / DAY) * (1.0 + drift * age / DAY)
    columns = {axis: SIGMA[axis] * size * rng.normal(size=count) for axis in AXES}
    columns |= {"duration": duration, "age": age, "origin": rng.integers(0, origins, count)}
    return pd.DataFrame(columns)


def inside(found, rows, axis, level):
    half = found.half_width(axis, rows["duration"].to_numpy(), rows["age"].to_numpy(), level)
    return float(np.mean(np.abs(rows[axis]) <= half))


def covariance_of(found, rows):
    return found.residual_covariance(rows["duration"].to_numpy(), rows["age"].to_numpy())


@pytest.fixture(scope="module")
def calm():
    """The uncertainty that residuals without a drift show."""
    return uncertainty.calibrate(rolled(count=20000), **BINS)


@pytest.mark.parametrize("level", LEVELS)
@pytest.mark.parametrize("axis", AXES)
def test_normal_residuals_are_covered_as_stated(calm, axis, level):
    # One block more that may lie anywhere makes it a little wider.
    assert level - 0.02 < inside(calm, rolled(seed=1), axis, level) < level + 0.06


@pytest.mark.parametrize("level", [0.5, 0.9, 0.99])
def test_their_ellipsoids_are_those_of_chi_square(calm, level):
    later = rolled(seed=1)
    distance = uncertainty.mahalanobis(later[list(AXES)].to_numpy(), covariance_of(calm, later))
    assert level - 0.02 < np.mean(distance <= chi2.ppf(level, 3)) < level + 0.08


def test_the_covariance_is_that_of_the_residuals(calm):
    later = rolled(seed=1)
    expected = [SIGMA[axis] ** 2 for axis in AXES] * (later["duration"].to_numpy()[:, None] / DAY) ** 2
    whole = covariance_of(calm, later)
    ratio = np.diagonal(whole, axis1=1, axis2=2) / expected
    assert (np.abs(np.median(ratio, axis=0) - 1.1) < 0.15).all()
    assert (whole[:, ~np.eye(3, dtype=bool)] == 0.0).all()


def test_residuals_that_drift_are_covered_with_the_growth_and_not_without(monkeypatch):
    past, later = rolled(8.0, drift=0.5, count=20000), rolled(12.0, drift=0.5, seed=1, count=20000)
    late = later[later["age"] > 8.0 * DAY]
    grown = uncertainty.calibrate(past, **BINS)
    assert 0.86 < inside(grown, late, "y", MAIN) < 0.97
    assert 0.3 < grown.spreads["y"].growth < 0.7
    monkeypatch.setattr(uncertainty, "growth_of", lambda scaled, age: 0.0)
    assert inside(uncertainty.calibrate(past, **BINS), late, "y", MAIN) < 0.8


def test_residuals_that_do_not_drift_give_next_to_no_growth(calm):
    assert all(0.0 <= spread.growth < 0.03 for spread in calm.spreads.values())


def test_a_day_that_all_predictions_share_counts_once():
    # Every row of a day has the same sign and size: 36 numbers, however many rows.
    rng = np.random.default_rng(3)
    rows = rolled(count=20000)
    common = rng.normal(size=(3, 12))[rows["origin"], (rows["age"] // DAY).astype(int)]
    shared = rows.assign(y=SIGMA["y"] * (rows["duration"] / DAY) * np.abs(common))
    many, few = (uncertainty.calibrate(one, **BINS) for one in (shared, shared.iloc[::20]))
    assert many.days == few.days == 36
    at = np.array([3.0 * DAY]), np.array([5.0 * DAY])
    assert many.half_width("y", *at, MAIN)[0] == pytest.approx(few.half_width("y", *at, MAIN)[0], rel=0.25)


def test_a_level_beyond_the_days_is_the_largest_residual_seen():
    rows = rolled(4.0, origins=3)
    found = uncertainty.calibrate(rows, **BINS)
    assert found.days == 12
    assert inside(found, rows, "y", 0.99) == 1.0


def test_too_few_days_are_told():
    with pytest.raises(InputError, match=r"residuals in 9 blocks of 24 hours behind the origins, got 8"):
        uncertainty.calibrate(rolled(4.0, origins=2), **BINS)


@pytest.mark.parametrize(
    ("train", "expected"),
    [
        ("days-0-30", [10, 15, 20]),
        ("days-10-40", [20, 25, 30]),
        ("days-0-18", [9, 12]),
        ("days-0-14", [7, 28 / 3]),
    ],
)
def test_origins_are_shares_of_the_window_that_outlast_a_prediction(train, expected):
    assert origins.origins(train, **REACH) == pytest.approx(expected)


@pytest.mark.parametrize(
    ("train", "message"),
    [
        ("days-0-8", r"9 blocks of 24 hours behind origins that lie 7 days or more within 'days-0-8', got 0"),
        ("days-0-11", r"within 'days-0-11', got 4"),
        ("grouped-80", r"expected a window of days to train on, got 'grouped-80'"),
    ],
)
def test_windows_that_no_origin_can_roll_over_are_told(train, message):
    with pytest.raises(InputError, match=message):
        origins.origins(train, **REACH)


def test_a_table_gives_the_same_again(calm):
    table = calm.to_table()
    assert list(table.columns) == SCHEMAS["uncertainty"].names
    again = Uncertainty.from_table(table)
    pd.testing.assert_frame_equal(again.to_table(), table, check_exact=True)
    at = np.array([0.5, 3.3]) * DAY, np.array([-1.0, 9.0]) * DAY
    np.testing.assert_array_equal(calm.residual_covariance(*at), again.residual_covariance(*at))


def test_an_age_before_the_end_of_the_training_counts_as_none():
    found = uncertainty.calibrate(rolled(drift=0.5), **BINS)
    at = np.array([3.0 * DAY])
    before, end, after = (found.half_width("y", at, np.array([age]), MAIN)[0] for age in (-DAY, 0.0, DAY))
    assert before == end < after


def dataset(count=2000, seed=0):
    """Rows of 40 days of a dataset with paths, whose errors are noise."""
    rng = np.random.default_rng(seed)
    t_j = np.sort(rng.uniform(0.5, 40.0, count)) * DAY
    table = pd.DataFrame({"t_j": t_j, "duration": np.minimum(rng.uniform(0.1, 7.0, count) * DAY, t_j)})
    table[POSITION] = rng.normal(size=(count, 3)) * [30.0, 200.0, 50.0]
    return table.assign(i=np.arange(count) // 5, keep=True, radius=6.8e6, climb=1e-3)


def test_only_models_of_the_past_are_asked_about_what_followed():
    seen = []

    def train(rows):
        seen.append(rows["t_j"].max())
        return NoCorrection(("duration",))

    table = dataset()
    found = uncertainty.roll(train, table, at=[10.0, 15.0])
    assert [end <= at * DAY for end, at in zip(seen, (10.0, 15.0), strict=True)] == [True, True]
    assert (found["age"] > 0.0).all()
    assert found.groupby("origin").size().to_dict() == {
        at: int((table["t_j"] > at * DAY).sum()) for at in (10.0, 15.0)
    }
    np.testing.assert_allclose(found["y"].iloc[0], table.loc[table["t_j"] > 10.0 * DAY, "e_y"].iloc[0])


def test_what_follows_the_training_changes_no_width():
    settings = {"kind": "duration_mean", "bin_hours": 24, "variables": ["duration"]}

    def widths(table):
        rows = splits.training_rows(table, "days-0-30", span_days=[0, 40], seed=1)
        train = partial(learners.train, component="e_y", settings=settings, seed=1)
        found = uncertainty.roll(train, table[rows], at=origins.origins("days-0-30", **REACH))
        return uncertainty.calibrate(found, **BINS).to_table()

    table = dataset()
    later = table["t_j"] > 30.0 * DAY
    moved = table.assign(**{name: table[name] + 1e4 * later for name in POSITION})
    expected = widths(table)
    pd.testing.assert_frame_equal(widths(moved), expected, check_exact=True)
    before = table.assign(e_y=table["e_y"] + 1e4 * ~later)
    assert not widths(before).equals(expected)
