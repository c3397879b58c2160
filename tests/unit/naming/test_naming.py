"""The grammar of names: stations, varied RSOs, splits, seeds, readings, kernel scales; one spelling each."""

import math
import re
from itertools import combinations

import pytest
from hypothesis import given, strategies as st
from support import refusal, refusals, rsos, stations

from opml import naming
from opml.base.errors import InputError
from opml.naming import Split, rso_pattern, stations_pattern
from opml.orbits.sheets import name_at_inclination, name_at_offset, parse_rso, parse_stations

STATIONS, RSOS = stations(), rsos()


LEARNERS = {"svr": {"kernel_scale": "sigest"}, "svrfixed": {"kernel_scale": 2.0}}


@given(st.sampled_from(["eglin", "eglin-kaena"]), st.integers(0, 10**6), st.integers(0, 10**6))
def test_seed_in_a_name_and_back(text, seed, default):
    name = naming.add_seed(text, naming.NOISE, seed, default=default)
    assert naming.parse_seed(name, naming.NOISE, default=default) == (text, seed)
    assert re.fullmatch(text + naming.seed_pattern(naming.NOISE, default=default), name)


@pytest.mark.parametrize("suffix", ["_noise42", "_noise043", "_noise", "_noise-1", "_split43", "_noise43.0"])
def test_other_suffixes_are_no_seed(suffix):
    assert not re.fullmatch(naming.seed_pattern(naming.NOISE, default=42), suffix)


@pytest.mark.parametrize("seed", [0, 4, 420, 421, 142])
def test_seeds_that_only_resemble_the_own_one(seed):
    assert re.fullmatch(naming.seed_pattern(naming.NOISE, default=42), f"_noise{seed}")


def test_reading_is_named_where_it_is_not_the_settings():
    assert naming.other_reading("kept_estimate") == "_track"
    assert naming.other_reading("track") == "_kept"
    assert naming.parse_reading("_track", previous="kept_estimate") == "track"
    assert naming.parse_reading("_kept", previous="track") == "kept_estimate"
    assert naming.parse_reading("", previous="track") == "track"


def test_window_in_a_name_and_back():
    assert naming.window_suffix(12, default=12) == ""
    assert naming.window_suffix(24, default=12) == "_w24"
    assert naming.parse_window("_w24", default=12) == 24
    assert naming.parse_window("", default=12) == 12
    pattern = naming.window_pattern(default=12)
    assert [one for one in ("", "_w24", "_w12.5", "_w120", "_w1") if not re.fullmatch(pattern, one)] == []
    assert [one for one in ("_w12", "_w0", "_w024", "_w", "_w24.0") if re.fullmatch(pattern, one)] == []


def test_other_texts_are_no_learner():
    assert naming.parse_learner("svr", LEARNERS) == LEARNERS["svr"]
    with pytest.raises(InputError, match="learner 'forest': expected one of svr, svrfixed"):
        naming.parse_learner("forest", LEARNERS)


@given(st.one_of(st.integers(1, 10**6), st.decimals("0.001", 10**4, places=3)))
def test_number_has_one_spelling(value):
    text = naming.number(float(value))
    assert float(text) == float(value)
    assert re.fullmatch(naming.POSITIVE, text)


@pytest.mark.parametrize(
    ("vary", "rso", "by", "expected"),
    [
        (name_at_inclination, "iss", 50, "iss_i50"),
        (name_at_inclination, "iss", 50.5, "iss_i50.5"),
        (name_at_inclination, "iss", 51.6393, "iss"),
        (name_at_inclination, "iss_i50", 52, "iss_i52"),
        (name_at_inclination, "iss_a+50", 50, "iss_i50_a+50"),
        (name_at_inclination, "iss_i50_a+50", 51.6393, "iss_a+50"),
        (name_at_offset, "iss", 0, "iss"),
        (name_at_offset, "iss", 50, "iss_a+50"),
        (name_at_offset, "iss", -7.5, "iss_a-7.5"),
        (name_at_offset, "iss_i50", 10, "iss_i50_a+10"),
        (name_at_offset, "iss_a+10", 0, "iss"),
    ],
)
def test_an_rso_is_named_by_its_inclination_and_offset(vary, rso, by, expected):
    assert vary(rso, by, RSOS) == expected
    assert parse_rso(expected, RSOS).name == expected


def test_every_subset_in_the_sheets_order_is_a_station_set():
    pattern = re.compile(stations_pattern(STATIONS))
    for size in range(1, 4):
        for names in combinations(STATIONS, size):
            text = "-".join(names)
            assert pattern.fullmatch(text)
            assert [station.name for station in parse_stations(text, STATIONS)] == list(names)


@pytest.mark.parametrize("text", ["", "nowhere", "eglin-", "eglin_clear", "Eglin"])
def test_other_texts_are_no_part_of_a_file_name(text):
    assert not re.fullmatch(stations_pattern(STATIONS), text)


@pytest.mark.parametrize(
    "text", ["", "nowhere", "kaena-eglin", "eglin-eglin", "eglin-", "eglin_clear", "Eglin"]
)
def test_other_texts_are_no_station_set(text):
    with pytest.raises(InputError, match=f"stations '{text}': expected"):
        parse_stations(text, STATIONS)


