"""Who watches one object for weeks: what is known on a morning, and what raises an alarm."""

import numpy as np
import sinking_histories

from opml.conjunctions.conjunction import Conjunction, Participant
from opml.interop.element_sets.mean_elements import read_sets
from opml.interop.object_ids import ObjectId
from validation import watch


def test_a_morning_knows_sets_of_six_hours_before_and_of_living_objects(tmp_path):
    sinking_histories.write(tmp_path / "sets.tle", range(60001, 60003), 30)
    sets = sorted(read_sets(tmp_path / "sets.tle", []), key=watch.epoch)
    past = watch.known(sets, np.datetime64("2025-11-25T07:59:59"))
    assert {number: len(own) for number, own in past.items()} == {60001: 5, 60002: 5}
    last = [one for one in sets if one.number == 60001 or watch.epoch(one) < np.datetime64("2025-11-30")]
    assert list(watch.known(last, np.datetime64("2025-12-09T01:00:00"))) == [60001, 60002]
    assert list(watch.known(last, np.datetime64("2025-12-09T03:00:00"))) == [60001]


def test_alarms_are_counted_with_independent_errors_and_with_what_both_share():
    state = np.array([7e6, 0.0, 0.0, 0.0, 7.5e3, 0.0])
    other = state + np.array([10.0, 0.0, 0.0, 0.0, 0.0, 5e3])
    pair = [
        Participant(ObjectId(name), each, np.diag([50.0, 50.0, 50.0, 1e-3, 1e-3, 1e-3]) ** 2)
        for name, each in (("a", state), ("b", other))
    ]
    found = watch.counts([Conjunction(0.0, *pair, 20.0)], "a case")
    assert (found["within_10_km"], found["within_1_km"]) == (1, 1)
    assert (found["alarms"], found["alarms_correlated"]) == (1, 0)
    assert found["largest"] > watch.THRESHOLD
    assert watch.counts([], "none")["largest"] == 0.0
