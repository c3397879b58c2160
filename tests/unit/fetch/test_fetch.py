"""Public data fetched with manners: asked for once, errors shown and never kept, a history that grows."""

import re
from datetime import UTC, datetime, timedelta
from types import SimpleNamespace

import astropy_iers_data
import numpy as np
import pytest
import sinking_histories
from data_server import MODIFIED, as_csv, serving

import opml
from opml import cli
from opml.environment import earth_orientation, known_weather, solar_activity
from opml.fetch import downloads, public_data
from opml.fetch.downloads import NoAnswerError
from opml.fetch.public_data import Query

QUERY = Query.of("101")
LINES = sinking_histories.sets_of(101, 45)
GP = "/NORAD/elements/gp.php?CATNR=101&FORMAT=CSV"
SHORT, LONG = "/SpaceData/SW-Last5Years.csv", "/SpaceData/SW-All.csv"


@pytest.fixture
def clock(monkeypatch):
    """The time that downloads go by."""
    time = [datetime.now(UTC)]
    for module in (downloads, public_data):
        monkeypatch.setattr(module, "now", lambda: time[0])
    return SimpleNamespace(pass_by=lambda hours: time.append(time.pop() + timedelta(hours=hours)))


def weather_of(first, last):
    """The packaged weather of some days as CelesTrak's CSV."""
    text = solar_activity.read_text(solar_activity.resolve("OBSERVED"))
    header, *rows = [line for line in text.splitlines() if not line.startswith("#")]
    return "\n".join([header, *(row for row in rows if first <= row[:10] <= last)]) + "\n"


@pytest.fixture
def server(monkeypatch, tmp_path, clock):
    with serving(monkeypatch, tmp_path / "data") as server:
        server.sets("CATNR=101", as_csv(LINES[:2]))
        server.answers[SHORT] = (200, weather_of("2021-01-01", "2026-01-10").encode())
        with open(astropy_iers_data.IERS_A_FILE, "rb") as file:
            server.answers["/finals2000A.all"] = (200, file.read())
        yield server


def renew(*queries):
    """What is told of a renewal."""
    told = []
    public_data.renew(queries or [QUERY], say=told.append)
    return told


def test_a_file_is_asked_for_once_in_its_hours(server, clock):
    assert len(renew()) == 3
    assert server.asked() == [GP, SHORT, "/finals2000A.all"]
    clock.pass_by(1.9)
    renew()
    assert len(server.requests) == 3
    clock.pass_by(0.2)
    assert "1 set, 0 new" in renew()[0]
    path, headers = server.requests[-1]
    assert (path, headers["If-Modified-Since"]) == (GP, MODIFIED)
    assert headers["User-Agent"].startswith("opml-orbits/")
    clock.pass_by(4.0)
    renew()
    assert server.asked()[4:] == [GP, SHORT]


def test_the_history_grows_by_what_is_new(server, clock):
    renew()
    server.sets("CATNR=101", as_csv(LINES[:4]))
    clock.pass_by(3.0)
    server.answers[GP] = (200, as_csv(LINES[:4]).encode())
    downloads_of = public_data.data_folder() / "downloads" / "asked.json"
    downloads_of.write_text(downloads_of.read_text().replace(MODIFIED, "another day"))
    assert "2 sets, 1 new" in renew()[0]
    files = sorted(QUERY.folder.iterdir())
    assert [len(file.read_text().splitlines()) for file in files] == [2, 2]
    assert public_data.queries() == [QUERY]


ERRORS = {
    "nothing": (200, b"", "nothing"),
    "page": (200, b"<!DOCTYPE html><html>busy</html>", "a web page"),
    "no object": (200, b"No GP data found", "no such object"),
    "another text": (200, b"hello", "got 'hello'"),
    "not updated": (403, b"GP data has not updated since your last successful download", "403: GP data has"),
    "moved": (301, b"moved", "got 301: moved"),
    "broken": (500, b"try later", "got 500: try later"),
}


@pytest.mark.parametrize("error", ERRORS)
def test_an_error_is_shown_and_never_kept(server, clock, error):
    renew()
    kept = {path: path.read_bytes() for path in public_data.sets_folder().rglob("*.csv")}
    status, body, words = ERRORS[error]
    server.answers[GP] = (status, body)
    asked = public_data.data_folder() / "downloads" / "asked.json"
    asked.write_text(asked.read_text().replace(MODIFIED, "another day"))
    clock.pass_by(7.0)
    with pytest.raises(NoAnswerError, match=re.escape(words)):
        renew()
    assert server.asked()[3:] == [GP]  # nothing after it
    with pytest.raises(NoAnswerError, match=re.escape(words)):
        renew()
    assert server.asked()[3:] == [GP]  # one try
    assert {path: path.read_bytes() for path in public_data.sets_folder().rglob("*.csv")} == kept
    assert public_data._downloads().path("number-101.csv").read_text() == as_csv(LINES[:2])


