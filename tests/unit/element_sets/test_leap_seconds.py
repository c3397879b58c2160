"""Sets that judge sets across a leap second: SGP4 propagates SI seconds, days of UTC have 86 401 of them."""

import numpy as np
import pytest
from element_histories import FIRST

from opml.base import epochs
from opml.base.constants import DAY
from opml.element_sets import catalogue, set_errors
from opml.interop.element_sets import element_set, tle
from opml.interop.predicted_orbit import LEADS

NOONS = ["2016-12-30T12:00:00", "2016-12-31T12:00:00", "2017-01-01T12:00:00", "2017-01-02T12:00:00"]


@pytest.fixture(scope="module")
def sets(tmp_path_factory):
    """Sets of one orbit without drag, a day apart, over the leap second of 2016."""
    first = element_set.satellite(NOONS[0], [60.0 * FIRST[0], *FIRST[1:], 1e-9])
    path = tmp_path_factory.mktemp("leap") / "sets.tle"
    with path.open("w") as file:
        for noon in NOONS:
            minutes = epochs.seconds_between(NOONS[0], noon) / 60.0
            node, perigee, anomaly = (
                angle + rate * minutes
                for angle, rate in zip(FIRST[3:], (first.nodedot, first.argpdot, first.mdot), strict=True)
            )
            elements = [60.0 * FIRST[0], FIRST[1], FIRST[2], node, perigee, anomaly, 1e-9]
            print(*tle.lines(element_set.satellite(noon, elements), 25544), sep="\n", file=file)
    return catalogue.read([path], latency=0.0)


def test_sgp4_does_not_err_by_a_second_of_its_way(sets):
    """7.7 km are a second's way; what is left is that TLEs are rounded."""
    rows, _ = set_errors.build(sets, np.array([57752.5, 57753.5, 57754.5]))
    assert len(rows.dropna(subset="error")) > 3
    assert rows["error"].abs().max() < 200.0
    across = rows[(rows["newest"] == 0) & (rows["lead"] == 3)]
    assert across["tau"].tolist() == [3.0 + 1.0 / DAY]


def test_no_set_of_them_misses_those_before_it(sets):
    _, misses = set_errors.build(sets, np.array([57755.0]))
    assert np.nanmax(np.abs(misses)) < 200.0


def test_errors_of_a_prediction_s_past_are_those_of_its_orbit(sets):
    errors = set_errors.in_rsw(sets, epochs.mjd("2017-01-02T13:00:00") - np.arange(1.0, 13.0), LEADS)
    assert len(errors) > 3
    assert errors["s"].abs().max() < 200.0


def test_leap_seconds_are_counted_from_the_day_they_begin():
    assert epochs.leap_seconds([57753.9, 57754.0, 57000.0], [57754.0, 57753.9, 60000.0]).tolist() == [
        1,
        -1,
        2,
    ]
