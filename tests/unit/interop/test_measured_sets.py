"""Sets of mean elements as measurements: what each is worth by its past, and what it has of points."""

import logging

import numpy as np
import pandas as pd
import pytest
from element_histories import history
from support import EPOCH

from opml.base.constants import DAY, HOUR
from opml.base.errors import InputError
from opml.catalog.fit import fixes
from opml.interop.element_sets import accuracy
from opml.interop.element_sets.accuracy import SetSampling
from opml.interop.element_sets.histories import states_of
from opml.interop.element_sets.measured_sets import Taking, measured
from opml.orbits.manoeuvres import Manoeuvre
from opml.tables import FIX_SIGMAS, STATE

SAMPLING = SetSampling(12 * HOUR, 1200.0)
DAYS = np.arange(1.0, 13.0)
AXES = FIX_SIGMAS[:3]


def weighed(sets, **options):
    return accuracy.weighed(sets, epoch=EPOCH, sampling=SAMPLING, **options)


def taken(sets, sigmas=None, *, duration=20 * DAY, **options):
    taking = Taking(SAMPLING.step, SAMPLING.reach, sigmas)
    return measured(sets, taking, epoch=EPOCH, duration=duration, **options)


def of_set(found, number):
    """The points of one of the sets that count."""
    return found.points[found.points["track"] == number]


def table_of(found):
    return fixes.of_sets(found.epochs, found.points, known=found.known)


def test_sigmas_are_learned_from_the_disagreements_of_the_past():
    worth = weighed(history(np.arange(1.0, 41.0), noise=200.0))
    assert worth["counts"].all()
    assert (worth[AXES].iloc[:5] == accuracy.USUAL).all(axis=None)
    last = worth[AXES].iloc[-1]
    # The median of |a difference of two errors|, and SGP4's periods between neighbouring sets.
    assert 80.0 < last["sigma_s"] < 200.0
    assert last["sigma_r"] < 0.1 * last["sigma_s"]


@pytest.mark.parametrize(
    ("ahead", "left_out"),
    [
        pytest.param({8.0: 20e3, 9.0: -20e3}, [8.0], id="another's set"),
        pytest.param({8.0: 20e3}, [8.0], id="a burn"),
        pytest.param({8.0: 20e3, 9.0: 20e3}, [8.0, 9.0], id="two burns"),
        pytest.param({3.0: 20e3}, [], id="no past"),
    ],
)
def test_sets_that_disagree_are_left_out_and_told(ahead, left_out, caplog):
    with caplog.at_level(logging.WARNING):
        worth = weighed(history(DAYS, noise=100.0, ahead=ahead))
    assert DAYS[~worth["counts"]].tolist() == left_out
    lines = [f"sets.tle: line {2 * int(day) - 1}: the set of 2016-10" for day in left_out]
    assert len(caplog.messages) == len(lines)
    assert all(line in message for line, message in zip(lines, caplog.messages, strict=True))


def test_a_new_past_begins_where_many_in_a_row_agree_with_none(caplog):
    raised = {float(day): 30e3 * day for day in range(8, 30)}
    worth = weighed(history(np.arange(1.0, 30.0), noise=100.0, ahead=raised))
    assert worth["counts"].iloc[:7].all()
    assert not worth["counts"].iloc[7:11].any()
    assert worth["counts"].iloc[11:].all()
    assert worth["sigma_s"].iloc[-1] > 100.0 * worth["sigma_s"].iloc[6]


def test_a_long_gap_makes_larger_disagreements_usual():
    days = np.append(DAYS, 24.0)
    assert weighed(history(days, noise=100.0, ahead={20.0: 20e3}))["counts"].all()


def test_a_gap_between_sets_a_few_hours_apart_makes_none_usual():
    days = np.append(np.arange(1.0, 4.0, 0.1), 5.0)
    far = weighed(history(days, noise=100.0, ahead={4.5: 20e3}))["counts"]
    assert far.iloc[:-1].all()
    assert not far.iloc[-1]


def test_nothing_is_held_against_a_set_before_a_known_manoeuvre():
    worth = weighed(history(DAYS, noise=100.0, ahead={8.0: 20e3}), manoeuvres=[Manoeuvre(7.5 * DAY)])
    assert worth["counts"].all()