def test_recent_weather_is_joined_to_what_is_there(server):
    renew()
    assert LONG not in server.asked()
    packaged, fetched = known_weather.read("OBSERVED"), known_weather.read("NEWEST")
    assert fetched.first == packaged.first
    np.testing.assert_array_equal(fetched.flux, packaged.flux[: len(fetched.flux)])
    assert len(packaged.flux) - len(fetched.flux) == 4


def test_all_weather_is_asked_for_where_days_are_missing(server, clock, monkeypatch):
    known = weather_of("2019-01-01", "2020-01-01")
    solar_activity.fetched_weather().parent.mkdir(parents=True)
    solar_activity.fetched_weather().write_text(known)
    server.answers[LONG] = (200, weather_of("2010-01-01", "2026-01-09").encode())
    renew()
    assert server.asked() == [GP, SHORT, LONG, "/finals2000A.all"]
    clock.pass_by(7.0)
    renew()
    assert server.asked().count(LONG) == 1


def test_the_later_bulletin_is_used(server):
    earth_orientation.newest_bulletin.cache_clear()
    assert earth_orientation.newest_bulletin().as_posix() == astropy_iers_data.IERS_A_FILE
    later = "271301 61830.00"
    text = server.answers["/finals2000A.all"][1].decode() + f"{later}\n"
    server.answers["/finals2000A.all"] = (200, text.encode())
    renew()
    earth_orientation.newest_bulletin.cache_clear()
    try:
        assert earth_orientation.newest_bulletin() == earth_orientation.fetched_bulletin()
        assert earth_orientation.metadata()["bulletin"] == "IERS finals2000A, fetched"
    finally:
        earth_orientation.newest_bulletin.cache_clear()


def test_an_object_is_predicted_by_its_number_and_name(server, capsys, clock, tmp_path):
    server.sets("CATNR=101", as_csv(LINES))
    server.sets("NAME=TEST", as_csv(LINES))
    assert cli.main(["predict", "101", "-o", str(tmp_path / "mine.oem")]) == 0
    told = capsys.readouterr()
    assert told.out.startswith("TEST (101, 1998-067A) from 2026-01-03T")
    assert cli.main(["predict", "TEST"]) == 0
    by_name = capsys.readouterr().out
    assert by_name.splitlines()[:4] == told.out.splitlines()[:4]
    server.answers.clear()
    clock.pass_by(30.0)
    assert cli.main(["predict", "101"]) == 0
    again = capsys.readouterr()
    assert again.out == by_name
    assert "no such file here; at hand: sets of 30 h ago, weather of 30 h ago" in again.err
    made = opml.predict("101")
    assert told.out.startswith(f"{made.identity} from {made.date} UTC: {made.way}")
    assert cli.main(["predict", "7"]) == 1
    assert "got 404: no such file here" in capsys.readouterr().err


def test_sets_of_a_group_serve_its_objects(server, capsys, tmp_path):
    server.sets("GROUP=stations", as_csv([*LINES, *sinking_histories.sets_of(102, 45)]))
    assert cli.main(["fetch", "--group", "stations"]) == 0
    assert capsys.readouterr().out.startswith("stations: 90 sets, 90 new: ")
    assert public_data.sets_of(Query.of("102")) == [Query("group", "stations").folder]
    better = tmp_path / "better.csv"
    assert cli.main(["improve", "-o", str(better), "--date", "2026-01-03T06:00:00"]) == 0
    assert len(better.read_text().splitlines()) == 3
    server.requests.clear()
    assert "2 objects, corrected along the track: " in capsys.readouterr().out
    assert cli.main(["fetch"]) == 0
    assert capsys.readouterr().out.startswith("stations: 90 sets, 0 new: ")


def test_nobody_who_answers_is_told_in_one_line(monkeypatch, tmp_path, capsys):
    monkeypatch.setenv("OPML_DATA", str(tmp_path))
    assert cli.main(["fetch", "25544"]) == 1
    assert re.fullmatch(
        r"opml: http://127.0.0.1:9/NORAD\S+: expected an answer, got .*\n", capsys.readouterr().err
    )
    assert list(tmp_path.rglob("*.csv")) == []
