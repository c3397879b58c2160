"""docs/day.md, followed: one command a day; what is wrong with one object stops no other."""

import json
import os
import re
import signal
import subprocess
import sys

import pytest
from project import ROOT, forked

SETTINGS = """\
results: results
epoch: "2016-09-28T12:09:45"
duration_days: 2
tracks: {mine: tracks/mine.tdm, broken: tracks/broken.tdm, absent: "tracks/absent/*.tdm"}
rsos:
  mine: {area_to_mass_m2pkg: 0.05, cd: 2.2, cr: 1.25}
  broken: {area_to_mass_m2pkg: 0.05, cd: 2.2, cr: 1.25}
  absent: {area_to_mass_m2pkg: 0.05, cd: 2.2, cr: 1.25}
environment: {solar_activity: weather.csv, knowledge: forecast}
force_models: {assumed: {degree: 8, order: 8, third_bodies: [sun, moon]}}
integrator: {max_step_s: 120}
prediction: {max_days: 1}
study: {}
day: {models: [fit24], hour: 12, futures: 4}
"""
TRACKS = ROOT / "tests" / "reference" / "orekit.tdm"
WEATHER = ROOT / "src" / "opml" / "data" / "space_weather.csv"


def weather_comes(folder, until):
    """Write the operator's file of the weather: what was measured until a date."""
    lines = WEATHER.read_text().splitlines(keepends=True)
    (last,) = (number for number, line in enumerate(lines) if line.startswith(until))
    (folder / "weather.csv").write_text("".join(lines[: last + 1]))


def opml_day(folder, *arguments, settings="mine.yaml"):
    """Run `opml day` in a folder; its exit code and what it prints."""
    command = ["day", "--configfile", settings, *arguments]
    return forked(
        command, cwd=folder, env=os.environ | {"PYTHONPATH": str(ROOT / "src")}, program="opml.__main__"
    )


def page(folder, date):
    """What became of each object on a day."""
    found = json.loads((folder / "results" / "days" / date / "day.json").read_text())
    return {outcome["object"]: outcome for outcome in found["objects"]}


@pytest.fixture(scope="module")
def operator(tmp_path_factory):
    """A project of an operator with two days of tracks, one broken file and one that is not there."""
    folder = tmp_path_factory.mktemp("operator")
    for name in ("Snakefile", "workflow", "config", "profiles"):
        (folder / name).symlink_to(ROOT / name)
    (folder / "mine.yaml").write_text(SETTINGS)
    (folder / "tracks").mkdir()
    (folder / "tracks" / "mine.tdm").write_text(TRACKS.read_text())
    (folder / "tracks" / "broken.tdm").write_text("CCSDS_TDM_VERS = 2.0\nrubbish\n")
    weather_comes(folder, "2016-09-29")
    return folder


@pytest.mark.dag
@pytest.mark.parametrize("seconds", [1.5, 3.0, 4.5])
def test_an_interrupt_is_told_in_one_line(operator, seconds):
    """The tests below go on in the same folder."""
    line = [sys.executable, "-m", "opml", "day", "--configfile", "mine.yaml", "--date", "2016-09-29"]
    environment = os.environ | {"PYTHONPATH": str(ROOT / "src")}
    streams = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, "text": True}
    with subprocess.Popen(line, cwd=operator, env=environment, process_group=0, **streams) as run:
        with pytest.raises(subprocess.TimeoutExpired):
            run.wait(seconds)
        os.killpg(run.pid, signal.SIGINT)
        told, _ = run.communicate(timeout=60.0)
    assert run.returncode == 130, told
    assert "opml: interrupted" in told.splitlines()[-1]
    assert "Traceback" not in told


@pytest.mark.dag
def test_an_object_that_fails_stops_no_other_and_is_tried_again(operator):
    code, told = opml_day(operator, "--date", "2016-09-29")
    found = page(operator, "2016-09-29")
    assert code == 2, told
    assert found["mine"]["verdict"] == "unproven"  # no past on the first morning
    assert found["broken"]["verdict"] == found["absent"]["verdict"] == "failed"
    assert "tracks/broken.tdm: line 2: expected KEY = value" in told
    assert "absent/*.tdm: no such file" in told
    log = operator / "results" / "logs" / "days" / "2016-09-29" / "objects_0.log"
    assert "mine, 2016-09-29: unproven" in log.read_text()
    (operator / "tracks" / "broken.tdm").write_text(TRACKS.read_text())
    code, told = opml_day(operator, "--date", "2016-09-29")
    assert code == 2, told
    assert page(operator, "2016-09-29")["broken"]["verdict"] == "unproven"
    assert "mine, 2016-09-29" not in log.read_text()
    assert "broken, 2016-09-29: unproven" in log.read_text()
    code, told = opml_day(operator, "--date", "2016-09-29", "--object", "mine")
    assert code == 0
    assert "**mine. Send with care: unproven**" in told
    code, told = opml_day(operator, "--date", "2016-09-29", "--object", "absent")
    assert code == 1
    assert told == ("opml: --object: expected an object whose morning of 2016-09-29 is over, got absent\n")


@pytest.mark.dag
def test_a_day_later_the_days_between_are_caught_up(operator):
    weather_comes(operator, "2016-10-01")
    code, told = opml_day(operator, "--date", "2016-10-01", "--since", "2016-09-30")
    assert code == 2, told
    assert "3 objects" in told
    yesterday, today = (page(operator, f"2016-{day}")["mine"] for day in ("09-30", "10-01"))
    assert (yesterday["tracks"], today["tracks"]) > (0, 0)
    assert sum(score["predictions"] for score in today["past"]["all"]) >= 0
    html = (operator / "results" / "days" / "2016-10-01" / "day.html").read_text()
    assert "3 objects" in html
    assert "broken" in html


@pytest.mark.dag
def test_a_project_runs_on_its_day_400(operator):
    """Its settings have it last for two days."""
    code, told = opml_day(operator, "-n", "--date", "2017-11-02")
    assert code == 0, told
    assert re.search(r"^mornings +1$", told, re.MULTILINE), told
    assert "Mornings: objects of batch 0 up to 2017-11-02" in told


def test_without_the_setting_one_line_says_what_is_missing(operator):
    (operator / "other.yaml").write_text("study: {}\n")
    code, told = opml_day(operator, "-n", settings="other.yaml")
    assert code == 1
    assert (
        told == "opml: day: expected a setting `day` that asks for mornings, got none in --configfile;"
        " `day: {}` is enough\n"
    )
