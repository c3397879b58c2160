"""Objects are told apart by designator and number, however written, and by names where there are none."""

import pytest

from opml.interop.element_sets import tle
from opml.interop.object_ids import UNKNOWN, ObjectId, facts, of_tables
from opml.tables import SCHEMAS, write_table

SAME = [
    (("ISS", "1998-067-A"), ("ISS (ZARYA)", "98067A", "25544")),
    (("ISS", "1998-067A"), ("ISS", "25544", "1998-067A")),
    (("a", "57001B"), ("b", "1957-001B")),
    (("a", "56001B"), ("b", "2056-001B")),
    (("a", "25544"), ("b", "UNKNOWN", "25544")),
    (("mine", "mine"), ("mine",)),
    (("mine", "mine"), ("mine", "25544")),
]
OTHER = [
    (("FENGYUN 1C DEB", "1999-025AAA"), ("FENGYUN 1C DEB", "1999-025BBB")),
    (("DEB", "1999-025A"), ("DEB", "25544")),
    (("DEB", "1999-025A", "30000"), ("DEB", "1999-025A", "30001")),
    (("a",), ("b",)),
    (("a", "mine"), ("a", "yours")),
]


@pytest.mark.parametrize(("one", "other"), SAME)
def test_one_object(one, other):
    assert ObjectId.of(*one).is_same(ObjectId.of(*other))
    assert ObjectId.of(*other).is_same(ObjectId.of(*one))


@pytest.mark.parametrize(("one", "other"), OTHER)
def test_two_objects(one, other):
    assert not ObjectId.of(*one).is_same(ObjectId.of(*other))
    assert not ObjectId.of(*other).is_same(ObjectId.of(*one))


def test_an_object_is_told_with_what_tells_it_from_others():
    texts = [
        str(ObjectId.of(*one)) for one in (("a",), ("a", "1999-025A"), ("77", "77"), ("a", "77", "99025A"))
    ]
    assert texts == ["a", "a (1999-025A)", "77", "a (77, 1999-025A)"]


def test_a_tle_tells_name_and_designator():
    lines = [
        (1, "0 ISS (ZARYA)"),
        (2, "1 25544U 98067A   08264.51782528 -.00002182  00000-0 -11606-4 0  2927"),
        (3, "2 25544  51.6416 247.4627 0006703 130.5360 325.0288 15.72125391563537"),
    ]
    found = tle.element_set("iss.tle", lines)
    assert (found.name, found.designator, found.number) == ("ISS (ZARYA)", "98067A", 25544)
    assert tle.element_set("iss.tle", lines[1:]).name == ""


@pytest.mark.parametrize(
    ("word", "identity"),
    [
        ("1998-067A", ObjectId("", "1998-067A")),
        ("98067a", ObjectId("", "1998-067A")),
        ("25544", ObjectId("", "", 25544)),
        ("ISS", ObjectId("ISS")),
    ],
)
def test_a_word_may_be_a_designator_a_number_or_a_name(word, identity):
    assert ObjectId.of_word(word) == identity


def test_the_first_table_that_tells_an_object_counts(tmp_path):
    told = {"simulated": {}, "bare": facts(UNKNOWN), "told": facts(ObjectId("ISS", "1998-067A"))}
    for name, metadata in told.items():
        write_table(tmp_path / name, SCHEMAS["labels"].empty(), "labels", metadata=metadata)
    paths = [tmp_path / name for name in told]
    assert of_tables(paths, name="iss") == ObjectId("iss", "1998-067A")
    assert of_tables(paths[:2], name="iss") == of_tables([], name="iss") == ObjectId("iss")


@pytest.mark.parametrize(
    ("number", "word"), [(5, "00005"), (5, "5"), (100_001, "A0001"), (100_001, "a0001"), (339_999, "Z9999")]
)
def test_a_number_is_called_as_files_write_it(number, word):
    assert ObjectId("X", number=number).is_called(word)
    assert not ObjectId("X", number=number + 1).is_called(word)
