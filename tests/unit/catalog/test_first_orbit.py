"""A first orbit without a truth: determined from tracks, or carried from a state; and fits from it."""

from dataclasses import replace

import numpy as np
import orbit_files
import pandas as pd
import pytest
from fits import distances
from support import BOUNDED_ESTIMATION as SETTINGS, EPOCH, kepler_orbit, refusal, rsos

from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.catalog.associate import quarantine
from opml.catalog.fit import start_states
from opml.catalog.fit.estimation import Run
from opml.catalog.fit.first import first_orbit
from opml.catalog.fit.observations import Measured
from opml.catalog.propagator import Propagator
from opml.catalog.simulate import tracking, truth
from opml.interop import first_state, oem
from opml.interop.object_ids import ObjectId
from opml.tables import STATE


@pytest.fixture(scope="module")
def orbit(truth_model, iss):
    """Two days of the paper's RSO under another model than the assumed one."""
    return truth.simulate(Propagator(truth_model, iss), duration=2 * DAY, step=20.0)


@pytest.fixture(scope="module")
def measured(rows, earth_orientation, three_stations):
    return Measured(rows, earth_orientation, three_stations)


@pytest.fixture(scope="module")
def starts(propagator, measured):
    return first_orbit.determined(propagator, measured, settings=SETTINGS)


@pytest.mark.parametrize("name", ["iss", "larets", "lageos1"])
def test_almost_every_single_track_gives_an_orbit(
    assumed_model, truth_model, earth_orientation, three_stations, name
):
    rso = rsos()[name]
    orbit = truth.simulate(Propagator(truth_model, rso), duration=DAY, step=20.0)
    rows = tracking.simulate(orbit, earth_orientation, three_stations, rso=name, seed=1)
    measured = Measured(rows, earth_orientation, three_stations)
    run = Run(measured, Propagator(assumed_model, rso), np.empty((0, 6)), np.empty(0), SETTINGS)
    found = first_orbit.single_tracks(run)
    assert len(found) >= 0.9 * rows["track"].nunique()
    true = orbit.set_index("t")[STATE]
    errors = np.array([one.fit.best[:6] - true.loc[run.measured.epochs[one.window.at]] for one in found])
    # As good as the perturbed truth that simulated fits start from: 1 km and 1 m/s in each axis.
    assert np.median(np.linalg.norm(errors[:, :3], axis=1)) < 1000.0
    assert np.median(np.linalg.norm(errors[:, 3:], axis=1)) < 1.5


def test_the_first_orbit_is_near_the_true_one_at_every_track(starts, rows, orbit):
    assert starts["track"].tolist() == sorted(rows["track"].unique())
    assert distances(starts, orbit).max() < 5e3


def test_fits_from_it_are_those_from_the_perturbed_truth(propagator, starts, measured, rows, orbit):
    with_truth = start_states.perturbed(orbit, rows, rso="iss", settings=SETTINGS, seed=1)
    ours, theirs = (
        quarantine.estimate_all(propagator, one, measured, settings=SETTINGS) for one in (starts, with_truth)
    )
    assert ours["converged"].all()
    assert theirs["converged"].all()
    many = ours["tracks_used"] >= 3
    assert np.abs(ours[STATE] - theirs[STATE])[many].to_numpy().max() < 0.01


def test_elements_are_carried_to_every_track(propagator, measured, orbit):
    table = first_orbit.starts_from_state(
        propagator, measured, first_orbit.of_sheet(propagator.rso, propagator.model.gm)
    )
    assert distances(table, orbit).max() < 50e3
    # From a state in the middle, forward and backward.
    middle = orbit[STATE].iloc[4320].to_numpy()
    table = first_orbit.starts_from_state(propagator, measured, (DAY, middle))
    assert distances(table, orbit).max() < 20e3
    assert distances(table[np.abs(table["t"] - DAY) < 20e3], orbit).max() < 2e3


def test_elements_that_are_not_known_are_none(assumed_model, iss):
    assert first_orbit.of_sheet(replace(iss, a=np.nan), assumed_model.gm) is None


