"""Mornings from a file of element sets: their days and the body follow from them, and the plan takes them."""

import errno

import numpy as np
import pytest
import sinking_histories
from element_histories import history, tle_text
from support import refusals

from opml import cli
from opml.catalog.kinds import ELEMENTS
from opml.interop.element_sets import mean_elements
from opml.study.checks import load_settings
from opml.study.settings import editor_schema
from opml.study.settings.merging import merged
from opml.workflow.first_project import LONGEST_SETS, FirstProject


def test_a_project_of_sets_can_be_run(tmp_path, monkeypatch, capsys):
    sinking_histories.write(tmp_path / "my sets.tle", [101], 40)
    assert cli.main(["init", str(tmp_path / "new"), "--elements", str(tmp_path / "my sets.tle")]) == 0
    printed = capsys.readouterr().out
    assert "my sets.tle: its last 39 days of sets, from 2025-11-20 on; area to mass " in printed
    assert "\nopml day --configfile mine.yaml --date 2025-12-29\n" in printed
    monkeypatch.chdir(tmp_path / "new")
    settings = load_settings(merged(["config/config.yaml", "mine.yaml"]))
    sets = mean_elements.read_sets("my sets.tle")
    assert settings.values["epoch"] == "2025-11-20T00:00:00"
    assert settings.values["duration_days"] == 39 + 7
    assert (settings.values["day"], settings.values["study"]) == ({}, None)
    assert settings.values["elements"] == {"mine": "my sets.tle"}
    ballistic = 2.2 * settings.values["rsos"]["mine"]["area_to_mass_m2pkg"]
    assert ballistic == pytest.approx(12.7416 * np.median([one.satellite.bstar for one in sets]), rel=0.05)


def test_a_folder_that_grows_stays_where_it_is(tmp_path, monkeypatch):
    (tmp_path / "gp").mkdir()
    for day in (20, 30):
        sinking_histories.write(tmp_path / "gp" / f"{day}.tle", [101], day)
    assert cli.main(["init", str(tmp_path / "new"), "--elements", str(tmp_path / "gp")]) == 0
    monkeypatch.chdir(tmp_path / "new")
    settings = load_settings(merged(["config/config.yaml", "mine.yaml"]))
    assert settings.files_of(ELEMENTS) == {"mine": [str(tmp_path / "gp" / f"{day}.tle") for day in (20, 30)]}


def test_the_newest_days_of_a_long_history_count(tmp_path, capsys):
    sinking_histories.write(tmp_path / "sets.tle", [101], 120)
    assert cli.main(["init", str(tmp_path / "new"), "--elements", str(tmp_path / "sets.tle")]) == 0
    assert f"its last {LONGEST_SETS} days of sets, from 2025-12-18 on" in capsys.readouterr().out


def test_the_sets_may_be_where_the_project_begins(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    sinking_histories.write(tmp_path / "sets.tle", [101], 30)
    assert cli.main(["init", ".", "--elements", "sets.tle"]) == 0
    assert len(mean_elements.read_sets(tmp_path / "sets.tle")) == 30


@pytest.mark.parametrize(("name", "said"), refusals("files_of_no_project"))
def test_files_that_make_no_project_are_refused(name, said, tmp_path, capsys):
    sinking_histories.write(tmp_path / name, [101], 30)
    if name == "points.csv":
        (tmp_path / name).write_text("utc,x_m\n2026-02-10T00:00:00,1\n")
    assert cli.main(["init", str(tmp_path / "new"), "--elements", str(tmp_path / name)]) == 1
    assert said in capsys.readouterr().err
    assert not (tmp_path / "new").exists()


def test_a_full_disk_leaves_no_half_of_a_project(tmp_path, monkeypatch, capsys):
    def full(*_):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(editor_schema, "write", full)
    assert cli.main(["init", str(tmp_path / "new")]) == 1
    assert (
        f"opml: {tmp_path / 'new'}: expected a file that can be written, got No space"
        in capsys.readouterr().err
    )
    assert not any((tmp_path / "new").iterdir())


REFUSED = {
    "several objects": ([101, 102], 40, "expected sets of one object, got 2: 101, 102"),
    "few days": ([101], 10, "expected sets of 20 days or more, got those of 9"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_other_files_are_refused_and_nothing_is_written(case, tmp_path, capsys):
    numbers, days, message = REFUSED[case]
    sinking_histories.write(tmp_path / "sets.tle", numbers, days)
    assert cli.main(["init", str(tmp_path / "new"), "--elements", str(tmp_path / "sets.tle")]) == 1
    assert message in capsys.readouterr().err
    assert not (tmp_path / "new").exists()


def test_a_body_without_drag_gets_the_least(tmp_path):
    (tmp_path / "sets.tle").write_text(tle_text(history(range(30))))
    assert FirstProject.of_sets(tmp_path / "sets.tle").chosen.endswith(
        "area to mass 0.0003 m2/kg by their B*"
    )
