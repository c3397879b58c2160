"""The true orbit of an RSO."""

from dataclasses import replace

import numpy as np
import pytest
from support import rsos

from opml.base.constants import DAY, HOUR, WGS84_A
from opml.base.errors import InputError
from opml.catalog.propagator import Propagator
from opml.catalog.simulate import truth
from opml.orbits.elements import coe_from_cartesian
from opml.tables import STATE

GM = 3.986004415e14


def test_initial_state_is_orekits(iss):
    # Orekit 13.1.9, KeplerianOrbit in GCRF with the paper's elements and this GM (reference/README.md).
    expected = [-866812.2, -6682745.0, -5589.65, 4750.004, -607.9389, 6050.417]
    np.testing.assert_allclose(truth.initial_state(iss, GM), expected, rtol=3e-7)


@pytest.mark.parametrize("name", ["iss", "swarma", "lageos1"])
def test_initial_state_has_the_sheets_elements(name):
    rso = rsos()[name]
    a, e, i, argp, raan, nu = coe_from_cartesian(truth.initial_state(rso, GM), GM)
    assert a == pytest.approx(rso.a, rel=1e-12)
    assert (e, i) == (pytest.approx(rso.e, abs=1e-12), pytest.approx(rso.i, abs=1e-12))
    # The angles wear the eccentricity's smallness.
    assert (argp, raan) == (pytest.approx(rso.argp, abs=1e-9), pytest.approx(rso.raan, abs=1e-12))
    eccentric = 2.0 * np.arctan(np.sqrt((1.0 - e) / (1.0 + e)) * np.tan(nu / 2.0))
    difference = eccentric - e * np.sin(eccentric) - rso.mean_anomaly
    assert np.abs(np.sin(0.5 * difference)) < 1e-9


def test_states_on_the_whole_grid(truth_model, iss):
    table = truth.simulate(Propagator(truth_model, iss), duration=HOUR, step=20.0)
    assert list(table.columns) == ["t", *STATE]
    np.testing.assert_array_equal(table["t"], np.arange(181) * 20.0)
    np.testing.assert_array_equal(table[STATE].iloc[0], truth.initial_state(iss, truth_model.gm))
    # Where the speed is the rate of the place, the columns are in order and in step with t.
    states = table[STATE].to_numpy()
    rate = (states[2:, :3] - states[:-2, :3]) / 40.0
    assert np.abs(rate - states[1:-1, 3:]).max() < 1.0


@pytest.mark.parametrize("step", [20.0, 7.0])
def test_states_between_the_integrated_ones_are_those_that_every_epoch_would_give(truth_model, iss, step):
    propagator = Propagator(truth_model, iss)
    table = truth.simulate(propagator, duration=4 * HOUR, step=step)
    start = table[STATE].to_numpy()[:1]
    arcs = propagator.propagate(table["t"], start, cd=iss.cd, first=[0], last=[len(table) - 1])
    off = np.abs(table[STATE].to_numpy()[1:] - arcs.path(0)).max(axis=0)
    assert off[:3].max() < 2e-4
    assert off[3:].max() < 2e-6


def test_drag_and_radiation_pressure_are_the_rsos_own(truth_model, iss):
    def end(rso):
        table = truth.simulate(Propagator(truth_model, rso), duration=6000.0, step=3000.0)
        return table[STATE].to_numpy()[-1]

    assert (
        np.linalg.norm((end(replace(iss, cd=4.4)) - end(replace(iss, area_to_mass=0.1, cr=0.625)))[:3]) == 0.0
    )
    assert np.linalg.norm((end(replace(iss, cr=0.0)) - end(iss))[:3]) > 0.1
    assert np.linalg.norm((end(replace(iss, cd=0.0)) - end(iss))[:3]) > 10.0


def test_an_rso_that_comes_down_is_an_input_error(truth_model, iss):
    low = replace(iss, name="iss_a-200", a=WGS84_A + 170e3, e=0.001)
    with pytest.raises(
        InputError, match=r"iss_a-200: .* lasts 2 days, but it decayed below 120 km after 0\.\d\d"
    ) as error:
        truth.simulate(Propagator(truth_model, low), duration=2 * DAY, step=20.0)
    assert "\n" not in str(error.value)


def test_orbits_that_fly_together_are_those_that_fly_alone(truth_model, iss):
    grid = {"duration": HOUR, "step": 600.0}
    others = [rsos()[name] for name in ("swarma", "lageos1")]
    together = truth.simulate_together(Propagator(truth_model, iss), others, **grid)
    for rso, table in zip([iss, *others], together, strict=True):
        alone = truth.simulate(Propagator(truth_model, rso), **grid)
        assert table.to_numpy().tobytes() == alone.to_numpy().tobytes()


def test_a_truth_is_known_between_the_epochs_of_its_grid_but_in_no_gap(truth_model, iss):
    flown = truth.simulate(Propagator(truth_model, iss), duration=600.0, step=10.0)
    coarse = flown[::2].reset_index(drop=True)
    t = flown["t"].to_numpy()
    off = truth.interpolate(coarse, t) - flown[STATE].to_numpy()
    assert np.linalg.norm(off[:, :3], axis=1).max() < 6e-3
    assert np.linalg.norm(off[:, 3:], axis=1).max() < 2e-3
    gappy = coarse[(coarse["t"] < 200.0) | (coarse["t"] > 300.0)]
    assert np.isnan(truth.interpolate(gappy, np.array([-1.0, 250.0, 601.0]))).all()
    assert np.isfinite(truth.interpolate(gappy, np.array([0.0, 175.0, 330.0, 600.0]))).all()
