"""Shares of errors inside what was stated, in the table, the report and the figure."""

import numpy as np
import pytest

from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.learning.judge import calibration

SIGMA = np.array([30.0, 400.0, 50.0])


def errors(count=8000, seed=0):
    """Normal errors of predictions over one and three days, and the durations."""
    rng = np.random.default_rng(seed)
    return SIGMA * rng.normal(size=(count, 3)), rng.choice([1.0, 3.0], count) * DAY


def of_normal(scale=1.0):
    found, duration = errors()
    covariance = np.broadcast_to(scale**2 * np.diag(SIGMA**2), (len(found), 3, 3))
    return calibration.of_covariances(covariance, found, duration, days=[1.0, 3.0, 7.0])


def test_a_true_covariance_holds_its_shares():
    table = of_normal()
    assert sorted(set(table["day"])) == [1.0, 3.0]  # nothing lasts seven days
    assert table.groupby("quantity").size().tolist() == [2] * 5
    np.testing.assert_allclose(table["inside"], 0.9, atol=0.03)


def test_a_covariance_half_as_wide_holds_less():
    table = of_normal(0.5).groupby("quantity")["inside"].mean()
    assert table["e_y"] == pytest.approx(0.589, abs=0.02)  # 0.82 standard deviations to either side
    assert table["ellipsoid"] == pytest.approx(0.33, abs=0.02)  # chi-square(3) up to 6.25 / 4


def test_shares_by_hand():
    found = np.array([[0.0, 16.0, 0.0], [0.0, 17.0, 0.0], [0.0, -16.4, 0.0], [0.0, 33.0, 0.0]])
    covariance = np.array([np.diag([1.0, sigma, 1.0]) ** 2 for sigma in (10.0, 10.0, 10.0, 20.0)])
    table = calibration.of_covariances(covariance, found, np.full(4, DAY), days=[1.0])
    (row,) = table[table["quantity"] == "e_y"].to_dict("records")
    assert (row["inside"], row["rows"]) == (0.5, 4)
    assert row["stated"] == pytest.approx(16.449, abs=1e-3)


def test_durations_that_nothing_lasts_are_told():
    found, duration = errors(10)
    with pytest.raises(InputError, match="calibration: expected predictions over 5, 7 days, got none"):
        calibration.of_covariances(np.broadcast_to(np.eye(3), (10, 3, 3)), found, duration, days=[5.0, 7.0])


def test_durations_end_with_the_longest_prediction():
    assert calibration.marks(7.0) == [1.0, 3.0, 5.0, 7.0]
    assert calibration.marks(3.0) == [1.0, 3.0]
    assert calibration.marks(0.5) == [0.5]
