"""NRLMSIS 2.1: the ap that it takes, and where its code may be installed."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pymsis
import pytest
from support import REPOSITORY

from opml.base.errors import InputError
from opml.environment import known_weather, nrlmsis


def test_activity_of_the_storm_comes_three_hourly():
    # Kp of 2016-10-13, day 57674: 2+ 3o 4+ 5- 5- 6+ 6+ 5o.
    weather = known_weather.read("OBSERVED")
    ap = nrlmsis.ap_of_kp(weather.kp)
    last = 8 * (57674 - weather.first) + 7
    daily, *recent = nrlmsis.ap_inputs(ap, last)[:5]
    assert recent == [48.0, 94.0, 94.0, 39.0]
    assert daily == pytest.approx(np.mean([9, 15, 32, 39, 39, 94, 94, 48]))
    assert nrlmsis.ap_inputs(ap, last - 1)[1] == 94.0


def test_the_model_may_be_installed_in_a_folder_with_an_umlaut(tmp_path):
    installed, folder = Path(pymsis.__file__).parent, tmp_path / "Größe"
    for path in installed.parent.glob("pymsis*"):
        shutil.copytree(path, folder / path.name)
    grid = [np.array([0.0, 1.0]), np.zeros(1), np.array([4e5])]
    figures = np.array([100.0, 100.0, *[4.0] * 7])
    call = "nrlmsis.densities(17072.5, [0.0, 1.0], [0.0], nrlmsis.np.array([4e5]), [100.0] * 2 + [4.0] * 7)"
    done = subprocess.run(
        [sys.executable, "-c", f"from opml.environment import nrlmsis; print({call}.tolist())"],
        env=os.environ | {"PYTHONPATH": os.pathsep.join([str(folder), str(REPOSITORY / "src")])},
        capture_output=True,
        text=True,
    )
    assert done.stdout == f"{nrlmsis.densities(17072.5, *grid, figures).tolist()}\n", done.stderr


def test_a_missing_code_is_told(monkeypatch):
    monkeypatch.setattr(nrlmsis, "find_spec", lambda name: None)
    with pytest.raises(InputError, match=r"expected the package pymsis, got none: pip install"):
        nrlmsis.check_installed()
