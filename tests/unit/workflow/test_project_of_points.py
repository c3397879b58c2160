"""A study from files of an object's positions: its days follow from them, and the plan takes it."""

import numpy as np
import pandas as pd
import pytest
import yaml
from support import EPOCH

from opml import cli
from opml.base.constants import DAY
from opml.interop import ccsds
from opml.study.checks import load_settings
from opml.study.settings.merging import merged
from opml.workflow.first_project import LONGEST_POINTS, FirstProject


@pytest.fixture
def days_of_points(tmp_path):
    """Return what writes points four times a day from EPOCH on, two days a file, and returns the files."""

    def write(days):
        paths = []
        for begin in range(0, days, 2):
            t = DAY * np.arange(begin, min(begin + 2, days), 0.25)
            angle = 0.001 * t
            km = {"x": 7e3 * np.cos(angle), "y": 7e3 * np.sin(angle), "z": 0.0 * t}
            points = pd.DataFrame({f"{axis}_gcrf_km": values for axis, values in km.items()})
            points.insert(0, "utc", ccsds.utc_texts(EPOCH, t))
            paths.append(tmp_path / f"points {begin}.csv")
            points.to_csv(paths[-1], index=False)
        return paths

    return write


@pytest.mark.parametrize(
    ("days", "first", "whole"), [(12, "2016-09-29", 11), (45, "2016-10-08", LONGEST_POINTS)]
)
def test_a_project_of_points_can_be_run(days, first, whole, days_of_points, tmp_path, monkeypatch, capsys):
    paths = days_of_points(days)
    assert cli.main(["init", str(tmp_path / "new"), "--orbit", *map(str, paths)]) == 0
    assert f"points 0.csv: its last {whole} days of points, from {first} on" in capsys.readouterr().out
    monkeypatch.chdir(tmp_path / "new")
    settings = load_settings(merged(["config/config.yaml", "mine.yaml"])).values
    assert settings["epoch"] == f"{first}T00:00:00"
    assert settings["duration_days"] == whole + 7
    assert settings["fixes"] == {"mine": [str(tmp_path / "*.csv")]}
    assert "day" in settings


def test_files_beside_others_are_named_one_by_one(days_of_points, tmp_path):
    paths = [str(path) for path in days_of_points(14)]
    project = FirstProject.of_points(paths[:-1])
    assert yaml.safe_load(project.text)["fixes"] == {"mine": sorted(paths[:-1])}


def test_too_few_days_are_refused(days_of_points, tmp_path, capsys):
    assert cli.main(["init", str(tmp_path / "new"), "--orbit", *map(str, days_of_points(8))]) == 1
    assert "points 0.csv: expected points of 8 whole days or more, got 7" in capsys.readouterr().err
    assert not (tmp_path / "new").exists()
