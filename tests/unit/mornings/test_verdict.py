"""Verdicts on made-up pasts, and what a morning writes of the sizes it stated."""

import numpy as np
import pandas as pd
import pytest
from mornings import replays

from opml.base.constants import DAY
from opml.ephemerides.fit_sizes import FORMAL
from opml.learning.models import learners
from opml.mornings import days, issued
from opml.mornings.outcomes import DO_NOT_USE, GOOD, UNPROVEN, WIDE
from opml.mornings.records import Records
from opml.mornings.verdicts import Verdict, medians_with_sgp4, verdict
from opml.orbits.manoeuvres import Manoeuvre
from opml.tables import SIGMA_STATE

NOW = 20.0 * DAY


def judged(*, sigma, days=20, left=None):
    """Rows of a model with errors of 100 m a day along the track; sigma: as stated of a day [m]."""
    past = replays(days=days, a_morning=1).assign(model="fit96")
    past = past[past["t_known"] <= NOW]
    past["sigma_y"] = sigma * past["duration"] / DAY
    if left is not None:
        past.loc[past["t_known"] > NOW - DAY, "e_y"] = left
    return past


def sinking(off):
    """Rows of an object whose drag has begun to rise: one of the newest errors is so many sigma."""
    past = judged(sigma=100.0)
    newest = past.index[(past["t_known"] > past["t_known"].max() - DAY) & (past["duration"] < 2.0 * DAY)]
    past.loc[newest[-1], "e_y"] = off * past.loc[newest[-1], "sigma_y"]
    return past


def start(age=0.1):
    return pd.DataFrame({"track": [1], "t": [NOW - age * DAY]})


@pytest.mark.parametrize(
    ("past", "age", "word", "reason"),
    [
        (judged(sigma=100.0), 0.1, GOOD, "90 % intervals contained"),
        (judged(sigma=40.0), 0.1, WIDE, "90 % intervals contained"),
        (judged(sigma=100.0), 2.0, DO_NOT_USE, "2.0 days old"),
        (judged(sigma=100.0, left=5000.0), 0.1, DO_NOT_USE, "sigma off"),
        (sinking(4.0), 0.1, WIDE, "one of the newest estimates is 4.0 sigma off"),
        (sinking(2.0), 0.1, GOOD, "90 % intervals contained"),
    ],
)
def test_verdicts_follow_from_what_was_judged(past, age, word, reason):
    found = verdict(past, start(age), now=NOW)
    assert found.word == word
    assert reason in found.reason


def test_a_day_without_tracks_mends_nothing():
    tomorrow, past = NOW + DAY, judged(sigma=100.0, left=5000.0)
    found = verdict(past, pd.DataFrame({"track": [1], "t": [NOW]}), now=tomorrow)
    assert found.word == DO_NOT_USE
    assert "sigma off" in found.reason


def test_after_few_mornings_an_ephemeris_is_unproven():
    past = judged(sigma=100.0)
    assert verdict(past[past["morning"] >= 15 * DAY], start(), now=NOW).word == UNPROVEN


def test_intervals_of_an_object_that_was_lost_for_weeks_are_not_known():
    later = NOW + 20.0 * DAY
    found = verdict(judged(sigma=100.0), pd.DataFrame({"track": [1], "t": [later]}), now=later)
    assert found == Verdict(UNPROVEN, "nothing was judged in the last 14 days")


def test_nothing_is_good_within_a_window_of_a_burn():
    past, burn = judged(sigma=100.0), [Manoeuvre(NOW - 0.4 * DAY)]
    found = verdict(past, start(), now=NOW, burns=burn, window=0.5 * DAY)
    assert found == Verdict(DO_NOT_USE, "a burn 10 hours ago, after which fits begin")
    assert verdict(past, start(), now=NOW, burns=burn, window=0.25 * DAY).word == GOOD
    planned = [Manoeuvre(NOW + 0.1 * DAY), Manoeuvre(NOW - 0.1 * DAY, known=NOW + 1.0)]
    assert verdict(past, start(), now=NOW, burns=planned, window=0.5 * DAY).word == GOOD


def test_what_was_not_flown_has_no_say():
    """Of a model that was only a candidate no standard deviation was stated."""
    past = judged(sigma=100.0)
    other = past.assign(model="other", e_y=1e6, sigma_y=np.nan)
    assert verdict(pd.concat([past, other]), start(), now=NOW) == verdict(past, start(), now=NOW)


