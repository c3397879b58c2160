"""Space-Track's histories: its own account, each day once, nothing of the account anywhere."""

import json
from contextlib import suppress
from datetime import UTC, datetime, timedelta

import pytest
import sinking_histories
from data_server import as_csv, as_omms, serving

from opml import cli
from opml.fetch import public_data, space_track
from opml.fetch.downloads import NoAnswerError
from opml.fetch.public_data import Query
from opml.interop.element_sets import known_sets

LINES = sinking_histories.sets_of(101, 5)
PASSWORD = "correct-horse"
FIELDS = ("NORAD_CAT_ID", "CREATION_DATE")
ARGUMENTS = ["fetch", "101", "--since"]


def history(first, last, numbers="101"):
    """The path of a query of the object 101, or of others."""
    asked = f"norad_cat_id/{numbers}/creation_date/{first}--{last}/orderby/creation_date/format/json"
    return f"/basicspacedata/query/class/gp_history/{asked}"


@pytest.fixture
def server(monkeypatch, tmp_path):
    time = [datetime(2026, 1, 4, 5, tzinfo=UTC)]
    monkeypatch.setattr(space_track, "now", lambda: time[0])
    monkeypatch.setattr("opml.fetch.public_data.renew", lambda *_, **__: None)
    monkeypatch.setenv("NETRC", str(tmp_path / "netrc"))
    (tmp_path / "netrc").write_text(f"machine 127.0.0.1 login me@here.org password {PASSWORD}\n")
    with serving(monkeypatch, tmp_path / "data") as server:
        fields = [{"Field": name, "Type": "varchar(9)", "Null": "NO", "Default": ""} for name in FIELDS]
        server.answers["/ajaxauth/login"] = server.answers["/ajaxauth/logout"] = (200, b'""')
        server.answers["/basicspacedata/modeldef/class/gp_history"] = (
            200,
            json.dumps({"data": fields}).encode(),
        )
        server.wait = lambda days: time.append(time.pop() + timedelta(days=days))
        yield server


def asked(server):
    """Paths of the queries of histories, in their order."""
    return [path for path in server.asked() if "/query/" in path]


def test_a_history_grows_and_no_day_is_asked_for_twice(server, capsys, tmp_path):
    sets = [one | {"CREATION_DATE": "2026-01-02T03:04:05"} for one in as_omms(LINES)]
    server.answers[history("2026-01-01", "2026-01-04")] = (200, json.dumps(sets).encode())
    for path in (history("2026-01-04", "2026-01-05"), history("2025-12-30", "2026-01-01")):
        server.answers[path] = (200, b"[]")
    assert cli.main([*ARGUMENTS, "2026-01-01"]) == 0
    assert cli.main([*ARGUMENTS, "2026-01-02"]) == 0
    server.wait(1)
    assert cli.main([*ARGUMENTS, "2025-12-30"]) == 0
    assert asked(server) == [
        history("2026-01-01", "2026-01-04"),
        history("2025-12-30", "2026-01-01"),
        history("2026-01-04", "2026-01-05"),
    ]
    told = capsys.readouterr()
    assert told.out.splitlines()[0] == "101: 5 sets, published from 2026-01-01 to 2026-01-04: Space-Track"
    read = known_sets.of_object([Query.of("101").folder], None)
    assert {one.created for one in read} == {"2026-01-02T03:04:05.000000"}
    assert server.sent == [f"identity=me%40here.org&password={PASSWORD}"] * 2
    written = "".join(path.read_text() for path in (tmp_path / "data").rglob("*") if path.is_file())
    assert PASSWORD not in written + told.out + told.err


def test_objects_of_a_group_that_lack_the_same_days_are_asked_for_together(server, capsys, monkeypatch):
    monkeypatch.setattr(space_track, "_TOGETHER", 2)
    rows = as_csv([line for number in (101, 102, 103) for line in sinking_histories.sets_of(number, 1)])
    known = [one | {"CREATION_DATE": "2026-01-02T03:04:05"} for one in as_omms(LINES)]
    days = ("2026-01-01", "2026-01-04")
    server.sets("GROUP=few", rows)
    with suppress(NoAnswerError):  # of the weather
        public_data.renew_object_data([Query("group", "few")], say=str)
    server.answers[history(*days)] = server.answers[history(*days, "102%2C103")] = (
        200,
        json.dumps(known).encode(),
    )
    assert cli.main([*ARGUMENTS, days[0]]) == 0
    assert cli.main(["fetch", "--group", "few", "--since", days[0]]) == 0
    assert asked(server) == [history(*days), history(*days, "102%2C103")]
    assert "few: 5 sets of 2 objects, published from 2026-01-01 to" in capsys.readouterr().out
    (folder,) = public_data.sets_of(Query.of("102"))
    assert [path.suffix for path in sorted(folder.iterdir())] == [".json", ".csv"]


ERRORS = {
    "login": ("/ajaxauth/login", 200, '{"Login":"Failed"}', "got a login that failed"),
    "too fast": (history("2026-01-01", "2026-01-04"), 429, "slow down", "429 Too Many Requests"),
    "page": (
        history("2026-01-01", "2026-01-04"),
        200,
        "<html>maintenance</html>",
        "expected element sets, got",
    ),
    "error": (history("2026-01-01", "2026-01-04"), 200, '{"error":"no"}', "got Space-Track: an error"),
}


@pytest.mark.parametrize("error", ERRORS)
def test_an_error_is_one_line_and_leaves_nothing(server, capsys, tmp_path, error):
    path, status, body, words = ERRORS[error]
    server.answers[path] = (status, body.encode())
    assert cli.main([*ARGUMENTS, "2026-01-01"]) == 1
    told = capsys.readouterr().err
    assert words in told
    assert told.count("\n") == 1
    assert PASSWORD not in told
    assert list((tmp_path / "data").rglob("gp/**/*.json")) == []


def test_an_account_may_be_in_the_environment(server, monkeypatch):
    monkeypatch.setenv("SPACETRACK_USER", "other")
    monkeypatch.setenv("SPACETRACK_PASSWORD", "pass")
    server.answers[history("2026-01-01", "2026-01-04")] = (200, b"[]")
    assert cli.main([*ARGUMENTS, "2026-01-01"]) == 0
    assert server.sent == ["identity=other&password=pass"]


def test_what_is_lacking_is_named(server, capsys, monkeypatch, tmp_path):
    (tmp_path / "netrc").write_text("")
    assert cli.main([*ARGUMENTS, "2026-01-01"]) == 1
    assert "SPACETRACK_USER and SPACETRACK_PASSWORD set, or 127.0.0.1 in ~/.netrc" in capsys.readouterr().err
    monkeypatch.setitem(__import__("sys").modules, "spacetrack", None)
    assert cli.main([*ARGUMENTS, "2026-01-01"]) == 1
    assert "pip install 'opml-orbits[spacetrack]'" in capsys.readouterr().err
