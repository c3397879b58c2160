"""Predictions and their true errors, where both can be written down."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from opml.base.constants import DAY
from opml.catalog.predict import prediction
from opml.catalog.propagator import Propagator
from opml.orbits.elements import cartesian_from_coe
from opml.tables import COMPONENTS, STATE

RADIUS, INCLINATION = 7.5e6, 1.1
TIMES = np.array([0.0, 0.2, 1.0, 6.99, 7.0, 7.2, 8.5]) * DAY


def circular(t, gm, *, ahead=0.0, radius=RADIUS, node=0.7):
    """States (n, 6) on a circular orbit, `ahead` [rad] of its own clock."""
    coe = np.zeros((len(t), 6))
    coe[:, 0], coe[:, 2], coe[:, 4] = radius, INCLINATION, node
    coe[:, 5] = np.sqrt(gm / radius**3) * t + ahead
    return cartesian_from_coe(coe, gm)


def table(t, states, **columns):
    return pd.DataFrame({"t": t, **dict(zip(STATE, states.T, strict=True)), **columns})


@pytest.fixture
def free(iss):
    """An RSO that feels neither drag (by Cd 0 of its estimates) nor radiation pressure."""
    return replace(iss, cr=0.0)


def predicted(model, rso, estimates, *, cd=0.0, max_days=7, track=None):
    truth = table(TIMES, circular(TIMES, model.gm))
    rows = table(TIMES, estimates, cd=cd, track=np.arange(len(TIMES)) if track is None else track)
    return prediction.predict_all(Propagator(model, rso), truth, rows, max_days=max_days)


def test_pairs_reach_to_seven_days_and_no_further(kepler_model, free):
    found = predicted(kepler_model, free, circular(TIMES, kepler_model.gm), track=10 + np.arange(7))
    pairs = [(a, b) for a in range(7) for b in range(a + 1, 7) if TIMES[b] - TIMES[a] <= 7 * DAY]
    assert (0, 4) in pairs
    assert (0, 5) not in pairs
    assert list(zip(found["i"] - 10, found["j"] - 10, strict=True)) == pairs
    np.testing.assert_array_equal(found["t_i"], [TIMES[a] for a, _ in pairs])
    np.testing.assert_array_equal(found["t_j"], [TIMES[b] for _, b in pairs])
    shorter = predicted(kepler_model, free, circular(TIMES, kepler_model.gm), max_days=0.5)
    assert list(zip(shorter["i"], shorter["j"], strict=True)) == [(0, 1), (3, 4), (3, 5), (4, 5)]


def test_a_perfect_estimate_under_the_true_forces_has_no_error(kepler_model, free):
    found = predicted(kepler_model, free, circular(TIMES, kepler_model.gm))
    assert np.abs(found[["e_x", "e_y", "e_z"]]).to_numpy().max() < 1e-2
    assert np.abs(found[["e_vx", "e_vy", "e_vz"]]).to_numpy().max() < 1e-5
    assert (found["reason"] == "").all()


def test_an_estimate_ahead_errs_along_the_track(kepler_model, free):
    ahead = 1e-3
    found = predicted(kepler_model, free, circular(TIMES, kepler_model.gm, ahead=ahead))
    speed = np.sqrt(kepler_model.gm / RADIUS)
    expected = {
        "e_x": RADIUS * (np.cos(ahead) - 1.0),
        "e_y": RADIUS * np.sin(ahead),
        "e_z": 0.0,
        "e_vx": -speed * np.sin(ahead),
        "e_vy": speed * (np.cos(ahead) - 1.0),
        "e_vz": 0.0,
    }
    for name, value in expected.items():
        np.testing.assert_allclose(found[name], value, rtol=1e-5, atol=1e-2 if "v" not in name else 1e-5)


def test_an_estimate_in_another_plane_errs_across_it(kepler_model, free):
    turn = 1e-4
    found = predicted(kepler_model, free, circular(TIMES, kepler_model.gm, node=0.7 + turn))
    u = np.sqrt(kepler_model.gm / RADIUS**3) * found["t_j"]
    np.testing.assert_allclose(found["e_z"], -RADIUS * turn * np.sin(INCLINATION) * np.cos(u), atol=0.1)
    np.testing.assert_allclose(found["e_y"], RADIUS * turn * np.cos(INCLINATION), atol=0.1)


def test_errors_are_the_difference_turned_into_the_true_states_frame(kepler_model, free):
    found = predicted(kepler_model, free, circular(TIMES, kepler_model.gm, ahead=0.01, node=0.71))
    truth = circular(found["t_j"].to_numpy(), kepler_model.gm)
    true = found[[f"{name}_true" for name in STATE]].to_numpy()
    np.testing.assert_allclose(true, truth, rtol=1e-12)
    for names, part in ((STATE[:3], slice(0, 3)), (STATE[3:], slice(3, 6))):
        difference = found[names].to_numpy() - true[:, part]
        errors = found[[f"e_{name}" for name in names]].to_numpy()
        np.testing.assert_allclose(
            np.linalg.norm(errors, axis=1), np.linalg.norm(difference, axis=1), rtol=1e-9
        )
        radial = np.sum(difference * true[:, :3], axis=1) / np.linalg.norm(true[:, :3], axis=1)
        np.testing.assert_allclose(errors[:, 0], radial, rtol=0.0, atol=1e-6)


def test_a_pair_that_the_arc_does_not_reach_has_its_reason_and_no_numbers(kepler_model, free):
    estimates = circular(TIMES, kepler_model.gm)
    cd = np.zeros(len(TIMES))
    low = circular(TIMES[1:2], kepler_model.gm, radius=6.378137e6 + 190e3)
    estimates[1], cd[1] = low[0], 60.0
    found = predicted(kepler_model, free, estimates, cd=cd)
    lost = found["i"] == 1
    numbers = [*STATE, *COMPONENTS]
    assert (found["reason"][lost] == "decayed below 120 km").all()
    assert found.loc[lost, numbers].isna().all(axis=None)
    assert (found["reason"][~lost] == "").all()
    assert np.isfinite(found.loc[~lost, numbers].to_numpy()).all()
    assert np.isfinite(found[[f"{name}_true" for name in STATE]].to_numpy()).all()
    # The others are what they are without it.
    alone = predicted(kepler_model, free, circular(TIMES, kepler_model.gm))
    pd.testing.assert_frame_equal(found[~lost], alone[~lost], check_exact=True)


def test_an_arc_that_decays_on_the_way_keeps_the_pairs_before(kepler_model, free):
    estimates = circular(TIMES, kepler_model.gm)
    estimates[0] = circular(TIMES[:1], kepler_model.gm, radius=6.378137e6 + 250e3)[0]
    found = predicted(kepler_model, free, estimates, cd=np.where(TIMES == 0.0, 15.0, 0.0))
    own = found[found["i"] == 0]
    assert own["reason"].tolist() == ["", *["decayed below 120 km"] * 3]
    assert np.isfinite(own["e_y"].iloc[0])
    assert own["e_y"].iloc[1:].isna().all()


def test_threads_change_nothing(assumed_model, iss):
    t = np.linspace(0.0, 2 * DAY, 40)
    estimates = table(t, circular(t, assumed_model.gm), cd=2.2, track=np.arange(40))
    truth = table(t, circular(t, assumed_model.gm))
    one, two = (
        prediction.predict_all(Propagator(assumed_model, iss, threads=n), truth, estimates, max_days=0.5)
        for n in (1, 2)
    )
    pd.testing.assert_frame_equal(one, two, check_exact=True)
    # Cd and Cr are those of the estimate and of the RSO.
    propagator = Propagator(assumed_model, iss)
    draggier = prediction.predict_all(propagator, truth, estimates.assign(cd=22.0), max_days=0.5)
    assert np.abs(draggier["e_y"] - one["e_y"]).max() > 10.0
