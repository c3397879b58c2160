"""Element sets written back: two numbers change, in every notation, and nothing else."""

import csv
import json
from datetime import datetime
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from sgp4.api import Satrec

from opml.base.errors import InputError
from opml.interop.element_sets import element_set, mean_elements, omm, rewriting, tle
from opml.interop.element_sets.element_set import PER_DAY, ElementSet, elements_epoch
from opml.interop.element_sets.rewriting import Better

NAME = "CALSPHERE 1"
FIRST = "1 00900U 64063C   26015.67312183  .00000482  00000+0  48308-3 0  9992"
SECOND = "2 00900  90.2182  68.2436 0026047  39.2139  83.7270 13.76418255 50440"
MOTION, BSTAR = 13.76418300 / PER_DAY, 5.1e-4
SUFFIXES = (".tle", ".txt", ".3le", ".json", ".csv", ".xml", ".kvn", ".omm")


@pytest.fixture
def source(tmp_path: Path) -> Path:
    path = tmp_path / "sets.tle"
    path.write_text(f"{NAME}\n{FIRST}\n{SECOND}\n")
    return path


def better(path: Path, **changes: float) -> Better:
    (one,) = mean_elements.read_sets(path)
    return better_than(one, **changes)


def better_than(one: ElementSet, **changes: float) -> Better:
    return Better(str(one.path), one.place, one.line, **({"motion": MOTION, "bstar": BSTAR} | changes))


def published(path):
    (one,) = mean_elements.read_sets(path)
    return one.satellite.no_kozai, one.satellite.bstar


def test_a_tle_keeps_all_but_two_fields_and_its_checksums(source: Path, tmp_path: Path) -> None:
    rewriting.write(tmp_path / "better.tle", [better(source)])

    name, first, second = (tmp_path / "better.tle").read_text().splitlines()
    assert name == NAME
    assert first[:53] + first[61:68] == FIRST[:53] + FIRST[61:68]
    assert second[:52] + second[63:68] == SECOND[:52] + SECOND[63:68]
    assert (first[53:61], second[52:63]) == (" 51000-3", "13.76418300")


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_every_notation_is_read_back_with_the_new_values(suffix: str, source: Path, tmp_path: Path) -> None:
    """What is written in one notation is written back from it in any other, too."""
    path = tmp_path / f"better{suffix}"

    assert rewriting.write(path, [better(source)]) == 0

    (one,) = mean_elements.read_sets(path)
    (old,) = mean_elements.read_sets(source)
    assert one.number == 900
    np.testing.assert_allclose([one.satellite.no_kozai, one.satellite.bstar], [MOTION, BSTAR], rtol=1e-9)
    for name in ("ecco", "inclo", "nodeo", "argpo", "mo"):
        assert getattr(one.satellite, name) == pytest.approx(getattr(old.satellite, name), abs=1e-9)
    days = [each.satellite.jdsatepoch + each.satellite.jdsatepochF for each in (one, old)]
    assert days[0] == days[1]

    for other in SUFFIXES:
        again = tmp_path / f"again{other}"
        rewriting.write(again, [better(path, bstar=-BSTAR)])
        assert mean_elements.read_sets(again)[0].satellite.bstar == pytest.approx(-BSTAR)
        assert NAME in again.read_text()


def test_a_tle_without_an_international_designator_becomes_an_omm(source: Path, tmp_path: Path) -> None:
    blank = FIRST.replace("64063C", "      ")
    first = f"{blank[:68]}{sum(int(c) if c.isdigit() else c == '-' for c in blank[:68]) % 10}"
    source.write_text(f"{first}\n{SECOND}\n")

    rewriting.write(tmp_path / "better.json", [better(source)])

    (one,) = json.loads((tmp_path / "better.json").read_text())
    assert (one["OBJECT_NAME"], one["OBJECT_ID"]) == ("UNKNOWN", "UNKNOWN")


SPACE_TRACK = {
    "COMMENT": "GENERATED VIA SPACE-TRACK.ORG API",
    "ORIGINATOR": "18 SPCS",
    "CREATION_DATE": "2026-01-16T08:00:00",
    "SEMIMAJOR_AXIS": "7353.1",
    "PERIOD": "104.6",
    "APOAPSIS": "994.1",
    "PERIAPSIS": "955.8",
    "TLE_LINE0": f"0 {NAME}",
    "TLE_LINE1": FIRST,
    "TLE_LINE2": SECOND,
}


