"""Burns that a history of mean elements tells of, each by sets that were known by then."""

import logging
import re

import numpy as np
import pytest
from element_histories import history, satellite
from support import EPOCH

from opml.base.constants import DAY
from opml.interop.element_sets import burns_in_sets
from opml.interop.element_sets.burns_in_sets import KnownSet
from opml.orbits.manoeuvres import Manoeuvre

DAYS = np.arange(-20.0, 21.0)
AXIS = 6.78e6
NODE_RATE = -1.02e-6
NOISE = 2.0


def sets_with(raised=None, tilted=None, created=None, days=DAYS):
    """Sets of noisy semi-major axes and planes.

    raised, tilted: by day from which on, how many metres the orbit is higher, or its plane is farther off
    """
    sets = history(days, created=created)
    higher, farther = np.random.default_rng(1).normal(scale=NOISE, size=(2, len(sets)))
    since = np.zeros(len(sets))  # how long the orbit has been higher, times how much
    for begin, metres in (raised or {}).items():
        higher += np.where(days >= begin, metres, 0.0)
        since += np.maximum(days - begin, 0.0) * DAY * metres / AXIS
    for begin, metres in (tilted or {}).items():
        farther += np.where(days >= begin, metres, 0.0)
    return sets.assign(
        mean_motion=sets["mean_motion"] * (1.0 - 1.5 * higher / AXIS),
        mean_anomaly=(sets["mean_anomaly"] - 1.5 * sets["mean_motion"] * since) % (2.0 * np.pi),
        raan=(sets["raan"] - 3.5 * NODE_RATE * since) % (2.0 * np.pi),
        inclination=sets["inclination"] + farther / AXIS,
    )


def found(sets):
    known = np.maximum.accumulate(np.fmax(sets["t"], sets["t_created"]))
    rows = zip(sets["t"], known, [satellite(row) for _, row in sets.iterrows()], strict=True)
    return burns_in_sets.burns_among([KnownSet(*row) for row in rows], epoch=EPOCH)


@pytest.mark.parametrize("step", [{"raised": {4.5: 60.0}}, {"raised": {4.5: -60.0}}, {"tilted": {4.5: 60.0}}])
def test_a_burn_is_found_with_the_second_set_after_it(step, caplog):
    with caplog.at_level(logging.DEBUG):
        assert found(sets_with(**step)) == [Manoeuvre(5.0 * DAY, 6.0 * DAY)]
    (message,) = caplog.messages
    assert re.sub(r"\.0+", "", message) == (
        "a burn between 2016-10-02T12:09:45 and 2016-10-03T12:09:45, found by the set of 2016-10-04T12:09:45"
    )


@pytest.mark.parametrize(
    "raised",
    [
        pytest.param({}, id="noise"),
        pytest.param({4.5: 60.0, 5.5: -60.0}, id="a set that is wrong"),
        pytest.param({20.0: 60.0}, id="no set after it yet"),
        pytest.param({-15.0: 60.0}, id="no past"),
    ],
)
def test_no_burn_is_found_where_there_is_none_to_be_known(raised):
    assert found(sets_with(raised)) == []


def test_a_burn_is_known_when_its_sets_are_made():
    created = DAYS + np.where(DAYS == 5.0, 2.0, 0.5)
    assert found(sets_with({4.5: 60.0}, created=created)) == [Manoeuvre(5.0 * DAY, 7.0 * DAY)]


def test_an_orbit_that_is_raised_set_by_set_begins_a_new_past():
    raised = {float(day): 500.0 for day in range(4, 10)}
    (first, *_) = found(sets_with(raised))
    assert first == Manoeuvre(4.0 * DAY, 9.0 * DAY)


def test_a_gap_between_sets_a_few_hours_apart_hides_no_burn():
    """Drag has no more time than between daily sets."""
    days = np.concatenate([np.arange(-10.0, 3.9, 0.2), np.arange(4.9, 10.0, 0.2)])
    (burn,) = found(sets_with({4.5: 60.0}, days=days))
    assert burn.t == pytest.approx(4.9 * DAY)


def test_sets_after_a_burn_may_settle():
    settling = 1.7 * burns_in_sets.OFF * np.sqrt(2.0) * NOISE
    assert len(found(sets_with({9.5: settling}))) == 1
    assert len(found(sets_with({4.5: 200.0, 9.5: settling}))) == 1
    assert len(found(sets_with({4.5: 200.0, 9.5: 200.0}))) == 2


@pytest.mark.parametrize("cut", [5.0, 6.0, 12.0])
def test_later_sets_change_no_burn_that_was_found(cut):
    sets = sets_with({4.5: 60.0, 10.5: 60.0, 15.5: -90.0})
    past = sets[sets["t"] <= cut * DAY]
    assert found(past) == [burn for burn in found(sets) if burn.known <= cut * DAY]
