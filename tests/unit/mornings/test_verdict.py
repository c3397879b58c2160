"""Verdicts on made-up pasts, and what a morning writes of the sizes it stated."""

import numpy as np
import pandas as pd
import pytest
from mornings import replays

from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.learning.judge.error_sizes import Sizes
from opml.mornings import days, issued
from opml.mornings.records import Records
from opml.mornings.verdict import DO_NOT_USE, GOOD, WIDE, verdict
from opml.tables import SIGMA_STATE

NOW = 20.0 * DAY


def records(*, sigma, days=20, left=None):
    """Records of a model with errors of 100 m a day along the track; sigma: as stated of a day [m]."""
    past = replays(days=days, a_morning=1).assign(model="fit96")
    past = past[past["t_known"] <= NOW]
    past["sigma_y"] = sigma * past["duration"] / DAY
    if left is not None:
        past.loc[past["t_known"] > NOW - DAY, "e_y"] = left
    return Records(Records.empty().estimates, past, Records.empty().issued)


def start(age=0.1):
    return pd.DataFrame({"track": [1], "t": [NOW - age * DAY]})


@pytest.mark.parametrize(
    ("past", "age", "word", "reason"),
    [
        (records(sigma=100.0), 0.1, GOOD, "90 % intervals held"),
        (records(sigma=40.0), 0.1, WIDE, "90 % intervals held"),
        (records(sigma=100.0), 2.0, DO_NOT_USE, "2.0 days old"),
        (records(sigma=100.0, left=5000.0), 0.1, DO_NOT_USE, "sigma off"),
    ],
)
def test_verdicts_follow_from_what_was_judged(past, age, word, reason):
    found = verdict(past, start(age), now=NOW)
    assert found.word == word
    assert reason in found.reason


def test_after_few_mornings_nothing_is_good():
    past = records(sigma=100.0)
    few = Records(past.estimates, past.judged[past.judged["morning"] >= 15 * DAY], past.issued)
    assert verdict(few, start(), now=NOW).word == WIDE


def test_intervals_are_held_against_what_differences_show():
    """Of 100 m a later estimate hides 90: errors of 100 m are too many for what is left."""
    past = records(sigma=100.0)
    hidden = past.judged["sigma_y"] * 0.9
    alike = Records(past.estimates, past.judged.assign(doubt_y=hidden, alike=True), past.issued)
    assert verdict(alike, start(), now=NOW).word == WIDE
    assert verdict(past, start(), now=NOW).word == GOOD


def test_what_was_not_flown_has_no_say():
    """Of a model that was only a candidate no standard deviation was stated."""
    past = records(sigma=100.0)
    other = past.judged.assign(model="other", e_y=1e6, sigma_y=np.nan)
    both = Records(past.estimates, pd.concat([past.judged, other]), past.issued)
    assert verdict(both, start(), now=NOW) == verdict(past, start(), now=NOW)


def test_the_sizes_of_a_morning_come_back_from_its_row():
    judged = replays(days=20, a_morning=1).assign(model="fit96")
    judged = judged[judged["t_known"] <= NOW]
    flown = issued.chosen(
        Records(Records.empty().estimates, judged, Records.empty().issued), ["fit96"], now=NOW
    )
    row = issued.row(NOW, start(), flown, GOOD)
    later = judged.head(5).assign(morning=NOW, **dict.fromkeys(SIGMA_STATE, np.nan))
    other = later.assign(model="other")
    found = issued.with_sigmas(pd.concat([later, other], ignore_index=True), row)
    np.testing.assert_array_equal(
        found[SIGMA_STATE].to_numpy()[:5], Sizes.learned(judged, now=NOW).sigmas(later)
    )
    assert found[SIGMA_STATE].iloc[5:].isna().all(axis=None)


def test_without_a_past_no_model_is_chosen():
    with pytest.raises(InputError, match="judged"):
        issued.chosen(Records.empty(), ["fit96"], now=NOW)


def test_scores_are_by_day_of_duration():
    scores = days.scores(records(sigma=100.0).judged)
    assert [score["day"] for score in scores] == [1, 2, 3, 4, 5, 6, 7]
    assert scores[6]["along_track_m"] > 3 * scores[0]["along_track_m"]
    assert 0.7 < np.mean([score["inside"] for score in scores]) < 1.0
