"""The weather on the page of a day: what was seen by its hour, and the newest forecast by then."""

import numpy as np
import pandas as pd
import pytest

from opml.base.constants import DAY, HOUR
from opml.mornings import weather_of_day

NOW = 10.26 * DAY  # between two nodes of the tables
FIGURES = list(weather_of_day.FIGURES)


def grid(begin, end, level):
    t = np.arange(begin, end, HOUR)
    return pd.DataFrame({"t": t, "f107": level + t / DAY, "f107_mean": level, "kp_24h": 2.0})


SEEN = grid(0.0, 40.0 * DAY, 100.0)
OUTLOOKS = pd.concat(
    [grid(day * DAY + HOUR, (day + 9.0) * DAY, 1000.0 * day).assign(issued=day * DAY) for day in range(20)]
)
FUTURES = pd.concat(
    [OUTLOOKS.assign(member=member, kp_24h=2.0 + member) for member in range(11)], ignore_index=True
)


@pytest.fixture(scope="module")
def rows():
    return weather_of_day.about(SEEN, OUTLOOKS, FUTURES, now=NOW)


def test_days_up_to_the_morning_were_seen_and_later_ones_were_forecast(rows):
    assert ((rows["t"] - NOW) / DAY).tolist() == list(range(-3, 8))
    assert rows["is_seen"].tolist() == [True] * 4 + [False] * 7
    assert rows.loc[rows["is_seen"], "f107_mean"].eq(100.0).all()
    assert rows.loc[~rows["is_seen"], "f107_mean"].eq(10_000.0).all()
    assert rows["f107"].iloc[3] == pytest.approx(110.25)  # of the node before


def test_nothing_after_the_morning_touches_it(rows):
    later = SEEN["t"] > NOW
    seen = SEEN.assign(**{name: SEEN[name].where(~later, -1.0) for name in FIGURES})
    outlooks, futures = (table[table["issued"] <= NOW] for table in (OUTLOOKS, FUTURES))
    pd.testing.assert_frame_equal(weather_of_day.about(seen, outlooks, futures, now=NOW), rows)


def test_ranges_are_those_of_the_futures_ahead(rows):
    ahead = rows[~rows["is_seen"]]
    assert ahead[["kp_24h_low", "kp_24h_high"]].to_numpy() == pytest.approx(np.tile([3.0, 11.0], (7, 1)))
    assert rows.loc[rows["is_seen"], "kp_24h_low"].isna().all()


def test_without_a_forecast_the_days_ahead_are_taken_for_known():
    rows = weather_of_day.about(SEEN, None, None, now=NOW)
    assert len(rows) == 11
    assert rows["f107_mean"].eq(100.0).all()
    assert rows["kp_24h_low"].isna().all()


def test_days_that_no_table_covers_are_left_out():
    rows = weather_of_day.about(SEEN, OUTLOOKS[OUTLOOKS["issued"] > NOW], FUTURES, now=DAY)
    assert ((rows["t"]) / DAY).tolist() == [0.0, 1.0]
