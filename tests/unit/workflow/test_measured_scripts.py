"""Scripts that take what was measured, run in process as Snakemake runs them."""

from dataclasses import asdict

import laser_files
import numpy as np
import pytest
from scripts import files, run
from support import EPOCH, ESTIMATION, EXCERPTS, environment, force_model, kepler_orbit, stations

from opml.base.constants import DAY, GM, HOUR, SPEED_OF_LIGHT
from opml.catalog.fit import fixes, start_states
from opml.catalog.fit.laser_ranges import LaserRanges
from opml.catalog.fit.observations import Measured
from opml.catalog.propagator import Propagator
from opml.catalog.simulate import truth
from opml.environment import gravity_field
from opml.interop import oem
from opml.interop.object_ids import ObjectId
from opml.tables import FIX_SIGMAS, STATE, read_kind, read_metadata, read_table, write_table

MANOEUVRES = ["2016-09-28T14:09:45", "2016-09-28T13:09:45.500"]


@pytest.fixture
def taken(tmp_path):
    """The table that a script makes of files and settings, and its metadata."""

    def take(script, read, **settings):
        out = tmp_path / "table.parquet"
        given = {"epoch": EPOCH, "manoeuvres": MANOEUVRES, **settings}
        run(script, read, [str(out)], log=tmp_path / "log", **given)
        return read_table(out, read_kind(out)), read_metadata(out)

    return take


@pytest.fixture
def orientation(tmp_path):
    path = tmp_path / "orientation.parquet"
    write_table(path, environment()["earth_orientation"], "earth_orientation", metadata={})
    return str(path)


def fitted_to(tmp_path, orientation):
    """What a fit reads of the table that was taken."""
    read = files(tracking=str(tmp_path / "table.parquet"), earth_orientation=orientation)
    return fixes.read(read, list(stations().values()))


def test_tracks_know_the_manoeuvres_of_the_settings(taken, tmp_path, orientation):
    sheet = [asdict(station) for station in stations().values()]
    table, facts = taken("tracking_from_tdm", [str(EXCERPTS / "orekit.tdm")], stations=sheet)
    assert table["track"].nunique() > 10
    assert facts["manoeuvres"] == [{"t": HOUR + 0.5}, {"t": 2 * HOUR}]
    assert facts["object"] == {"name": "ISS", "designator": "", "number": 0}
    assert isinstance(fitted_to(tmp_path, orientation), Measured)


def test_tracks_know_the_object_that_their_participant_names(taken, tmp_path):
    text = (EXCERPTS / "orekit.tdm").read_text().replace("= ISS\n", "= 1998-067A\n")
    (tmp_path / "mine.tdm").write_text(text)
    sheet = [asdict(station) for station in stations().values()]
    _, facts = taken("tracking_from_tdm", [str(tmp_path / "mine.tdm")], stations=sheet)
    assert facts["object"] == {"name": "", "designator": "1998-067A", "number": 0}


def test_fixes_are_thinned_and_gathered_as_the_settings_say(taken, tmp_path, orientation, iss):
    orbit = kepler_orbit(iss, duration=DAY, step=60.0)
    segments = oem.segments_of(orbit, "truth", ObjectId("iss", "1998-067A"))
    oem.write(tmp_path / "iss.oem", segments, epoch=EPOCH)
    read = files(points=str(tmp_path / "iss.oem"), earth_orientation=orientation)
    fixing = {"sigma_m": [1.0, 2.0, 3.0], "every_s": 600.0, "stretch_hours": 2.0}
    table, facts = taken("fixes_from_files", read, duration_days=0.5, options=fixing)
    assert table.groupby("track").size().tolist() == [12] * 6 + [1]
    assert (table[["sigma_r", "sigma_s", "sigma_w"]].to_numpy() == fixing["sigma_m"]).all()
    measured = fitted_to(tmp_path, orientation)
    assert (measured.tracks, measured.numbers) == (7, 3)
    assert facts["object"] == {"name": "iss", "designator": "1998-067A", "number": 0}
    assert facts["manoeuvres"] == [{"t": HOUR + 0.5}, {"t": 2 * HOUR}]


def test_laser_ranges_know_their_stations_and_the_manoeuvres_of_the_settings(taken, tmp_path, orientation):
    laser_files.write(tmp_path)
    bodies = str(tmp_path / "ephemerides.parquet")
    write_table(bodies, environment()["ephemerides"], "ephemerides", metadata={})
    tables = {"earth_orientation": orientation, "ephemerides": bodies}
    sites = [str(tmp_path / f"{name}.snx") for name in ("coordinates", "eccentricities")]
    read = files(points=[str(tmp_path / "lageos.crd")], sites=sites, **tables)
    ranging = {"reflectors_m": 0.25, "sigma_m": 0.01, "without": [7119]}
    table, facts = taken("ranges_from_files", read, duration_days=1.0, options=ranging)
    assert table["station"].tolist() == ["7090", "7090"]
    one_way = 0.5 * np.array([0.0392, 0.0391]) * SPEED_OF_LIGHT
    np.testing.assert_allclose(table["range"], one_way + 0.25, rtol=1e-12)
    assert table["sigma_range"].tolist() == [0.01, 0.01]
    assert facts["manoeuvres"] == [{"t": HOUR + 0.5}, {"t": 2 * HOUR}]
    assert isinstance(fitted_to(tmp_path, orientation), LaserRanges)


@pytest.fixture
def fixed(tmp_path, iss):
    """Files of an orbit of three hours that was measured as fixes, and settings of fits to it."""
    field = gravity_field.read_icgem(gravity_field.resolve("EGM2008")).truncate(2, 2)
    metadata = {"gravity_field": gravity_field.metadata(field), "ephemerides": {"gm": GM}}
    orbit = truth.simulate(Propagator(force_model(2, ()), iss), duration=3 * HOUR, step=60.0)
    sigmas = dict(zip(FIX_SIGMAS, [10.0] * 3 + [np.nan] * 3, strict=True))
    begins = orbit[orbit["t"] % HOUR == 0.0].reset_index(drop=True)
    tables = environment(1.0) | {
        "gravity_field": gravity_field.table(field, EPOCH),
        "fixes": fixes.arcs(orbit.assign(**sigmas)),
        "starts": start_states.starts_table(begins["t"], begins[STATE].to_numpy(), known=0.0),
        "truth": orbit,
    }
    paths = {name: str(tmp_path / f"{name}.parquet") for name in tables}
    for name, table in tables.items():
        write_table(paths[name], table, name, metadata=metadata.get(name, {}))
    integrator = {"position_tolerance_m": 0.1, "min_step_s": 1e-3, "max_step_s": 90.0}
    settings = {
        "seed": 1,
        "stations": [],
        "integrator": integrator,
        "estimation": ESTIMATION.model_dump(exclude_none=True),
    }
    model = {"force_model": {"degree": 2, "order": 2, "third_bodies": []}, "rso": asdict(iss)}
    return paths, settings | model


@pytest.mark.parametrize(
    ("start", "axes"), [("starts", ["radial", "along track", "across track"]), ("truth", [])]
)
def test_estimates_tell_the_noise_of_what_was_measured_alone(taken, fixed, start, axes):
    paths, settings = fixed
    read = files(**paths, tracking=paths["fixes"], start=paths[start])
    estimates, facts = taken("estimation", read, **settings)
    assert estimates["converged"].all()
    assert [one["instrument"] for one in facts.get("instruments", [])] == axes
