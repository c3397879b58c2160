"""Stations and RSOs: their sheets."""

import math
import re

import pytest
from support import REPOSITORY, refusal, refusals

from opml.base.errors import InputError
from opml.orbits.sheets import read_rsos, read_stations, stations_from_rows

CONFIG = REPOSITORY / "config"
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


@pytest.mark.parametrize(("sheet", "old", "new", "message"), refusals("sheets"))
def test_wrong_cell_is_named(tmp_path, sheet, old, new, message):
    path = edited(tmp_path, sheet, old, new)
    with pytest.raises(InputError, match=re.escape(str(path)) + ": " + message):
        {"stations.tsv": read_stations, "rsos.tsv": read_rsos}[sheet](path)


def test_stations_measure_what_they_have_a_sigma_of(tmp_path):
    sheet, rows = (CONFIG / "stations.tsv").read_text().splitlines(), []
    for line, further in zip(
        sheet[1:],
        [("sigma_declination_deg", "max_sun_elevation_deg"), ("-", "-"), ("0.001", "-12"), ("-", "-")],
        strict=True,
    ):
        rows.append("\t".join([*line.split("\t"), *further]))
    (tmp_path / "stations.tsv").write_text("\n".join(rows).replace("62.5", "-"))
    eglin, clear, kaena = read_stations(tmp_path / "stations.tsv").values()
    assert (eglin, kaena) == (STATIONS["eglin"], STATIONS["kaena"])
    assert "sigma_declination" not in eglin.row
    assert clear.sigma_range is None
    assert clear.max_sun_elevation == math.radians(-12)
    assert clear.row["sigma_declination"] == math.radians(0.001)
    assert [station.is_radar for station in (eglin, clear, kaena)] == [True, False, True]


def test_a_station_of_the_settings_may_be_a_telescope():
    row = {"latitude_deg": 20, "longitude_deg": 0, "altitude_m": 0, "max_range_km": 50000}
    row |= {"min_elevation_deg": 10, "max_elevation_deg": 90}
    stars = {"sigma_right_ascension_deg": 1e-4, "sigma_declination_deg": 1e-4}
    one = stations_from_rows({"tenerife": row | stars})["tenerife"]
    assert list(one.row)[-2:] == ["sigma_right_ascension", "sigma_declination"]
    assert "expected one of sigma_range_m" in refusal(stations_from_rows, {"tenerife": row})
    assert "look at sigma_x" in refusal(stations_from_rows, {"tenerife": row | stars | {"sigma_x": 1}})


def test_a_cell_of_many_letters_is_named(tmp_path):
    path = edited(tmp_path, "rsos.tsv", "6783.34", "6" * 200_000)
    with pytest.raises(InputError, match=r"rsos\.tsv: line \d+: expected cells between tabs"):
        read_rsos(path)


def test_a_byte_order_mark_is_no_text(tmp_path):
    path = edited(tmp_path, "rsos.tsv", "6783.34", "6783.34")
    path.write_text("\ufeff" + path.read_text(encoding="utf-8"), encoding="utf-8")
    assert read_rsos(path) == RSOS


def test_cells_in_quotes_are_read(tmp_path):
    assert read_rsos(edited(tmp_path, "rsos.tsv", "6783.34", '"6783.34"')) == RSOS


@pytest.mark.parametrize(
    "content",
    [b"", b"# only a remark\n", b"\xff\xfe\x00", b"name\n"],
    ids=["empty", "remark", "no text", "heading"],
)
def test_no_sheet_is_named(tmp_path, content):
    path = tmp_path / "rsos.tsv"
    path.write_bytes(content)
    assert "rsos.tsv: " in refusal(read_rsos, path)


def test_header_without_rows_is_named(tmp_path):
    path = tmp_path / "rsos.tsv"
    path.write_text((CONFIG / "rsos.tsv").read_text().split("iss\t")[0])
    assert "at least one row" in refusal(read_rsos, path)
