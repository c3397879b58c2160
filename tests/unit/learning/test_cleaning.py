"""The two data cleanings on values small enough to check by hand."""

import numpy as np
import pytest
from support import refusals

from opml.base.errors import InputError
from opml.learning.data.cleaning import Cleaning, quartiles, tukey_fences


def test_drag_coefficient_bounds_belong_to_the_interval():
    cd = np.array([1.19, 1.2, 2.2, 3.2, 3.21, np.nan, -5000.0, np.inf])
    kept = Cleaning(cd_min=1.2, cd_max=3.2).keeps(cd)
    assert kept.tolist() == [False, True, True, True, False, False, False, False]


def test_quartiles_as_matlab_takes_them():
    # MATLAB: the sorted values are the (k - 1/2)/n quantiles, linear between.
    assert quartiles(np.array([4.0, 1.0, 3.0, 2.0])) == (1.5, 3.5)
    assert quartiles(np.array([0.0, 10.0, 1000.0])) == pytest.approx((2.5, 752.5))


def test_fences_start_at_their_own_quartile():
    # q1 = 1.5, q3 = 3.5: the upper fence counts from q3, not from q1 as the paper prints.
    assert tukey_fences(np.array([1.0, 2.0, 3.0, 4.0]), fence=3.0) == (-4.5, 9.5)


def test_fences_move_and_stretch_with_the_values():
    values = np.random.default_rng(1).normal(size=101)
    lower, upper = tukey_fences(values, fence=1.5)
    assert tukey_fences(5.0 + 2.0 * values, fence=1.5) == pytest.approx((5 + 2 * lower, 5 + 2 * upper))


def test_no_values_no_fences():
    with pytest.raises(InputError, match="Tukey"):
        tukey_fences(np.array([]), fence=3.0)


def test_no_settings_ask_for_no_cleaning():
    assert Cleaning().cd_bounds is None
    assert Cleaning().keeps(np.array([-5000.0, 2.2, np.nan])).tolist() == [True, True, True]


@pytest.mark.parametrize(("settings", "message"), refusals("cleaning"))
def test_settings_that_are_no_cleaning_are_refused_in_one_line(settings, message):
    with pytest.raises(InputError, match=f"dataset: .*{message}"):
        Cleaning.read(settings, "dataset")


@pytest.mark.parametrize("bound", ["cd_min", "cd_max"])
def test_one_bound_needs_the_other(bound):
    with pytest.raises(InputError, match=r"cd_min, cd_max: expected both or none, got 1\.2 alone"):
        Cleaning(**{bound: 1.2}).keeps(np.array([2.2]))
