"""The burns found in histories of mean elements, compared with published ones."""

import numpy as np
import pytest
from support import shared

from opml.base.constants import DAY
from opml.orbits.manoeuvres import Manoeuvre
from validation import burns


def test_burns_are_held_against_published_ones():
    found = [Manoeuvre(day * DAY, (day + 1.0) * DAY) for day in (2.0, 10.2, 11.9, 30.0, 50.0)]
    published = np.array([1.0, 10.0, 20.0, 60.0]) * DAY
    judged = burns.judged(found, published, (5.0 * DAY, 40.0 * DAY))
    assert (judged.published, judged.false) == (2, 1)
    assert judged.late == pytest.approx([1.2 * DAY])
    row = judged.row()
    assert (row["found"], row["found_%"]) == (1, 50.0)
    assert row["false_per_year"] == pytest.approx(365.25 / 35.0)
    assert np.isnan(burns.judged([], published, (5.0 * DAY, 40.0 * DAY)).row()["days_late"])


def test_burns_of_a_satellite_are_found_in_its_history():
    judged = burns.of_object(shared("real/burns/Sentinel-3B.yaml").parents[1], "Sentinel-3B")
    assert judged.published == 45
    assert len(judged.late) >= 42
    assert judged.false <= 1
    assert np.median(judged.late) < 2.0 * DAY
