"""Which truths one job flies, and which stay as they flew."""

import numpy as np
import pandas as pd
import pytest

from opml.base.constants import LANES
from opml.orbits.sheets import Rso
from opml.study.truth_groups import groups
from opml.tables import STATE, TRUTH_GROUPS, write_table

BODY = Rso(
    "sky", a=7e6, e=0.0, i=1.0, argp=0.0, raan=0.0, mean_anomaly=0.0, area_to_mass=0.02, cd=2.2, cr=1.25
)


class Told:
    """A study that knows some RSOs, and that one of them has an orbit of its own."""

    def __init__(self, rsos):
        self.sheet = dict.fromkeys(rsos, BODY)
        self.settings = self
        self.orbits, self.measured = {"given": ["given.sp3"]}, {}


NAMES = [f"sky{k:02d}" for k in range(20)]
STUDY = Told([*NAMES, "given"])


def truth(results, rso):
    return results / "truth" / f"{rso}.parquet"


def told(results, group):
    return results / "truth_groups" / f"{group[0]}.parquet"


def fly(results, group):
    """Write the truths of a group as its job does."""
    table = pd.DataFrame(dict.fromkeys(["t", *STATE], np.zeros(1)))
    for rso in group:
        write_table(truth(results, rso), table, "truth", metadata={})
    if len(group) > 1:
        write_table(told(results, group), pd.DataFrame({"rso": group}), TRUTH_GROUPS, metadata={})


GROUPS = {  # groups that flew, what is asked for, groups that fly or flew
    "as many as a kernel has lanes": ([], [*NAMES, "given"], [NAMES[:LANES], NAMES[LANES:]]),
    "none": ([], [], []),
    "one": ([], NAMES[:1], []),
    "one of a file": ([], ["given"], []),
    "one, and one of a file": ([], [*NAMES[:1], "given"], []),
    "one more": ([NAMES[:3]], [NAMES[5], *NAMES[:3]], [NAMES[:3]]),
    "some more": ([NAMES[:3], NAMES[3:4]], NAMES[:6], [NAMES[:3], NAMES[4:6]]),
    "less": ([NAMES[:3], NAMES[3:4]], NAMES[1:2], [NAMES[:3]]),
    "the second first": ([NAMES[LANES:]], NAMES, [NAMES[:LANES], NAMES[LANES:]]),
    "one that flew in two": ([NAMES[:2], NAMES[1:3]], NAMES[:3], [NAMES[:2]]),
    "others": ([NAMES[:3]], NAMES[3:5], [NAMES[3:5]]),
    "one that is not simulated any more": ([[*NAMES[:2], "given"]], NAMES[:3], []),
}


@pytest.mark.parametrize(("flown", "asked", "expected"), GROUPS.values(), ids=GROUPS)
def test_rsos_fly_in_groups_that_stay(tmp_path, flown, asked, expected):
    for group in flown:
        fly(tmp_path, group)
    assert groups(STUDY, asked, results=tmp_path) == [tuple(group) for group in expected]


def test_a_truth_that_is_lost_or_damaged_flies_with_those_it_flew_with(tmp_path):
    fly(tmp_path, NAMES[:3])
    truth(tmp_path, NAMES[0]).unlink()
    truth(tmp_path, NAMES[1]).write_text("damaged")
    assert groups(STUDY, NAMES[:4], results=tmp_path) == [tuple(NAMES[:3])]


def test_without_a_sound_table_of_its_flight_a_truth_flew_alone(tmp_path):
    first, second, third = NAMES[:3], NAMES[3:6], NAMES[6:9]
    for group in (first, second, third):
        fly(tmp_path, group)
    told(tmp_path, first).unlink()
    told(tmp_path, second).write_bytes(told(tmp_path, second).read_bytes()[:-100])
    assert groups(STUDY, NAMES[:9], results=tmp_path) == [tuple(third)]


def test_a_flight_whose_truths_are_all_gone_is_none(tmp_path):
    fly(tmp_path, NAMES[1:4])
    for rso in NAMES[1:4]:
        truth(tmp_path, rso).unlink()
    assert groups(STUDY, NAMES[:3], results=tmp_path) == [tuple(NAMES[:3])]