@pytest.mark.parametrize("suffix", [".json", ".csv"])
def test_nothing_of_an_improved_set_is_of_the_published_one(suffix, source, tmp_path):
    rewriting.write(tmp_path / "plain.json", [better(source, motion=published(source)[0], bstar=BSTAR)])
    (plain,) = json.loads((tmp_path / "plain.json").read_text())
    given = tmp_path / "given.json"
    given.write_text(json.dumps([plain | SPACE_TRACK]))

    rewriting.write(tmp_path / f"better{suffix}", [better(given, bstar=6e-4)])

    text = (tmp_path / f"better{suffix}").read_text()
    one = json.loads(text)[0] if suffix == ".json" else next(csv.DictReader(text.splitlines()))
    lines = one["TLE_LINE1"], one["TLE_LINE2"]
    by_lines, by_keys = Satrec.twoline2rv(*lines), omm.satellite({key: str(one[key]) for key in one})
    assert by_lines.bstar == pytest.approx(by_keys.bstar) == pytest.approx(6e-4)
    assert by_lines.no_kozai == pytest.approx(by_keys.no_kozai, rel=1e-9)
    assert not {"SEMIMAJOR_AXIS", "PERIOD", "APOAPSIS", "PERIAPSIS"} & one.keys()
    assert one["ORIGINATOR"].startswith("OPML ")
    assert "improved by OPML" in one["COMMENT"]
    assert one["CREATION_DATE"] == "2026-01-16T08:00:00.000000"


def test_a_set_that_nothing_improves_stays_as_it_is(source, tmp_path):
    motion, bstar = published(source)
    rewriting.write(tmp_path / "same.tle", [better(source, motion=motion, bstar=bstar)])
    assert (tmp_path / "same.tle").read_text() == source.read_text()
    rewriting.write(tmp_path / "same.json", [better(source, motion=motion, bstar=bstar)])
    assert "OPML" not in (tmp_path / "same.json").read_text()


@pytest.mark.parametrize("suffix", [".kvn", ".xml"])
def test_a_message_has_the_header_that_the_standard_asks_for(suffix, source, tmp_path):
    rewriting.write(tmp_path / f"better{suffix}", [better(source)])
    text = (tmp_path / f"better{suffix}").read_text()
    order = [
        "improved by OPML",
        "2026-01-15T16:09:17.726",
        "= OPML 1" if suffix == ".kvn" else ">OPML 1",
        "CALSPHERE 1",
    ]
    assert sorted(order, key=text.index) == order
    assert text.count("CREATION_DATE") == (1 if suffix == ".kvn" else 2)


@pytest.mark.parametrize("suffix", [".json", ".xml"])
def test_sets_in_one_line_are_told_apart(suffix: str, source: Path, tmp_path: Path) -> None:
    """As lists of public sets have them: each keeps its object and its epoch."""
    path = tmp_path / f"list{suffix}"
    rewriting.write(path, [better(source)])
    one = path.read_text()
    begin, end = (one.index("<omm"), one.index("</ndm>")) if suffix == ".xml" else (1, one.rindex("]"))
    other = one[begin:end].replace("900", "901").replace(NAME, "OTHER")
    path.write_text("".join([one[:end], "" if suffix == ".xml" else ",", other, one[end:]]).replace("\n", ""))
    first, second = mean_elements.read_sets(path)

    rewriting.write(tmp_path / "better.tle", [better_than(first, bstar=-BSTAR), better_than(second)])

    found = mean_elements.read_sets(tmp_path / "better.tle")
    assert [(each.number, each.name) for each in found] == [(900, NAME), (901, "OTHER")]
    np.testing.assert_allclose([each.satellite.bstar for each in found], [-BSTAR, BSTAR], rtol=1e-4)


def test_a_name_like_a_notation_and_a_line_alone_are_no_obstacle(source: Path, tmp_path: Path) -> None:
    source.write_text(f"[DEB]\n{FIRST}\n{SECOND}\n{FIRST}\n")
    one, *_ = mean_elements.read_sets(source, damaged=[])

    rewriting.write(tmp_path / "better.tle", [better_than(one)])

    assert (tmp_path / "better.tle").read_text().startswith("[DEB]\n1 00900U")


def test_a_number_beyond_those_of_tles_is_counted_and_kept_in_other_notations(tmp_path: Path) -> None:
    path = tmp_path / "sets.csv"
    path.write_text(
        "OBJECT_NAME,EPOCH,MEAN_MOTION,ECCENTRICITY,INCLINATION,RA_OF_ASC_NODE,ARG_OF_PERICENTER,"
        "MEAN_ANOMALY,NORAD_CAT_ID,BSTAR\n"
        "NEW,2026-07-15T06:00:00,15.1,.001,53,10,20,30,800123,.0003\n"
    )

    assert rewriting.write(tmp_path / "better.tle", [better(path)]) == 1
    assert rewriting.write(tmp_path / "better.csv", [better(path)]) == 0
    assert mean_elements.read_sets(tmp_path / "better.csv")[0].number == 800123


