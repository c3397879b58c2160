"""A kind of measurement is one declared value, which settings, studies and fits ask."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from support import BOUNDED_ESTIMATION, REPOSITORY

from opml.base.constants import HOUR
from opml.base.errors import InputError
from opml.base.provenance import closure
from opml.base.yaml_files import read_yaml
from opml.catalog import kinds
from opml.catalog.associate import quarantine
from opml.catalog.fit import fixes
from opml.catalog.fit.first import first_orbit
from opml.catalog.propagator import Propagator
from opml.catalog.simulate import truth
from opml.figures.display_names import display_stations
from opml.study.experiments import Study
from opml.study.settings.merging import with_sheets
from opml.tables import FIX_SIGMAS, PARAMETERS, SCHEMAS, STATE
from opml.tables.columns import Column, Schema

TOY = kinds.Kind("toy", "toy_places", stations="toys")
HEIGHTS = {"x": "east", "y": "north", "z": "up"}


def measurements(table, _orientation, _stations):
    """The measurements of a table `toy_places`: positions under other names, each good to 10 m."""
    points = pd.DataFrame(np.nan, columns=[*STATE, *FIX_SIGMAS], index=table.index).assign(t=table["t"])
    points[[*HEIGHTS]] = table[[*HEIGHTS.values()]].to_numpy()
    return fixes.Fixes(fixes.arcs(points.assign(sigma_r=10.0, sigma_s=10.0, sigma_w=10.0)))


@pytest.fixture
def toy(monkeypatch):
    columns = [
        Column(name, "float64", "m" if name != "t" else "s", "", name) for name in ("t", *HEIGHTS.values())
    ]
    monkeypatch.setitem(SCHEMAS, TOY.table, Schema(TOY.table, "a place", tuple(columns)))
    monkeypatch.setitem(fixes.MEASUREMENTS, TOY.table, measurements)
    kinds.KINDS.append(TOY)
    yield TOY
    kinds.KINDS.remove(TOY)


def test_fits_are_made_to_a_kind_that_is_declared(toy, assumed_model, iss):
    propagator = Propagator(assumed_model, replace(iss, cr=0.0))
    orbit = truth.simulate(propagator, duration=12 * HOUR, step=240.0)
    table = orbit[["t", *HEIGHTS]].rename(columns=HEIGHTS)
    assert kinds.of_table(table) is toy
    settings = BOUNDED_ESTIMATION.evolve(window_hours=9.0)
    measured = fixes.measurements(table, pd.DataFrame(), [])
    starts = first_orbit.starts(propagator, measured, known=None, settings=settings)
    last = quarantine.estimate_all(propagator, starts, measured, settings=settings).iloc[-1]
    at = orbit.loc[orbit["t"] == last["t"], STATE[:3]].to_numpy()[0]
    assert last["converged"]
    assert np.linalg.norm(last[PARAMETERS[:3]].to_numpy(float) - at) < 1.0


def test_settings_and_studies_ask_a_kind_that_is_declared(toy):
    values = read_yaml(REPOSITORY / "config" / "config.yaml") | {"toy": {"iss": "a.toy"}, "study": {}}
    study = Study(with_sheets(values))
    assert study.settings.kind_of("iss") is toy
    assert study.settings.measured == study.settings.files_of(toy) == {"iss": ["a.toy"]}
    assert (study.in_place_of_stations("iss"), study.truth_of("iss")) == ("toys", "measured")


def test_the_name_of_a_kind_stands_in_the_place_of_stations(toy):
    assert kinds.in_place_of_stations() == ["fixes", "ranges", "toys"]
    assert display_stations("toys") == "toys"


def test_the_code_of_fits_is_that_of_all_kinds():
    """Else a change of one would run no fit again."""
    assert {"opml.catalog.fit.observations", "opml.catalog.fit.laser_ranges"} < closure(
        "opml.catalog.fit.fixes"
    )


def test_a_table_of_no_kind_is_refused():
    with pytest.raises(InputError, match="expected a table tracking, fixes, laser_ranges, got one of"):
        kinds.of_table(pd.DataFrame({"track": [0], "t": [5.0]}))
