"""What the catalogue claims of its own orbits beside the usual errors of public sets."""

import numpy as np
import pytest
from support import shared

from opml.base.constants import DAY, EARTH_GM, WGS84_A
from validation.pictures.claimed_sizes import claimed_sizes, summary, table

SLOW = "real/cara/000043613_conj_000052010_20230626_045217_20230620_061741.cdm.gz"
ECCENTRIC = "real/cara/000039574_conj_000039477_20220711_110033_20220705_220442.cdm.gz"


def test_drag_carries_an_object_as_its_shrinking_orbit_runs_ahead():
    objects = table([str(shared(SLOW))])
    assert objects["claimed"].to_numpy() == pytest.approx([11643.4, 117783.6], abs=0.1)
    row = objects.iloc[1]
    t = np.linspace(0.0, row["days"] * DAY, 2001)
    half_axis = 1e3 * row["height"] + WGS84_A
    shrunk = half_axis - 2.0 * half_axis**2 * 0.010557 / EARTH_GM * t
    ahead = np.trapezoid(np.sqrt(EARTH_GM / shrunk**3) - np.sqrt(EARTH_GM / half_axis**3), t)
    assert row["drag"] == pytest.approx(half_axis * ahead, rel=0.01)


def test_orbits_of_which_no_error_was_learned_are_left_out():
    objects = table([str(shared(one)) for one in (SLOW, ECCENTRIC)])
    assert objects["usual"].isna().tolist() == [False, False, False, True]
    low, high = claimed_sizes(objects).axes
    assert low.get_title(loc="left") == "below 600 km: 3 objects"
    assert high.get_title(loc="left") == "above 600 km: 0 objects"
    assert summary(objects.assign(claimed=0.5 * objects["usual"])).splitlines()[0] == (
        "over 10 km: 2.00 (2.00 to 2.00), 3"
    )
