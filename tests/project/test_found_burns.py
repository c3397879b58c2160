"""The burns found in histories of mean elements, compared with published ones."""

import numpy as np
from support import shared

from opml.base.constants import DAY
from validation import burns


def test_burns_of_a_satellite_are_found_in_its_history():
    judged = burns.of_object(shared("real/burns/Sentinel-3B.yaml").parents[1], "Sentinel-3B")
    assert judged.published == 45
    assert len(judged.late) >= 42
    assert judged.false <= 1
    assert np.median(judged.late) < 2.0 * DAY
