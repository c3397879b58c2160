"""Dates that `opml day` may be asked for."""

import json
import os
import signal
import sys
from datetime import date, timedelta
from threading import Thread
from types import SimpleNamespace

import pytest
from support import refusal

from opml import cli
from opml.catalog.kinds import ELEMENTS, FIXES
from opml.workflow import day_command, lock
from opml.workflow.day_command import Call, check_dates, lengthened, mornings_ahead

EPOCH, TODAY = "2016-09-28T12:09:45", date(2016, 10, 3)
WITHIN = "expected a day from 2016-09-28 to 2016-10-03, today, got"
WRONG = {
    ("2016-10-04", "2016-10-04"): f"--date: {WITHIN} 2016-10-04",
    ("9999-12-31", "9999-12-31"): f"--date: {WITHIN} 9999-12-31",
    ("2016-09-27", "2016-09-27"): f"--date: {WITHIN} 2016-09-27",
    ("2016-10-01", "2016-09-01"): f"--since: {WITHIN} 2016-09-01",
    ("2016-09-29", "2016-09-30"): (
        "--since: expected 2016-09-29, the --date, or a day before it, got 2016-09-30"
    ),
}


def check(day, first):
    call = Call(date.fromisoformat(day), date.fromisoformat(first), [], [], dry=True)
    check_dates(call, EPOCH, today=TODAY)


@pytest.mark.parametrize("dates", WRONG)
def test_dates_that_are_no_mornings_are_refused(dates):
    assert refusal(check, *dates) == WRONG[dates]


def test_an_epoch_that_does_not_exist_is_refused(monkeypatch):
    monkeypatch.setattr(sys.modules[__name__], "EPOCH", "2016-13-28T12:09:45")
    assert "epoch: expected an instant that exists, got '2016-13-28" in refusal(
        check, "2016-10-01", "2016-10-01"
    )


def test_a_run_has_no_end():
    """A project's morning job on its day 400 and on all before: the run is lengthened every four weeks."""
    first = date.fromisoformat(EPOCH[:10])
    days = [lengthened(97.5, EPOCH, first + timedelta(days=k)) for k in range(401)]
    assert days[:99] == [97.5] * 99
    assert all(k <= length + 1.0 <= max(k, 98) + 29 for k, length in enumerate(days))
    assert len({*days}) == 12


@pytest.mark.parametrize(
    ("kind", "day", "warned"),
    [(ELEMENTS, "2026-10-15", 1), (ELEMENTS, "2026-10-16", 0), (FIXES, "2026-10-15", 0)],
)
def test_a_day_that_the_model_of_sets_has_seen_is_warned_of(kind, day, warned):
    settings = SimpleNamespace(measured={"first": ["a"]}, kind_of=lambda rso: kind)
    assert len(day_command.warnings(date.fromisoformat(day), settings)) == warned


def test_a_project_of_an_older_version_is_told_of_the_upgrade(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "config").mkdir()
    (tmp_path / "config" / "config.yaml").write_text("ephemeris: {step_s: 60}\nday: {}\n")
    told = refusal(day_command.show, "mine", date(2026, 2, 19), [])
    assert told.endswith(": `opml init --upgrade .` helps a project of an older version")


def test_what_jobs_warned_of_is_told_once(tmp_path):
    lines = [f"2026-02-19 11:30:59,255 WARNING skipped, {k}.csv" for k in range(7)]
    lines.append("2026-02-19 11:31:00,000 WARNING mine: no weather")
    for batch in "01":
        (tmp_path / f"objects_{batch}.log").write_text("\n".join(["... INFO started", *lines]))
    told = day_command.warned(tmp_path, [{"object": "mine", "reason": "no weather"}])
    assert told == [*(f"skipped, {k}.csv" for k in range(5)), f"2 more warnings in {tmp_path}"]


