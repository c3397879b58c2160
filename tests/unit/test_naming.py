"""Suffixes in names: seeds, readings, kernel scales, varied RSOs; one spelling each."""

import re
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from opml import naming
from opml.errors import InputError
from opml.sheets import parse_rso, read_rsos

RSOS = read_rsos(Path(__file__).parents[2] / "config" / "rsos.tsv")
LEARNERS = {"svr": {"kernel_scale": "sigest", "c": 1.0}, "svrfixed": {"kernel_scale": 2.0, "c": 1.0}}


@given(st.sampled_from(["eglin", "eglin-kaena"]), st.integers(0, 10**6), st.integers(0, 10**6))
def test_seed_in_a_name_and_back(text, seed, default):
    name = naming.seeded(text, naming.NOISE, seed, default=default)
    assert naming.parse_seed(name, naming.NOISE, default=default) == (text, seed)
    assert re.fullmatch(text + naming.seed_pattern(naming.NOISE, default=default), name)


def test_own_seed_has_no_suffix():
    assert naming.seeded("random-80", naming.SPLIT, 42, default=42) == "random-80"
    assert naming.seeded("random-80", naming.SPLIT, 43, default=42) == "random-80_split43"


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
    assert naming.windowed(12, default=12) == ""
    assert naming.windowed(24, default=12) == "_w24"
    assert naming.parse_window("_w24", default=12) == 24
    assert naming.parse_window("", default=12) == 12
    pattern = naming.window_pattern(default=12)
    assert [one for one in ("", "_w24", "_w12.5", "_w120", "_w1") if not re.fullmatch(pattern, one)] == []
    assert [one for one in ("_w12", "_w0", "_w024", "_w", "_w24.0") if re.fullmatch(pattern, one)] == []


def test_pool_without_one_of_its_rsos():
    pools = {"near": ["iss", "iss_i50", "iss_a+50"]}
    assert naming.parse_pool("near-without-iss_i50", pools) == ["iss", "iss_a+50"]
    assert re.fullmatch(naming.pool_pattern(pools, RSOS), "near-without-iss_a+50")
    assert not re.fullmatch(naming.pool_pattern(pools, RSOS), "far-without-iss")
    with pytest.raises(InputError, match="pool 'far': expected one of near"):
        naming.parse_pool("far-without-iss", pools)


def test_only_a_learner_with_a_kernel_scale_has_another():
    learners = LEARNERS | {"none": {"kind": "none"}}
    assert re.fullmatch(naming.learner_pattern(learners), "svr_s2")
    assert re.fullmatch(naming.learner_pattern(learners), "none")
    assert not re.fullmatch(naming.learner_pattern(learners), "none_s2")


def test_kernel_scale_of_a_learner():
    assert naming.parse_learner("svr", LEARNERS) == LEARNERS["svr"]
    assert naming.parse_learner("svr_s2.5", LEARNERS) == {"kernel_scale": 2.5, "c": 1.0}
    assert naming.parse_learner("svrfixed_s0.1", LEARNERS)["kernel_scale"] == 0.1
    assert LEARNERS["svr"]["kernel_scale"] == "sigest"


@pytest.mark.parametrize("text", ["forest", "svr_s", "svr_s0", "svr_s2.0", "svr_s02", "svr_2", "svr_s-1", ""])
def test_other_texts_are_no_learner(text):
    assert not re.fullmatch(naming.learner_pattern(LEARNERS), text)
    with pytest.raises(InputError, match=f"learner '{text}': expected one of svr, svrfixed;"):
        naming.parse_learner(text, LEARNERS)


@given(st.one_of(st.integers(1, 10**6), st.decimals("0.001", 10**4, places=3)))
def test_number_has_one_spelling(value):
    text = naming.number(float(value))
    assert float(text) == float(value)
    assert re.fullmatch(naming.POSITIVE, text)


@pytest.mark.parametrize(
    ("rso", "degrees", "expected"),
    [
        ("iss", 50, "iss_i50"),
        ("iss", 50.5, "iss_i50.5"),
        ("iss", 51.6393, "iss"),
        ("iss_i50", 52, "iss_i52"),
        ("iss_a+50", 50, "iss_i50_a+50"),
        ("iss_i50_a+50", 51.6393, "iss_a+50"),
    ],
)
def test_inclination_of_an_rso(rso, degrees, expected):
    assert naming.with_inclination(rso, degrees, RSOS) == expected
    assert parse_rso(expected, RSOS).name == expected


@pytest.mark.parametrize(
    ("rso", "km", "expected"),
    [
        ("iss", 0, "iss"),
        ("iss", 50, "iss_a+50"),
        ("iss", -7.5, "iss_a-7.5"),
        ("iss_i50", 10, "iss_i50_a+10"),
        ("iss_a+10", 0, "iss"),
    ],
)
def test_offset_of_an_rso(rso, km, expected):
    assert naming.with_offset(rso, km, RSOS) == expected
    assert parse_rso(expected, RSOS).name == expected
