"""Mornings of objects of public sets: predicted as `opml predict` does, judged by what later sets have."""

from datetime import date, timedelta

import numpy as np
import pandas as pd
import pytest
import sinking_histories
from support import refusal

from opml.base import epochs
from opml.base.constants import DAY
from opml.element_sets import prediction
from opml.interop import known_orbits
from opml.interop.element_sets import known_sets
from opml.mornings import days, set_mornings
from opml.mornings.calendar import Calendar
from opml.mornings.days import UnderWay
from opml.mornings.kept.store import Store
from opml.mornings.outcomes import UNPROVEN
from opml.mornings.set_mornings import of_sets
from opml.mornings.watched_object import MorningPlan
from opml.orbits.manoeuvres import Manoeuvre

EPOCH = "2026-01-03T00:00:00"
LAST = date(2026, 1, 6)
CALENDAR = Calendar(EPOCH, hour=6.0)
PLAN = MorningPlan({}, None, 3.0, 60.0, 10 * DAY, EPOCH)
NUMBER = 102


@pytest.fixture(scope="module", autouse=True)
def coarse_field():
    with pytest.MonkeyPatch.context() as patch:
        sinking_histories.seek_coarsely(patch.setattr)
        yield


def sets_until(path, days_of_sets):
    sinking_histories.write(path, range(NUMBER, NUMBER + 1), days_of_sets)
    return path


def run(path, folder, until=LAST):
    """The mornings of the sets in a file up to a date."""
    sets = set_mornings.read([path], "OBSERVED", since=epochs.mjd(EPOCH))
    watched = of_sets(PLAN, sets, known_sets.by_object([path])[NUMBER])
    store = Store(folder, "0", ["mine"])
    shared = "mine", watched, CALENDAR, store, "digest"
    under_way = UnderWay.begin(*shared, done=store.done(until)["mine"], until=until)
    days.catch_up(store, [under_way], until, metadata={"epoch": EPOCH, "settings": "digest"})
    return folder


@pytest.fixture(scope="module")
def sets(tmp_path_factory):
    return sets_until(tmp_path_factory.mktemp("sets") / "sets.tle", 60)


@pytest.fixture(scope="module")
def whole(sets, tmp_path_factory):
    return run(sets, tmp_path_factory.mktemp("whole"))


def told(folder, day=LAST):
    return Store(folder, "0", ["mine"]).places(day)["mine"].outcomes["mine"]


def contents(folder):
    return {path.relative_to(folder): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def test_a_morning_says_what_predict_says(sets, whole):
    """The same model, the same states, the same sizes of errors."""
    when = f"{LAST}T06:00:00"
    made = prediction.predict(sets, date=when, days=PLAN.max_days)
    outcome = told(whole)
    assert (outcome["model"], outcome["verdict"]) == (made.model, UNPROVEN)
    leads = np.arange(1.0, 4.0)
    names = ("radial_sigma_m", "along_track_sigma_m", "cross_track_sigma_m")
    sigmas = [[one[name] for name in names] for one in outcome["expected"]]
    np.testing.assert_allclose(sigmas, made.sigmas(DAY * leads), atol=0.051)
    (segment,) = known_orbits.segments(whole / str(LAST) / "mine" / "mine.oem", epoch=when)
    assert segment.name == "mine"
    np.testing.assert_allclose(segment.states, made.states(segment.t), atol=1e-5)


def test_later_sets_change_nothing_and_mornings_go_on_where_they_ended(whole, tmp_path):
    """Run in two pieces, from files that grew between them, they are the same to the byte."""
    known = sets_until(tmp_path / "sets.tle", 46)
    folder = run(known, tmp_path / "days", LAST - timedelta(days=1))
    sets_until(known, 60)
    assert contents(run(known, folder)) == contents(whole)


def test_what_was_predicted_is_judged_by_the_newest_set(sets, whole):
    """That of the day before was public by the morning: it judges the morning before its epoch."""
    place = Store(whole, "0", ["mine"]).places(LAST)["mine"]
    judged, (made, by) = place.rows("judged", "mine"), (LAST - timedelta(days=2), LAST)
    assert {*judged["morning"]} == {CALENDAR.time(made)}
    row = judged[np.isfinite(judged["sigma_y"])].iloc[0]
    predicted = prediction.predict(sets, date=f"{made}T06:00:00", days=3.0)
    later = set_mornings._later(prediction.predict(sets, date=f"{by}T06:00:00"), EPOCH, CALENDAR.time(by))
    t = np.array([row["t_j"] - row["morning"]])
    np.testing.assert_allclose(row[["sigma_x", "sigma_y", "sigma_z"]].astype(float), predicted.sigmas(t)[0])
    off = predicted.states(t)[0, :3] - [later[name] for name in "xyz"]
    error = np.linalg.norm(row[["e_x", "e_y", "e_z"]].astype(float))
    assert error == pytest.approx(np.linalg.norm(off), rel=1e-3, abs=0.5)
    assert later["t_set"] == pytest.approx(epochs.seconds_between(EPOCH, "2026-01-05T02:00:00"), abs=1e-3)


def test_what_was_predicted_before_a_burn_was_known_is_not_judged_after_it():
    """It was at 100 s, and known at 200 s."""
    t = [50.0, 150.0, 150.0, 250.0, 250.0]
    judged = pd.DataFrame({"morning": [0.0, 0.0, 120.0, 190.0, 210.0], "t_j": t})
    burns = [Manoeuvre(100.0 - 300.0, 200.0 - 300.0)]
    left = set_mornings._without_burns(judged, burns, now=300.0)
    assert left["morning"].tolist() == [0.0, 210.0]


def test_an_object_is_told_by_its_number_where_there_are_several(tmp_path):
    sinking_histories.write(tmp_path / "two.tle", range(101, 103), 3)
    histories = known_sets.by_object([tmp_path / "two.tle"])
    assert set_mornings.history_of(histories, 102, "two.tle")[-1].number == 102
    told = refusal(set_mornings.history_of, histories, None, "two.tle")
    assert told == "two.tle: expected a number that names the object, got 101, 102"
    assert "expected object 7" in refusal(set_mornings.history_of, histories, 7, "two.tle")