def test_later_sets_change_no_row_no_weight_and_no_exclusion():
    days = np.arange(-8.0, 13.0)
    created = days + 0.4
    sets = history(days, noise=200.0, ahead={6.0: 20e3, 7.0: -20e3}, created=created)
    other = history(
        days, noise=200.0, ahead={6.0: 20e3, 7.0: -20e3, 10.0: 500e3}, created=created + (days > 9.5)
    )
    assert not sets.iloc[-1].equals(other.iloc[-1])
    before, after = (table_of(taken(one)) for one in (sets, other))
    known = before["t_estimate"] <= 9.5 * DAY
    pd.testing.assert_frame_equal(before[known], after[after["t_estimate"] <= 9.5 * DAY], check_exact=True)
    assert before.loc[known, "t_estimate"].unique().tolist() == [k * DAY for k in (1, 2, 3, 4, 5, 7, 8, 9)]
    longer = table_of(taken(sets, duration=11 * DAY))
    pd.testing.assert_frame_equal(longer, before[before["t_estimate"] <= 11 * DAY], check_exact=True)


def test_sets_before_the_run_tell_what_its_first_ones_are_worth():
    found = taken(history(np.arange(-8.0, 4.0), noise=200.0))
    assert found.epochs.tolist() == [DAY, 2 * DAY, 3 * DAY]
    assert found.points["sigma_s"].iloc[0] != pytest.approx(taken(history(DAYS)).points["sigma_s"].iloc[0])


def test_a_set_tells_six_numbers_however_many_points_it_gives():
    found = taken(history(DAYS), (50.0, 100.0, 20.0))
    assert {*found.points["track"].value_counts()} == {37}
    expected = np.array([50.0, 100.0, 20.0]) * np.sqrt(37 * 3 / 6)
    np.testing.assert_allclose(of_set(found, 3)[AXES], np.tile(expected, (37, 1)))
    assert table_of(found)[FIX_SIGMAS[3:]].isna().all(axis=None)


def test_points_lie_behind_the_last_manoeuvre_and_sets_just_after_it_do_not_count():
    found = taken(history(DAYS), manoeuvres=[Manoeuvre(5.8 * DAY), Manoeuvre(8.8 * DAY)])
    assert (found.epochs / DAY).tolist() == [1, 2, 3, 4, 5, 7, 8, 10, 11, 12]
    cut = taken(history(DAYS), manoeuvres=[Manoeuvre(5.6 * DAY)])
    assert of_set(cut, 5)["t"].iloc[0] >= 5.6 * DAY
    assert len(of_set(cut, 5)) < len(of_set(cut, 4))


def test_of_a_long_set_half_a_day_behind_a_manoeuvre_is_enough():
    taking = Taking(1200.0, 72 * HOUR, (50.0, 100.0, 20.0))
    burns = [Manoeuvre(5.4 * DAY), Manoeuvre(8.6 * DAY)]
    found = measured(history(DAYS), taking, epoch=EPOCH, duration=20 * DAY, manoeuvres=burns)
    assert (found.epochs / DAY).tolist() == [1, 2, 3, 4, 5, 6, 7, 8, 10, 11, 12]
    assert of_set(found, 5)["t"].iloc[0] >= 5.4 * DAY


def test_a_run_without_sets_that_count_is_told():
    with pytest.raises(
        InputError, match="element sets: expected a set within the run that counts, got 0 others"
    ):
        taken(history(DAYS + 30.0))


def test_a_set_is_known_when_it_and_all_before_it_are_made():
    found = taken(history(DAYS[:3], created=[2.5, 2.2, 3.1]))
    known = table_of(found).groupby("track")["t_known"].first()
    assert known.tolist() == [2.5 * DAY, 2.5 * DAY, 3.1 * DAY]
    untold = table_of(taken(history(DAYS[:3])))
    assert (untold["t_known"] == untold["t_estimate"]).all()


def test_points_on_a_raster_end_at_the_next_multiple_behind_each_epoch():
    """Each set has a multiple of its own, and no later set moves it."""
    days = np.array([1.0, 2.0, 2.0 + 10.0 / DAY, 2.0 + 20.0 / DAY, 3.0 + 1.0 / DAY])
    sets = history(days, created=days + [0.1, 0.1, 0.1, 0.1, 0.0])
    taking = Taking(1200.0, SAMPLING.reach, [100.0, 300.0, 100.0], raster=300.0)
    found = measured(sets, taking, epoch=EPOCH, duration=20 * DAY)
    np.testing.assert_array_equal(
        found.epochs, DAY * np.array([1.0, 2.0, 2.0, 2.0, 3.0]) + [0, 0, 300, 600, 300]
    )
    assert (found.points["t"] % 300.0 == 0.0).all()
    fewer = measured(sets.iloc[:2], taking, epoch=EPOCH, duration=20 * DAY)
    np.testing.assert_array_equal(fewer.epochs, found.epochs[:2])
    known = table_of(found).groupby("track")["t_known"].first()
    assert (known >= found.epochs).all()
    assert known.iloc[-1] == 3.0 * DAY + 300.0
    late = found.points.iloc[-1]
    np.testing.assert_array_equal(late[STATE], states_of(sets.iloc[-1], epoch=EPOCH, t=found.epochs[-1:])[0])
