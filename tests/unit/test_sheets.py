"""Stations and RSOs: sheets, canonical names, variations."""

import math
import re
from itertools import combinations
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from opml.errors import InputError
from opml.sheets import (
    parse_rso,
    parse_stations,
    read_rsos,
    read_stations,
    rso_pattern,
    stations_pattern,
)

CONFIG = Path(__file__).parents[2] / "config"
STATIONS, RSOS = read_stations(CONFIG / "stations.tsv"), read_rsos(CONFIG / "rsos.tsv")


def edited(tmp_path, sheet, old, new):
    text = (CONFIG / sheet).read_text()
    assert old in text
    path = tmp_path / sheet
    path.write_text(text.replace(old, new))
    return path


def test_papers_stations_in_si():
    clear = STATIONS["clear"]
    assert list(STATIONS) == ["eglin", "clear", "kaena"]
    assert (clear.altitude, clear.max_range, clear.sigma_range) == (213.3, 4910e3, 62.5)
    assert math.degrees(clear.longitude) == pytest.approx(-149.19, abs=1e-12)
    assert math.degrees(clear.sigma_azimuth) == pytest.approx(0.0791, abs=1e-12)
    assert (clear.min_elevation, clear.max_elevation) == (math.radians(1), math.radians(90))


def test_papers_rsos_in_si():
    assert list(RSOS) == ["iss", "swarma", "larets", "stella", "hy2a", "lares", "lageos1"]
    assert RSOS["iss"].a == pytest.approx(6783.34e3, abs=1e-6)
    assert RSOS["lageos1"].i == math.radians(109.84)
    assert all((rso.area_to_mass, rso.cd, rso.cr) == (0.05, 2.2, 1.25) for rso in RSOS.values())


@pytest.mark.parametrize(
    ("sheet", "old", "new", "message"),
    [
        (
            "stations.tsv",
            "4910\t1\t90",
            "4910\t90\t1",
            "clear: min_elevation_deg: expected less than max_elevation_deg",
        ),
        (
            "stations.tsv",
            "30.57",
            "95",
            r"eglin: latitude_deg: expected a number of at least -90 and at most 90, got '95'",
        ),
        ("stations.tsv", "32.1", "0", "eglin: sigma_range_m: expected a number above 0, got '0'"),
        ("stations.tsv", "32.1", "nan", "eglin: sigma_range_m: expected a number above 0, got 'nan'"),
        ("stations.tsv", "32.1", "", "eglin: sigma_range_m: expected a number above 0, got ''"),
        ("stations.tsv", "clear\t", "eglin\t", "name: expected .* no name twice, got 'eglin'"),
        ("stations.tsv", "clear\t", "Clear-AK\t", "name: expected lower-case letters and digits"),
        (
            "stations.tsv",
            "altitude_m",
            "height_m",
            "header: expected the columns .* look at altitude_m, height_m",
        ),
        ("stations.tsv", "\t0.0147", "", "eglin: expected 10 cells, got 9"),
        (
            "rsos.tsv",
            "345.5909\t0.05",
            "345.5909\t-0.05",
            "iss: area_to_mass_m2pkg: expected a number of at least 0",
        ),
        (
            "rsos.tsv",
            "0.006793",
            "1.2",
            "iss: e: expected a number of at least 0 and at most 0.99, got '1.2'",
        ),
        ("rsos.tsv", "6783.34", "6500", "iss: a_km: expected a perigee at least 120 km high"),
    ],
)
def test_wrong_cell_is_named(tmp_path, sheet, old, new, message):
    path = edited(tmp_path, sheet, old, new)
    with pytest.raises(InputError, match=re.escape(str(path)) + ": " + message):
        {"stations.tsv": read_stations, "rsos.tsv": read_rsos}[sheet](path)


@pytest.mark.parametrize("content", [b"", b"# only a remark\n", b"\xff\xfe\x00", b"name\n"])
def test_no_sheet_is_named(tmp_path, content):
    path = tmp_path / "rsos.tsv"
    path.write_bytes(content)
    with pytest.raises(InputError, match=r"rsos\.tsv: "):
        read_rsos(path)


def test_header_without_rows_is_named(tmp_path):
    path = tmp_path / "rsos.tsv"
    path.write_text((CONFIG / "rsos.tsv").read_text().split("iss\t")[0])
    with pytest.raises(InputError, match="at least one row"):
        read_rsos(path)


def test_every_subset_in_the_sheets_order_is_a_station_set():
    pattern = re.compile(stations_pattern(STATIONS))
    for size in range(1, 4):
        for names in combinations(STATIONS, size):
            text = "-".join(names)
            assert pattern.fullmatch(text)
            assert [station.name for station in parse_stations(text, STATIONS)] == list(names)


@pytest.mark.parametrize(
    "text", ["", "nowhere", "kaena-eglin", "eglin-eglin", "eglin-", "eglin_clear", "Eglin"]
)
def test_other_texts_are_no_station_set(text):
    assert not re.fullmatch(stations_pattern(STATIONS), text)
    with pytest.raises(InputError, match=f"stations '{text}': expected"):
        parse_stations(text, STATIONS)


def test_varied_rso():
    varied = parse_rso("iss_i50_a+50.5", RSOS)
    assert varied.name == "iss_i50_a+50.5"
    assert varied.i == math.radians(50)
    assert varied.a == pytest.approx(RSOS["iss"].a + 50.5e3, abs=1e-6)
    assert (varied.e, varied.raan) == (RSOS["iss"].e, RSOS["iss"].raan)


@pytest.mark.parametrize(
    "text",
    ["", "mir", "iss_", "iss_i", "iss_i050", "iss_i50.0", "iss_i50.10", "iss_i-5", "iss_a50", "iss_a+0",
     "iss_a-0", "iss_a+050", "iss_a+5_i50", "iss_i50_i51", "ISS", "iss_i5e1"],
)  # fmt: skip
def test_other_texts_are_no_rso(text):
    # One spelling an RSO: file names are compared as text.
    assert not re.fullmatch(rso_pattern(RSOS), text, re.ASCII)
    with pytest.raises(InputError, match="expected one of iss, swarma"):
        parse_rso(text, RSOS)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("iss_i181", "inclination: expected a number of at least 0 and at most 180"),
        ("iss_a-300", "at least 120 km high"),
    ],
)
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