def on_fifth_day(errors_out):
    """Rows whose errors are inside, but for so many of the newest with lead times of the fifth day."""
    past = judged(sigma=200.0)
    fifth = past.index[np.ceil(past["duration"] / DAY) == 5.0][-errors_out:]
    return past.assign(e_y=past["e_y"].mask(past.index.isin(fifth), 1e5))


def test_intervals_that_fail_at_one_lead_time_are_wide():
    found = verdict(on_fifth_day(14), start(), now=NOW)
    assert found == Verdict(WIDE, "its 90 % intervals contained 0 % of the last errors on day 5 ahead")


def test_a_few_errors_of_one_lead_time_are_chance():
    assert verdict(on_fifth_day(4), start(), now=NOW).word == GOOD


MENU = {
    "fit96": learners.of_job({"kind": "refitted", "variables": ["l_arc_y"], "window_hours": 96.0}),
    "running": learners.of_job(
        {
            "kind": "running",
            "variables": ["l_arc_y", "v_arc_y", "cd_arc", "cd_past"],
            "window_hours": 12.0,
            "memory_days": 30.0,
        }
    ),
}


def selected(past, c=0.6):
    """The model that is selected by a past; c: error of the density."""
    formal = pd.DataFrame([[9.0, 9.0, 9.0, 2.0, 50.0, 3.0, c]], columns=FORMAL, index=[1])
    return issued.select(past, MENU, formal.loc[1], formal, now=NOW)


def test_the_sizes_of_a_morning_come_back_from_its_row():
    past = replays(days=20, a_morning=1).assign(model="fit96")
    one = selected(past[past["t_known"] <= NOW])
    row = issued.row(NOW, start(), one, GOOD)
    later = past.head(5).assign(morning=NOW, **dict.fromkeys(SIGMA_STATE, np.nan))
    other = later.assign(model="other")
    found = issued.with_sigmas(pd.concat([later, other], ignore_index=True), row)
    np.testing.assert_array_equal(found[SIGMA_STATE].to_numpy()[:5], one.sizes.sigmas(later))
    assert found[SIGMA_STATE].iloc[5:].isna().all(axis=None)


def test_without_a_past_a_fit_has_its_own_drag_where_it_knows_it():
    nothing = Records.empty().judged
    assert (selected(nothing).model, selected(nothing, c=5.0).model) == ("fit96", "running")
    assert selected(nothing).basis == f"from {issued.USUAL}"
    assert selected(judged(sigma=100.0).head(19).assign(model="running")).model == "fit96"


def test_what_is_known_later_has_no_say():
    past = judged(sigma=100.0)
    later = past.assign(e_y=1e4, t_known=NOW + 1.0)
    both = selected(pd.concat([past, later], ignore_index=True))
    np.testing.assert_array_equal(both.sizes.scales, selected(past).sizes.scales)
    assert len(both.past) == len(past)


def test_scores_are_by_day_of_duration():
    scores = days.scores(judged(sigma=100.0))
    assert [score["day"] for score in scores] == [1, 2, 3, 4, 5, 6, 7]
    assert scores[6]["along_track_m"] > 3 * scores[0]["along_track_m"]
    assert 0.7 < np.mean([score["inside"] for score in scores]) < 1.0


def test_medians_of_sgp4_are_of_the_same_epochs_by_day_ahead():
    past = judged(sigma=100.0)
    sgp4 = past.assign(model="sgp4", e_y=-3.0 * past["e_y"], sigma_y=np.nan).iloc[1:]
    found = medians_with_sgp4(pd.concat([past, sgp4]))
    both = past.iloc[1:].groupby(np.ceil(past["duration"] / DAY))["e_y"].apply(lambda e: e.abs().median())
    assert [one["day"] for one in found] == both.index.tolist()
    assert [one["flown_m"] for one in found] == both.round(1).tolist()
    assert [one["sgp4_m"] for one in found] == pytest.approx((3.0 * both).tolist(), abs=0.06)
    mornings = past.iloc[1:].groupby(np.ceil(past["duration"] / DAY))["morning"].nunique()
    assert [one["mornings"] for one in found] == mornings.tolist()
    assert medians_with_sgp4(past) == []


def test_a_model_that_is_new_in_the_menu_waits_for_a_past_of_its_own():
    past = replays(days=20, a_morning=1).assign(model="fit96")
    past = past[past["t_known"] <= NOW]
    better = past.tail(19).assign(model="running", e_y=0.0)
    assert selected(pd.concat([past, better])).model == "fit96"
    assert selected(pd.concat([past, past.assign(model="running", e_y=0.0)])).model == "running"
