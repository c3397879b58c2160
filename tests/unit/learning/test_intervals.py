"""Prediction intervals: the quantile by hand, and the coverage of estimates that were not seen."""

import numpy as np
import pandas as pd
import pytest

from opml.base.errors import InputError
from opml.learning.judge import intervals
from opml.tables import SCHEMAS

HOUR = 3600.0


def sample(estimates, seed, *, spread=1.0):
    """Residuals of estimates with errors of their own, between 5 and 40 rows each, growing with duration."""
    rng = np.random.default_rng(seed)
    groups = np.repeat(np.arange(estimates), rng.integers(5, 40, estimates))
    duration = rng.uniform(HOUR, 168 * HOUR, len(groups))
    offset = rng.normal(size=estimates)[groups]
    residual = spread * (duration / HOUR) ** 2 * (offset + 0.3 * rng.normal(size=len(groups)))
    return duration, residual, groups


def calibrated(estimates, seed=0, level=0.9):
    duration, residual, groups = sample(estimates, seed)
    held = intervals.held_out(groups, share=0.5, seed=seed)
    table = pd.DataFrame({"duration": duration, "residual": residual, "i": groups})
    return intervals.calibrate(table, held, intervals.Conformal(level=level, share=0.5, bin_hours=12))


def test_estimates_are_held_out_whole_and_by_the_seed():
    groups = np.repeat(np.arange(40), 3)
    held = intervals.held_out(groups, share=0.25, seed=1)
    assert held.sum() == 30
    assert held.reshape(40, 3).all(axis=1).sum() == 10
    np.testing.assert_array_equal(held, intervals.held_out(groups, share=0.25, seed=1))
    assert not np.array_equal(held, intervals.held_out(groups, share=0.25, seed=2))


def test_every_estimate_has_one_vote_and_one_more_lies_anywhere():
    # Ten estimates, one of them with a hundred rows: 1 / 11 of the weight each.
    scores = np.concatenate([np.full(100, 1.0), np.arange(2.0, 11.0)])
    groups = np.concatenate([np.zeros(100), np.arange(1, 10)])
    assert intervals.grouped_quantile(scores, groups, level=2 / 11) == 2.0
    assert intervals.grouped_quantile(scores, groups, level=10 / 11) == 10.0
    assert intervals.grouped_quantile(scores, groups, level=0.5 / 11) == 1.0
    with pytest.raises(InputError, match=r"intervals: expected estimates enough .* level of 0\.95, got 10"):
        intervals.grouped_quantile(scores, groups, level=0.95)


def test_the_scale_follows_the_duration_and_is_never_zero():
    duration = np.array([1.0, 2.0, 13.0, 14.0, 15.0, 30.0]) * HOUR
    centre, scale = intervals.duration_scale(
        duration, np.array([3.0, -5.0, 1.0, -20.0, 30.0, 0.0]), bin_hours=12
    )
    np.testing.assert_allclose(centre, np.array([1.5, 14.0, 30.0]) * HOUR)
    np.testing.assert_allclose(scale, [4.0, 20.0, 20e-6])
    assert intervals.duration_scale(duration, np.zeros(6), bin_hours=12)[1].tolist() == [1.0] * 3


def test_new_estimates_are_covered_as_promised_at_short_and_long_durations():
    covered = []
    for seed in range(30):
        widths = calibrated(120, seed)
        duration, residual, groups = sample(200, seed + 1000)
        covered.append(intervals.coverage(residual, widths.at(duration), groups)[1])
    assert 0.885 < np.mean(covered) < 0.95
    for part in (duration < 48 * HOUR, duration > 120 * HOUR):
        rows, _ = intervals.coverage(residual[part], widths.at(duration[part]), groups[part])
        assert 0.75 < rows < 0.99


def test_estimates_drawn_otherwise_are_not():
    duration, residual, groups = sample(200, 7, spread=3.0)
    assert intervals.coverage(residual, calibrated(120).at(duration), groups)[0] < 0.6


def test_coverage_counts_rows_and_estimates():
    residual, width = np.array([1.0, -1.0, 3.0, -2.0]), np.array([1.0, 0.5, 4.0, 2.0])
    assert intervals.coverage(residual, width, np.array([0, 1, 1, 1])) == (0.75, pytest.approx(5 / 6))


def test_a_higher_level_is_wider():
    at = np.array([24.0, 96.0]) * HOUR
    assert (calibrated(200, level=0.95).at(at) > calibrated(200, level=0.8).at(at)).all()


def test_summary_tells_what_lies_inside():
    table = pd.DataFrame(
        {
            "i": [0, 0, 0, 1],
            "duration": [1e4, 2e5, 3e5, 3.1e5],
            "true": [1.0, -9.0, 5.0, -7.0],
            "residual": [0.5, -2.0, 3.0, 0.1],
            "half_width": [1.0, 1.0, 2.0, 4.0],
        }
    )
    names = dict.fromkeys(("rso", "stations", "train", "learner", "component", "target", "test"), "x")
    row = intervals.coverage_summary(table, level=0.9, **names)
    assert list(row.columns) == SCHEMAS["coverage"].names
    found = row.iloc[0]
    assert (found["rows_inside"], found["estimates_inside"]) == (0.5, pytest.approx((1 / 3 + 1) / 2))
    assert (found["half_width"], found["half_width_last_day"], found["error_last_day"]) == (1.5, 3.0, 6.0)