def test_tracks_of_another_rso_are_told(propagator, measured):
    other = first_orbit.of_sheet(replace(propagator.rso, mean_anomaly=1.0), propagator.model.gm)
    with pytest.raises(
        InputError, match=r"iss: expected tracks near the orbit .*, got tracks that are \d+ km"
    ):
        first_orbit.starts_from_state(propagator, measured, other)


def test_tracks_that_give_no_orbit_are_told(propagator, rows, earth_orientation, three_stations):
    short = Measured(rows.groupby("track").head(2), earth_orientation, three_stations)
    with pytest.raises(InputError, match=r"iss: expected a track .* of two angles, 30 s long, with 5 ranges"):
        first_orbit.determined(propagator, short, settings=SETTINGS)


def test_the_perturbed_truth_depends_on_seed_and_track_only(rows, orbit):
    given = {"rso": "iss", "settings": SETTINGS, "seed": 1}
    whole = start_states.perturbed(orbit, rows, **given)
    part = start_states.perturbed(orbit, rows[rows["track"] < 4], **given)
    pd.testing.assert_frame_equal(part, whole.iloc[:4])
    other = start_states.perturbed(orbit, rows, **given | {"seed": 2})
    assert (other[STATE] != whole[STATE]).all(axis=None)
    assert 300.0 < np.median(distances(whole, orbit)) < 3000.0


LINES = (
    "1 25544U 98067A   16270.55892361  .00003421  00000-0  59245-4 0  9994",
    "2 25544  51.6447 263.7421 0006793 345.4559  14.5438 15.54019233 20745",
)


def test_a_state_is_read_from_mean_elements_at_the_time_asked_for(tmp_path):
    (tmp_path / "iss.tle").write_text("\n".join(LINES))
    t, state = first_state.read(tmp_path / "iss.tle", epoch=EPOCH, t=3600.0)
    assert t == 3600.0
    assert 6.7e6 < np.linalg.norm(state[:3]) < 6.9e6
    assert first_state.identity(tmp_path / "iss.tle") == ObjectId("", "1998-067A", 25544)
    assert "at most 30 days" in refusal(first_state.read, tmp_path / "iss.tle", epoch=EPOCH, t=40 * DAY)


def test_the_nearest_state_of_a_message_is_taken(orbit, tmp_path):
    part = orbit.iloc[::180]
    told = ObjectId("iss", "1998-067A")
    oem.write(tmp_path / "iss.oem", oem.segments_of(part, "truth", told), epoch=EPOCH)
    assert first_state.identity(tmp_path / "iss.oem") == told
    t, state = first_state.read(tmp_path / "iss.oem", epoch=EPOCH, t=4000.0)
    assert t == 3600.0
    assert state.tolist() == part[STATE].iloc[1].tolist()


def test_the_nearest_state_of_positions_is_taken(tmp_path, earth_orientation, iss):
    at = np.arange(0.0, 3601.0, 120.0)
    known = kepler_orbit(iss, duration=3600.0, step=120.0)[STATE].to_numpy()
    states = orbit_files.flown(orbit_files.attraction_of(earth_orientation), known[0], at)
    orbit_files.cpf(tmp_path / "iss.cpf", at, orbit_files.in_itrf(states, at, earth_orientation))
    first_state.identity(tmp_path / "iss.cpf")
    assert first_state.identity(tmp_path / "iss.cpf") == ObjectId("larets", number=27944)
    for t, nearest in ((3000.0, 25), (1e6, 30)):
        found, state = first_state.read(tmp_path / "iss.cpf", epoch=EPOCH, t=t)
        assert found == pytest.approx(at[nearest], abs=1e-3)
        np.testing.assert_allclose(state, states[nearest], atol=0.01)


@pytest.mark.parametrize("name", ["none.tle", "broken.oem", "broken.tle", "broken.cpf"])
def test_a_file_without_a_state_is_told(tmp_path, name):
    (tmp_path / "broken.cpf").write_text("H1 CPF  1  SGF 2016  2 13  2  5441 lageos2\nH9\n")
    (tmp_path / "broken.oem").write_text("CCSDS_OEM_VERS = 2.0\nORIGINATOR\n")
    (tmp_path / "broken.tle").write_text(LINES[0][:-1] + "5\n" + LINES[1])
    with pytest.raises(InputError, match=name):
        first_state.identity(tmp_path / name)