@pytest.mark.parametrize(
    ("text", "spelling"), [("kaena-eglin", "eglin-kaena"), ("clear-eglin-clear", "eglin-clear")]
)
def test_a_station_set_in_another_order_is_told_its_spelling(text, spelling):
    assert refusal(parse_stations, text, STATIONS) == (
        f"stations '{text}': expected '{spelling}', each name once in the sheet's order"
    )


@pytest.mark.parametrize("text", refusals("rsos"))  # fmt: skip
def test_other_texts_are_no_rso(text):
    # One spelling an RSO: file names are compared as text.
    assert not re.fullmatch(rso_pattern(RSOS), text, re.ASCII)
    assert "expected one of iss, swarma" in refusal(parse_rso, text, RSOS)


@pytest.mark.parametrize(("text", "message"), refusals("varied_rsos"))
def test_impossible_variation_is_explained(text, message):
    with pytest.raises(InputError, match=f"RSO '{text}': .*{message}"):
        parse_rso(text, RSOS)


@given(
    base=st.sampled_from(list(RSOS)),
    inclination=st.none() | st.decimals(0, 180, places=4),
    offset=st.none() | st.decimals("0.001", 2000, places=3),
)
def test_what_the_pattern_accepts_can_be_parsed(base, inclination, offset):
    def text(number):
        return f"{number:f}".rstrip("0").rstrip(".") if "." in f"{number:f}" else f"{number:f}"

    name = base
    name += "" if inclination is None else f"_i{text(inclination)}"
    name += "" if offset is None else f"_a+{text(offset)}"
    assert re.fullmatch(rso_pattern(RSOS), name)
    varied = parse_rso(name, RSOS)
    assert varied.i == (RSOS[base].i if inclination is None else math.radians(float(inclination)))
    assert varied.a - RSOS[base].a == pytest.approx(0 if offset is None else 1e3 * float(offset), abs=1e-6)


TRAIN, TEST = (naming.parse_train, naming.TRAIN), (naming.parse_test, naming.TEST)


@pytest.mark.parametrize(
    ("grammar", "text", "split"),
    [
        (TRAIN, "random-80", Split("random", percent=80)),
        (TRAIN, "grouped-12.5", Split("grouped", percent=12.5)),
        (TRAIN, "days-0-30", Split("days", days=(0, 30))),
        (TEST, "rest", Split("rest")),
        (TEST, "seen", Split("seen")),
        (TEST, "days-30-40.5", Split("days", days=(30, 40.5))),
        (TEST, "days-30-40-unseen", Split("days", days=(30, 40), starts_inside=True)),
        (TEST, "days-30-40-unfenced", Split("days", days=(30, 40), fence=math.inf)),
        (TEST, "days-3-4-unseen-fence1.5", Split("days", 100, (3, 4), True, fence=1.5)),
    ],
)
def test_a_split_and_back(grammar, text, split):
    parse, pattern = grammar
    assert parse(text) == split
    assert str(split) == text
    assert re.fullmatch(pattern, text)


@pytest.mark.parametrize(
    "text", ["random", "random-", "random-080", "rest", "days-1", "days-30-40-unseen", ""]
)
def test_other_texts_are_no_training_split(text):
    assert not re.fullmatch(naming.TRAIN, text)
    with pytest.raises(InputError, match=f"training split '{text}': expected random-<percent>"):
        naming.parse_train(text)


@pytest.mark.parametrize("text", refusals("test_splits"))
def test_other_texts_are_no_test_split(text):
    assert not re.fullmatch(naming.TEST, text)
    with pytest.raises(InputError, match=f"test split '{text}': expected seen, rest"):
        naming.parse_test(text)


@pytest.mark.parametrize("text", ["random-0", "grouped-100.5"])
def test_a_share_that_cannot_be(text):
    assert "expected a percentage above 0 and up to 100" in refusal(naming.parse_train, text)


def test_windows_of_names():
    assert naming.days_split([0, 8.5]) == "days-0-8.5"
    assert naming.unseen_test("days-30-40") == "days-30-40-unseen"
    assert naming.unseen_test("rest") == "rest"
    assert "expected the first day before the last, got 9 and 9" in refusal(naming.parse_test, "days-9-9")
    with pytest.raises(InputError, match="up to duration_days, 12, got 8 and 13"):
        naming.check_split(naming.parse_test("days-8-13"), duration_days=12)


def test_a_window_of_days_may_have_another_fence():
    assert naming.with_fence("days-30-40", math.inf) == "days-30-40-unfenced"
    assert naming.with_fence("days-30-40-unfenced", None) == "days-30-40-unfenced"
    assert naming.with_fence("rest", 3.0) == "rest"  # its training rows have the dataset's fences


def test_an_experiment_knows_its_files():
    one = naming.Experiment("iss", "eglin", "random-80", "svr", "e_y", "lares", "rest", "_track", "_w24")
    assert one.path("metrics") == "metrics/iss/eglin_w24_track/random-80/svr/e_y/lares/rest.parquet"
    assert one.columns()["stations"] == "eglin_w24_track"


def test_nothing_is_any_of_no_names():
    assert not re.fullmatch(naming.alternatives([]), "")
    assert re.fullmatch(naming.alternatives(["a.b", "c"]), "a.b")
    assert not re.fullmatch(naming.alternatives(["a.b", "c"]), "axb")
