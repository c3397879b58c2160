"""Neighbours of arcs in a large gravity field: under its first degrees they part as under all of it."""

import numpy as np
import pytest
from support import BOUNDED_ESTIMATION, force_model, precise_model

from opml.base.constants import DAY
from opml.catalog import propagator as propagators
from opml.catalog.associate import quarantine
from opml.catalog.fit import iterations as iterations_of_fits, observations, start_states
from opml.catalog.predict import prediction, sensitivity
from opml.catalog.propagator import Propagator, neighbour_paths
from opml.catalog.simulate import tracking, truth
from opml.tables import PARAMETERS, STATE

SIGMAS = [f"cov_{name}_{name}" for name in PARAMETERS]


@pytest.fixture(scope="module")
def propagator(iss):
    """The paper's RSO in a field that is large."""
    return Propagator(force_model(28), iss)


@pytest.fixture(scope="module")
def orbit(propagator):
    """Two days of it."""
    return truth.simulate(propagator, duration=2 * DAY, step=20.0)


@pytest.fixture(scope="module")
def fit(propagator, orbit, earth_orientation, three_stations):
    """How its estimates are made."""
    rows = tracking.simulate(orbit, earth_orientation, three_stations, rso="iss", seed=1)
    starts = start_states.perturbed(orbit, rows, rso="iss", settings=BOUNDED_ESTIMATION, seed=42)
    measured = observations.Measured(rows, earth_orientation, three_stations)

    return lambda: quarantine.estimate_all(propagator, starts, measured, settings=BOUNDED_ESTIMATION)


@pytest.fixture(scope="module")
def estimates(fit):
    return fit()


@pytest.fixture
def whole_field(monkeypatch):
    """Have neighbours fly under the whole field."""
    return lambda: monkeypatch.setattr(propagators, "_LARGE", 1000)


@pytest.mark.parametrize("model", [force_model, precise_model])
def test_a_part_of_a_field_is_the_field_to_that_degree_with_its_tides(model):
    part, field = model(28).truncated(8), model(8)
    assert (part.columns, part.degree) == (field.columns, field.degree)
    np.testing.assert_array_equal(part.weights, field.weights)
    for mine, same in zip(part.tides, field.tides, strict=True):
        np.testing.assert_array_equal(mine, same)
    assert field.truncated(8) is field


def test_a_small_field_is_that_of_the_neighbours_too(iss):
    propagator = Propagator(force_model(20), iss)
    assert propagator.for_neighbours() is propagator


def test_fits_come_to_the_same_answer(estimates, fit, whole_field):
    whole_field()
    expected = fit()
    sigmas = np.sqrt(expected[SIGMAS].to_numpy())
    assert not np.array_equal(estimates[PARAMETERS], expected[PARAMETERS])
    assert np.abs((estimates[PARAMETERS] - expected[PARAMETERS]).to_numpy() / sigmas).max() < 0.01
    np.testing.assert_allclose(estimates[SIGMAS], expected[SIGMAS], rtol=0.01)


def test_the_first_trial_of_a_fit_alone_flies_under_the_whole_field(fit, monkeypatch):
    counts = []
    fly = Propagator.propagate

    def counted(propagator, epochs, states, **arguments):
        if propagator.model.degree > 20 and epochs[0] > epochs[-1]:
            counts.append(len(states))
        return fly(propagator, epochs, states, **arguments)

    monkeypatch.setattr(Propagator, "propagate", counted)
    estimates = fit()
    iterations = estimates["iterations"].sum()
    assert estimates["converged"].all()
    assert len(estimates) <= sum(counts) < 0.7 * iterations
    counts.clear()
    monkeypatch.setattr(iterations_of_fits, "NEAR", -1.0)
    every = fit()
    assert sum(counts) >= every["iterations"].sum()
    sigmas = np.sqrt(every[SIGMAS].to_numpy())
    assert np.abs((estimates[PARAMETERS] - every[PARAMETERS]).to_numpy() / sigmas).max() < 0.01


@pytest.mark.parametrize(
    ("ahead", "faster", "part"), [(0.0, 0.01, 3e-4), (0.0, -0.3, 3e-4), (300.0, 0.0, 3e-3)]
)
def test_an_arc_beside_another_is_where_it_would_have_flown(propagator, iss, ahead, faster, part):
    """Two days: one as fast as the other but ahead [m], others faster [m/s]."""
    start = np.array([6.8e6, 0.0, 0.0, 0.0, 4.7e3, 6.0e3])
    angle = ahead / 6.8e6
    turned = np.cos(angle) * start[:3] + np.sin(angle) * 6.8e6 * start[3:] / np.linalg.norm(start[3:])
    other = np.concatenate([turned, np.cos(angle) * start[3:] - np.sin(angle) * start[:3] / 6.8e6 * 7622.0])
    other[3:] *= 1.0 + faster / 7622.0
    epochs = np.arange(0.0, 2 * DAY + 1.0, 300.0)
    states, ends = np.array([start, other]), {"first": [0, 0], "last": [len(epochs) - 1] * 2}
    whole, near = (
        one.propagate(epochs, states, cd=2.2, **ends).states.reshape(2, -1, 6)
        for one in (propagator, propagator.for_neighbours())
    )
    [found] = neighbour_paths(whole[0], near[0], near[1][None])
    distance, off = (np.linalg.norm((one - whole[1])[:, :3], axis=1) for one in (whole[0], found))
    assert distance.max() > 250.0
    assert 0.0 < off.max() < part * distance.max()


def test_sensitivities_are_the_same_but_for_a_part_of_a_percent(propagator, orbit, estimates, whole_field):
    predictions = prediction.predict_all(propagator, orbit, estimates, max_days=2.0)
    near = sensitivity.sensitivities(propagator, estimates, predictions)
    whole_field()
    whole = sensitivity.sensitivities(propagator, estimates, predictions)
    for name in (f"{family}_{axis}" for family in "sv" for axis in STATE):
        assert np.abs(near[name] - whole[name]).max() < 0.01 * np.abs(whole[name]).max(), name
