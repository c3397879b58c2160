"""Manoeuvres: lists of them, what tables keep of them, and which spans they lie in, once known."""

import math

import numpy as np
import pytest
from support import EPOCH, refusal, refusals

from opml.orbits import manoeuvres
from opml.orbits.manoeuvres import Manoeuvre
from opml.tables import SCHEMAS, write_table

PUBLISHED = """\
SATCAT number: 25544
manoeuvre_timestamps:
- 2016-09-28 14:09:45
- 2016-09-28T13:09:45.5Z
name: ISS
"""


@pytest.mark.parametrize(
    "content",
    [PUBLISHED, "- 2016-09-28 14:09:45\n- '2016-09-28T13:09:45.500'\n"],
    ids=["under a key", "a list alone"],
)
def test_a_file_of_manoeuvres_is_read_as_it_is(tmp_path, content):
    (tmp_path / "burns.yaml").write_text(content)
    times = manoeuvres.read_times(tmp_path / "burns.yaml")
    assert [time[:21] for time in times] == ["2016-09-28T14:09:45", "2016-09-28T13:09:45.5"]
    assert manoeuvres.at_times(times, epoch=EPOCH) == [Manoeuvre(3600.5), Manoeuvre(7200.0)]


@pytest.mark.parametrize(("content", "expected"), refusals("lists_of_manoeuvres"))
def test_a_file_that_is_no_list_of_manoeuvres_is_told(tmp_path, content, expected):
    path = tmp_path / "burns.yaml"
    path.write_text(content)
    assert refusal(manoeuvres.read_times, path).startswith(f"{path}: {expected}")


def test_tables_keep_manoeuvres_and_since_when_they_are_known(tmp_path):
    burns = [Manoeuvre(5.0), Manoeuvre(7.0, 9.0), Manoeuvre(8.0, restarts=True)]
    facts = manoeuvres.facts(burns)
    assert facts == {"manoeuvres": [{"t": 5.0}, {"t": 7.0, "known": 9.0}, {"t": 8.0, "restarts": True}]}
    write_table(tmp_path / "t.parquet", SCHEMAS["tracking"].empty(), "tracking", metadata=facts)
    assert manoeuvres.read_manoeuvres(tmp_path / "t.parquet") == burns


@pytest.mark.parametrize(
    ("burn", "contain"),
    [
        (Manoeuvre(2.0), [False, True, True, False]),
        (Manoeuvre(2.0, 2.5), [False, False, True, False]),
        (Manoeuvre(2.0, 3.0), [False, False, True, False]),
        (Manoeuvre(2.0, math.inf), [False] * 4),
    ],
)
def test_a_span_contains_what_was_known_by_its_end(burn, contain):
    begin, end = np.array([0.0, 1.0, 1.0, 2.0]), np.array([1.0, 2.0, 3.0, 4.0])
    assert manoeuvres.contain_any(begin, end, [burn]).tolist() == contain


def test_a_window_counts_unless_fits_begin_anew():
    begin, end = np.array([1.0, 2.5, 4.0]), np.array([3.0, 3.0, 5.0])
    for restarts, contain in ((False, [True, True, False]), (True, [True, False, False])):
        burn = Manoeuvre(2.0, restarts=restarts)
        assert manoeuvres.contain_any(begin, end, [burn], window=1.0).tolist() == contain


def test_fits_are_spoilt_from_when_a_manoeuvre_in_their_window_is_known():
    t, named, found = np.array([1.0, 2.5, 3.0, 4.0]), Manoeuvre(2.0), Manoeuvre(2.0, 2.8, restarts=True)
    since = {
        burns: manoeuvres.when_burns_are_known(t - 1.5, t, burns).tolist()
        for burns in ((), (named,), (found,))
    }
    assert since[()] == [math.inf] * 4
    assert since[(named,)] == [math.inf, 2.0, 2.0, math.inf]
    assert since[(found,)] == [math.inf, 2.8, math.inf, math.inf]  # the window at 3.0 begins behind it
