"""NRLMSIS 2.1 as a table of the environment: against direct calls, and its weather against the files'."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import numba
import numpy as np
import pandas as pd
import pymsis
import pytest
from support import EPOCH, REPOSITORY, environment, force_model, paper_values

from opml.base.constants import HOUR
from opml.base.errors import InputError
from opml.base.thermosphere_grid import ALTITUDES
from opml.dynamics import forces
from opml.dynamics.kernels import acceleration
from opml.dynamics.kernels.acceleration import SCRATCH_ROWS
from opml.dynamics.kernels.lanes import WIDTH, load, rows, splat, sqrt, store
from opml.dynamics.kernels.surroundings import allocate, look_up
from opml.environment import nrlmsis
from opml.study.settings.model.whole import RunSettings
from opml.study.source_coverage import check
from opml.tables import SCHEMAS

NODES = environment()["solar_activity"]["t"].to_numpy()[:12]
TABLE = nrlmsis.tabulate("OBSERVED", EPOCH, NODES)
WEATHER = nrlmsis.read_weather("OBSERVED", EPOCH, NODES)
RNG = np.random.default_rng(11)


@numba.njit(cache=True, error_model="numpy")
def _density_at(t, positions, model, values, factors, scratch, out):
    look_up(t, model, values, factors)
    x, y, z = load(positions, 0), load(positions, 1), load(positions, 2)
    altitude, rho = acceleration.density(
        x, y, z, 1.0 / sqrt(x * x + y * y + z * z), splat(0.0), model, values, factors, scratch
    )
    store(out, 0, altitude)
    store(out, 1, rho)


def model():
    """The truth with a tabulated thermosphere that reaches a few hours."""
    return force_model(4)._replace(tabulated=forces.logarithms(TABLE))


def table_and_direct(t, positions):
    """Densities (WIDTH,) of the table and of direct calls at ITRF positions (3, WIDTH) [m].

    Within an hour the weather goes from that at its start to that at its end, as everywhere.
    """
    flown, out, block = model(), rows(2), rows(3)
    block[:] = positions
    _density_at(t, block, flown, *allocate(flown), rows(SCRATCH_ROWS), out)
    before = np.searchsorted(NODES, t, side="right") - 1
    part = (t - NODES[before]) / HOUR
    places = list(zip(*geodetic(positions), out[0], strict=True))
    start, end = (direct(t, places, figures) for figures in WEATHER[before : before + 2])
    return out[1].copy(), start ** (1.0 - part) * end**part


def direct(t, places, figures):
    """Densities of the model itself at longitudes, latitudes [rad] and altitudes [m]."""
    clock = nrlmsis.clocks(EPOCH, np.array([t]))[0]
    found = [nrlmsis.densities(clock, *np.array(place)[:, None], figures).item() for place in places]
    return np.array(found)


def geodetic(positions):
    """Longitude and geodetic latitude [rad], the latter by iteration."""
    x, y, z = positions
    p, e2 = np.hypot(x, y), 0.0066943799901413165
    north = np.arctan2(z, p * (1 - e2))
    for _ in range(6):
        n = 6378137.0 / np.sqrt(1 - e2 * np.sin(north) ** 2)
        north = np.arctan2(z + e2 * n * np.sin(north), p)
    return np.arctan2(y, x), north


def errors(low, high, count=8):
    """Relative errors of the table at random places between two distances [m], in the hours that it has."""
    found = []
    for t in RNG.uniform(NODES[3], NODES[-5], count):
        direction = RNG.normal(size=(3, WIDTH))
        places = direction / np.linalg.norm(direction, axis=0) * RNG.uniform(low, high, WIDTH)
        table, direct = table_and_direct(t, places)
        found.append(table / direct - 1.0)
    return np.array(found)


def test_table_has_its_columns():
    assert list(TABLE.columns) == SCHEMAS["thermosphere"].names


@pytest.mark.parametrize(("low", "high"), [(6560e3, 6700e3), (6720e3, 6980e3), (6980e3, 7600e3)])
def test_table_meets_direct_calls_to_a_part_of_a_percent(low, high):
    found = errors(low, high)
    assert np.sqrt(np.mean(found**2)) < 0.0015
    assert np.abs(found).max() < 0.007


def test_poles_and_midnight_are_no_edges():
    pole = np.array([[1.0, -1.0] * 8, [1.0, 1.0] * 8, [6.8e6, -6.8e6] * 8])
    table, direct = table_and_direct(NODES[4] + 700.0, pole)
    np.testing.assert_allclose(table, direct, rtol=0.005)


def test_above_the_table_there_is_nothing_and_below_it_the_lowest_density():
    high = np.full((3, WIDTH), (6378137.0 + ALTITUDES[-1] + 1e3) / np.sqrt(3.0))
    assert (table_and_direct(NODES[4], high)[0] == 0.0).all()
    low = np.repeat([[6378137.0 + 50e3], [0.0], [0.0]], WIDTH, axis=1)
    slightly_higher = np.repeat([[6378137.0 + ALTITUDES[0]], [0.0], [0.0]], WIDTH, axis=1)
    found = [table_and_direct(NODES[4], place)[0] for place in (low, slightly_higher)]
    np.testing.assert_allclose(*found, rtol=1e-6)


def test_activity_of_the_storm_comes_three_hourly():
    # Kp of 2016-10-13: 2+ 3o 4+ 5- 5- 6+ 6+ 5o.
    t = (pd.Timestamp("2016-10-13T22:00:00") - pd.Timestamp(EPOCH)).total_seconds()
    daily, *recent = nrlmsis.read_weather("OBSERVED", EPOCH, np.array([t]))[0, 2:7]
    assert recent == [48.0, 94.0, 94.0, 39.0]
    assert daily == pytest.approx(np.mean([9, 15, 32, 39, 39, 94, 94, 48]))


def test_weather_of_an_interval_holds_from_its_start():
    start = (pd.Timestamp("2016-10-13T21:00:00") - pd.Timestamp(EPOCH)).total_seconds()
    before, after = nrlmsis.read_weather("OBSERVED", EPOCH, np.array([start - 60.0, start + 60.0]))[:, 3]
    assert (before, after) == (94.0, 48.0)


def test_monthly_figures_are_refused_before_any_job():
    values = paper_values()
    values["force_models"]["truth"]["atmosphere"] = "NRLMSIS"
    with pytest.raises(
        InputError, match=r"force_models\.truth\.atmosphere: NRLMSIS: MSAFE: expected weather"
    ):
        check(RunSettings(**values))
    values["environment"]["true_solar_activity"] = "OBSERVED"
    check(RunSettings(**values))


def test_single_precision_is_enough():
    exact = np.log(TABLE[[f"at_{ALTITUDES[8] / 1e3:.0f}_km"]].to_numpy().ravel())
    kept = forces.logarithms(TABLE)[..., 8].ravel()
    assert np.abs(np.expm1(kept - exact)).max() < 3e-6


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


def test_a_missing_code_is_told_before_any_job(monkeypatch):
    values = paper_values()
    values["force_models"]["truth"]["atmosphere"] = "NRLMSIS"
    values["environment"]["true_solar_activity"] = "OBSERVED"
    monkeypatch.setattr(nrlmsis, "find_spec", lambda name: None)
    with pytest.raises(InputError, match=r"NRLMSIS: expected the package pymsis, got none: pip install"):
        check(RunSettings(**values))
