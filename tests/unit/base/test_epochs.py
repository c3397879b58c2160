"""Time scales against the definitions they are built on."""

from datetime import date, datetime, timedelta, timezone

import numpy as np
import pytest
from support import refusals

from opml.base import epochs
from opml.base.constants import DAY, HOUR
from opml.base.errors import InputError
from opml.environment import MARGIN_S, STEP_S, nodes

EPOCH = "2016-09-28T12:09:45"
BEFORE_LEAP = "2016-12-31T23:00:00"


def seconds_between(later, earlier):
    return ((later[0] - earlier[0]) + (later[1] - earlier[1])) * DAY


def test_tt_is_tai_plus_32_184_s():
    t = np.array([0.0, 1e6])
    assert seconds_between(epochs.tt(EPOCH, t), epochs.tai(EPOCH, t)) == pytest.approx(32.184, abs=1e-9)


def test_tai_leads_utc_by_36_s_in_2016_and_37_s_after_the_leap_second():
    # Two hours after, and the day before: ERFA stretches the day of the leap second itself.
    t = np.array([-DAY, 2 * HOUR])
    lead = seconds_between(epochs.tai(BEFORE_LEAP, t), epochs.utc(BEFORE_LEAP, t))
    assert lead == pytest.approx([36.0, 37.0], abs=1e-4)


def test_tdb_follows_its_leading_annual_term():
    # TDB - TT = 0.001657 s sin(g), g the Earth's mean anomaly (Astronomical Almanac), good to 30 us.
    t = np.linspace(0.0, 365.0 * DAY, 50)
    tt = epochs.tt(EPOCH, t)
    g = np.radians(357.53 + 0.9856003 * (tt[0] + tt[1] - 2451545.0))
    assert seconds_between(epochs.tdb(EPOCH, t), tt) == pytest.approx(0.001657 * np.sin(g), abs=4e-5)


def test_elapsed_counts_the_leap_second():
    assert epochs.seconds_between(BEFORE_LEAP, "2017-01-01T00:00:00") == 3601.0
    assert epochs.seconds_between(EPOCH, "2016-09-28T12:00:00") == -585.0


TIMES = {
    "a text": "2016-09-28T12:00:00",
    "a text with Z": "2016-09-28T12:00:00Z",
    "a blank": "2016-09-28 12:00",
    "an hour": "2016-09-28T12",
    "a datetime": datetime(2016, 9, 28, 12),
    "one of another zone": datetime(2016, 9, 28, 14, tzinfo=timezone(timedelta(hours=2))),
    "numpy's": np.datetime64("2016-09-28T12:00:00"),
}


@pytest.mark.parametrize("form", TIMES)
def test_a_time_has_many_forms(form):
    assert epochs.seconds_between("2016-09-28T12:00:00", epochs.instant(TIMES[form])) == 0.0


def test_a_day_is_when_it_begins():
    assert epochs.instant(date(2016, 9, 28)) == epochs.instant("2016-09-28") == "2016-09-28T00:00:00"


def test_the_leap_second_itself_is_an_instant():
    assert epochs.seconds_between(BEFORE_LEAP, "2016-12-31T23:59:60.5") == 3600.5


@pytest.mark.parametrize("text", refusals("epochs"))
def test_a_malformed_epoch_is_refused_in_one_line(text):
    with pytest.raises(InputError, match=r"^epoch: expected") as caught:
        epochs.tai(text, 0.0)
    assert "\n" not in str(caught.value)


def test_years_without_announced_leap_seconds_pass():
    assert epochs.seconds_between("2039-01-01T00:00:00", "2039-01-02T00:00:00") == 86400.0


def test_days_of_year_run_over_the_end_of_a_leap_year():
    midnight, days = epochs.days_of_year("2016-12-30T06:00:00", 3 * DAY)
    assert midnight == -21600.0
    # 2016 has 366 days; the last one listed begins after the end of the run.
    assert days.tolist() == [365, 366, 1, 2, 3]
    assert midnight + DAY * len(days) > 3 * DAY


@pytest.mark.parametrize("epoch", [EPOCH, "2016-09-28T12:00:00", "2016-09-28T12:59:59.5"])
@pytest.mark.parametrize("duration", [0.0, DAY, 4320000.0])
def test_nodes_are_uniform_whole_hours_with_margins(epoch, duration):
    t = nodes(epoch, duration)
    assert np.diff(t) == pytest.approx(STEP_S, abs=0)
    utc = epochs.utc(epoch, t)
    hours = (utc[0] + utc[1] - 0.5) * 24.0
    assert hours == pytest.approx(np.round(hours), abs=1e-6)
    assert -MARGIN_S - STEP_S < t[0] <= -MARGIN_S
    assert duration + MARGIN_S <= t[-1] < duration + MARGIN_S + STEP_S
