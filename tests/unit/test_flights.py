"""Which truths one job flies, and which stay as they flew."""

import numpy as np
import pandas as pd
import pytest

from opml.sheets import Rso
from opml.study.flights import LANES, flights
from opml.tables import FLOWN_WITH, STATE, write_table

BODY = Rso(
    "sky", a=7e6, e=0.0, i=1.0, argp=0.0, raan=0.0, mean_anomaly=0.0, area_to_mass=0.02, cd=2.2, cr=1.25
)


class Told:
    """A study that knows some RSOs, and that one of them has an orbit of its own."""

    def __init__(self, rsos):
        self.sheet = dict.fromkeys(rsos, BODY)
        self.settings = self
        self.orbits, self.tracks = {"given": ["given.sp3"]}, {}


NAMES = [f"sky{k:02d}" for k in range(20)]
STUDY = Told([*NAMES, "given"])


def fly(folder, flight):
    """Write the truths of a flight as its job does."""
    table = pd.DataFrame(dict.fromkeys(["t", *STATE], np.zeros(1)))
    metadata = {FLOWN_WITH: list(flight)} if len(flight) > 1 else {}
    for rso in flight:
        write_table(folder / f"{rso}.parquet", table, "truth", metadata=metadata)


def test_as_many_fly_together_as_a_kernel_has_lanes(tmp_path):
    found = flights(STUDY, [*NAMES, "given"], folder=tmp_path)
    assert found == [tuple(NAMES[:LANES]), tuple(NAMES[LANES:])]


@pytest.mark.parametrize("alone", [[], NAMES[:1], ["given"], [*NAMES[:1], "given"]])
def test_one_rso_is_no_flight(tmp_path, alone):
    assert flights(STUDY, alone, folder=tmp_path) == []


def test_an_rso_that_is_added_flies_alone(tmp_path):
    fly(tmp_path, NAMES[:3])
    assert flights(STUDY, [NAMES[5], *NAMES[:3]], folder=tmp_path) == [tuple(NAMES[:3])]


def test_rsos_that_are_added_fly_together(tmp_path):
    fly(tmp_path, NAMES[:3])
    fly(tmp_path, NAMES[3:4])
    expected = [tuple(NAMES[:3]), tuple(NAMES[4:6])]
    assert flights(STUDY, NAMES[:6], folder=tmp_path) == expected
    # Whoever is asked for less finds the same flight.
    assert flights(STUDY, NAMES[1:2], folder=tmp_path) == expected[:1]


def test_flights_keep_their_order_whichever_is_over_first(tmp_path):
    first, second = NAMES[:LANES], NAMES[LANES:]
    fly(tmp_path, second)
    assert flights(STUDY, NAMES, folder=tmp_path) == [tuple(first), tuple(second)]


def test_a_truth_that_is_lost_or_damaged_flies_with_those_it_flew_with(tmp_path):
    fly(tmp_path, NAMES[:3])
    (tmp_path / f"{NAMES[0]}.parquet").unlink()
    (tmp_path / f"{NAMES[1]}.parquet").write_text("damaged")
    assert flights(STUDY, NAMES[:4], folder=tmp_path) == [tuple(NAMES[:3])]


def test_a_flight_with_an_rso_that_is_not_simulated_any_more_is_none(tmp_path):
    fly(tmp_path, [*NAMES[:2], "given"])
    assert flights(STUDY, NAMES[:3], folder=tmp_path) == []