@pytest.mark.parametrize(
    ("key", "value", "name", "launch", "node"),
    [
        ("RA_OF_ASC_NODE", -80.0, "SAT", "98067A", 280.0),
        ("OBJECT_ID", "UNKNOWN", "SAT", "", 10.0),
        ("OBJECT_ID", "1998-067ABCDE", "SAT", "", 10.0),
        ("OBJECT_ID", "1998-067a", "SAT", "98067A", 10.0),
        ("OBJECT_NAME", "A\nB", "A B", "98067A", 10.0),
        ("OBJECT_NAME", "1 25544U", "1 25544U", "98067A", 10.0),
        ("OBJECT_NAME", "# 1", "# 1", "98067A", 10.0),
        ("OBJECT_NAME", 80 * "N", 66 * "N", "98067A", 10.0),
        ("CLASSIFICATION_TYPE", "UNCLASSIFIED", "SAT", "98067A", 10.0),
    ],
    ids=str,
)
def test_whatever_a_message_says_its_tle_is_read(key, value, name, launch, node, tmp_path):
    path = tmp_path / "sets.json"
    angles = dict(zip(("INCLINATION", "RA_OF_ASC_NODE", "ARG_OF_PERICENTER"), (53, 10, 20), strict=True))
    said = {"OBJECT_NAME": "SAT", "OBJECT_ID": "1998-067A", "EPOCH": "2026-07-15T06:00:00", **angles}
    orbit = {"MEAN_MOTION": 15.1, "ECCENTRICITY": 1e-3, "MEAN_ANOMALY": 30, "BSTAR": 3e-4}
    path.write_text(json.dumps(said | orbit | {"NORAD_CAT_ID": 5, key: value}))
    assert rewriting.write(tmp_path / "better.tle", [better(path)]) == 0
    (one,) = mean_elements.read_sets(tmp_path / "better.tle")
    assert (one.name, one.designator) == (name, launch)
    assert np.degrees(one.satellite.nodeo) == pytest.approx(node)


def test_another_suffix_and_a_changed_file_are_refused(source: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"better\.oem: expected a suffix \.tle, .*, got \.oem"):
        rewriting.write(tmp_path / "better.oem", [better(source)])
    one = better(source)
    source.write_text(f"{FIRST}\n{SECOND}\n")
    with pytest.raises(InputError, match=r"sets\.tle: line 2: expected the set that was read there"):
        rewriting.write(tmp_path / "better.tle", [one])
    assert not (tmp_path / "better.tle").exists()


@settings(max_examples=60, deadline=None)
@given(
    number=st.integers(1, tle.LARGEST_NUMBER) | st.sampled_from([180_000, 235_000, 239_999]),
    epoch=st.datetimes(datetime(1957, 1, 1), datetime(2056, 12, 31, 23, 59, 59, 999_999))
    | st.sampled_from([datetime(2025, 12, 31, 23, 59, 59, 999_800), datetime(2024, 12, 31, 23, 59, 59)]),
    eccentricity=st.floats(0.0, 0.9),
    bstar=st.floats(-1.0, 1.0) | st.sampled_from([1e-12, -1e-9, 0.0]),
)
def test_what_a_tle_can_hold_is_read_as_it_was_written(number, epoch, eccentricity, bstar, tmp_path_factory):
    elements = [2.0 / PER_DAY, eccentricity, 1.0, 2.0, 3.0, 4.0, bstar]
    satellite = element_set.satellite(epoch.isoformat(timespec="microseconds"), elements)
    path = tmp_path_factory.mktemp("tle") / "one.tle"
    for lines in (tle.lines(satellite, number), tle.exported(satellite, number)):
        path.write_text("\n".join(lines))
        (one,) = mean_elements.read_sets(path)
        assert one.number == number
        assert one.satellite.bstar == pytest.approx(bstar, rel=1e-4, abs=1e-9)
        apart = datetime.fromisoformat(elements_epoch(one.satellite)) - epoch
        assert abs(apart.total_seconds()) < 4e-3  # before 1972 UTC had another rate


@pytest.mark.parametrize(
    ("epoch", "changes", "said"),
    [
        ("2060-01-01T00:00:00", {}, "epoch: expected one of a TLE, from 1957 to 2056"),
        ("2056-12-31T23:59:59.999999", {}, "epoch: expected one of a TLE, from 1957 to 2056"),
        ("2026-01-01T00:00:00", {1: 0.99999999}, "expected numbers that its columns hold"),
        ("2026-01-01T00:00:00", {6: 1e12}, "expected numbers that its columns hold"),
    ],
    ids=["1960 again", "the last moment", "eccentricity", "B*"],
)
def test_what_a_tle_cannot_hold_is_refused(epoch, changes, said):
    elements = [2.0 / PER_DAY, 0.1, 1.0, 2.0, 3.0, 4.0, 1e-4]
    for k, value in changes.items():
        elements[k] = value
    satellite = element_set.satellite(epoch, elements)
    for write in (tle.lines, tle.exported):
        with pytest.raises(InputError, match=said):
            write(satellite, 25544)
