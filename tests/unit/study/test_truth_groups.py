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


def test_as_many_fly_together_as_a_kernel_has_lanes(tmp_path):
    found = groups(STUDY, [*NAMES, "given"], results=tmp_path)
    assert found == [tuple(NAMES[:LANES]), tuple(NAMES[LANES:])]


@pytest.mark.parametrize("alone", [[], NAMES[:1], ["given"], [*NAMES[:1], "given"]])
def test_one_rso_is_no_flight(tmp_path, alone):
    assert groups(STUDY, alone, results=tmp_path) == []


def test_an_rso_that_is_added_flies_alone(tmp_path):
    fly(tmp_path, NAMES[:3])
    assert groups(STUDY, [NAMES[5], *NAMES[:3]], results=tmp_path) == [tuple(NAMES[:3])]


def test_rsos_that_are_added_fly_together(tmp_path):
    fly(tmp_path, NAMES[:3])
    fly(tmp_path, NAMES[3:4])
    expected = [tuple(NAMES[:3]), tuple(NAMES[4:6])]
    assert groups(STUDY, NAMES[:6], results=tmp_path) == expected
    # Whoever is asked for less finds the same group.
    assert groups(STUDY, NAMES[1:2], results=tmp_path) == expected[:1]


def test_groups_keep_their_order_whichever_is_over_first(tmp_path):
    first, second = NAMES[:LANES], NAMES[LANES:]
    fly(tmp_path, second)
    assert groups(STUDY, NAMES, results=tmp_path) == [tuple(first), tuple(second)]


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


def test_no_rso_is_in_two_groups(tmp_path):
    fly(tmp_path, NAMES[:2])
    fly(tmp_path, NAMES[1:3])
    assert groups(STUDY, NAMES[:3], results=tmp_path) == [tuple(NAMES[:2])]


def test_the_groups_of_other_studies_are_left_alone(tmp_path):
    fly(tmp_path, NAMES[:3])
    assert groups(STUDY, NAMES[3:5], results=tmp_path) == [tuple(NAMES[3:5])]


def test_a_flight_with_an_rso_that_is_not_simulated_any_more_is_none(tmp_path):
    fly(tmp_path, [*NAMES[:2], "given"])
    assert groups(STUDY, NAMES[:3], results=tmp_path) == []