def test_mornings_that_were_run_are_not_ahead(tmp_path):
    settings = SimpleNamespace(
        values={"results": str(tmp_path), "epoch": EPOCH}, measured={"first": ["a"], "second": ["b"]}
    )
    done = tmp_path / "days" / "2016-10-02" / "batch_0"
    done.mkdir(parents=True)
    mark = {"settings": "", "stations": {}, "models": []}
    (done / "done.json").write_text(json.dumps({"second": mark}))
    assert mornings_ahead(TODAY, settings) == {"first": 6, "second": 1}


def test_a_workflow_that_fails_without_a_word_is_told(monkeypatch, capsys):
    monkeypatch.setattr("sys.executable", "false")
    assert day_command._snakemake(Call(TODAY, TODAY, [], [], dry=False), ["day.html"], 10.0) == 1
    assert "opml: the workflow failed; `opml day -n`" in capsys.readouterr().err


RUN = """\
import subprocess, sys
job = "import sys, time; at_work = open(sys.argv[1], 'w'); time.sleep(600)"
subprocess.run([sys.executable, "-c", job, sys.argv[1]])
"""


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_an_interrupt_ends_all_jobs_without_a_word(number, tmp_path, capfd):
    """The end that reads of a pipe is at its end once all that hold the other are gone."""
    os.mkfifo(tmp_path / "job")
    command = [sys.executable, "-c", RUN, str(tmp_path / "job")]
    usual = {signal.SIGINT: signal.default_int_handler} | dict.fromkeys(
        (signal.SIGTERM, signal.SIGHUP), signal.SIG_DFL
    )
    before = {one: signal.signal(one, handler) for one, handler in usual.items()}
    left = []

    def strike():
        with open(tmp_path / "job") as at_work:
            os.kill(os.getpid(), number)
            left.append(at_work.read())

    striking = Thread(target=strike, daemon=True)
    striking.start()
    try:
        with pytest.raises(KeyboardInterrupt, match="the same command resumes the run"):
            day_command._exit_code(command)
    finally:
        for one, handler in before.items():
            signal.signal(one, handler)
    striking.join(timeout=60.0)
    assert left == [""]
    assert capfd.readouterr().err == ""


def test_threads_of_jobs_share_two_heaps_unless_told_otherwise(monkeypatch):
    told = [sys.executable, "-c", "import os, sys; sys.exit(int(os.environ['MALLOC_ARENA_MAX']))"]
    monkeypatch.delenv("MALLOC_ARENA_MAX", raising=False)
    assert day_command._exit_code(told) == 2
    monkeypatch.setenv("MALLOC_ARENA_MAX", "5")
    assert day_command._exit_code(told) == 5


def test_pages_of_days_stay_while_another_call_is_at_work(tmp_path, monkeypatch):
    run = SimpleNamespace(results=str(tmp_path), epoch=EPOCH, duration_days=10.0)
    asked = SimpleNamespace(run=run, values=vars(run), measured={})
    monkeypatch.setattr(day_command, "_settings", lambda configfiles: asked)
    day = tmp_path / "days" / "2016-10-01"
    day.mkdir(parents=True)
    (day / "objects_0.json").write_text(json.dumps([{"object": "one", "verdict": "failed"}]))
    (day / "day.html").write_text("one: failed")
    call = Call(date(2016, 10, 1), date(2016, 10, 1), [], [], dry=False)
    with lock.hold(tmp_path):
        assert "expected no other run in this folder of results, but process" in refusal(
            day_command.run, call
        )
        assert len(list(day.iterdir())) == 2
    monkeypatch.setattr(day_command, "_snakemake", lambda *_: 1)
    assert day_command.run(call) == day_command.WORKFLOW_FAILED
    assert not list(day.iterdir())


def test_a_folder_without_a_project_is_told_how_to_make_one(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert cli.main(["day"]) == 1
    assert capsys.readouterr().err == (
        f"opml: config/config.yaml: no such file in {tmp_path}; `opml init FOLDER` makes a project\n"
    )


@pytest.mark.parametrize("cores", ["0", "-1"])
def test_numbers_of_cores_that_are_none_are_refused(cores, capsys):
    assert cli.main(["day", "-j", cores]) == 1
    assert capsys.readouterr().err == f"opml: --cores: expected 1 or more, got {cores}\n"
