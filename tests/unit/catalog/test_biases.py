"""Fits that bear constant errors of stations, and what their residuals tell of each instrument."""

import logging
from dataclasses import replace

import numpy as np
import pytest
from support import BOUNDED_ESTIMATION as SETTINGS

from opml.base.constants import DAY
from opml.catalog.fit import estimation, sightings, start_states
from opml.catalog.fit.biases import summary, whitened
from opml.catalog.fit.least_squares import Evaluation
from opml.catalog.flight import Flight
from opml.catalog.simulate import tracking, truth
from opml.tables import STATE

BEARING = replace(SETTINGS, bias_sigma=3.0)


@pytest.fixture(scope="module")
def flight(assumed_model, iss):
    return Flight(assumed_model, iss)


@pytest.fixture(scope="module")
def orbit(flight):
    return truth.simulate(flight, duration=DAY, step=20.0)


@pytest.fixture(scope="module")
def rows(orbit, earth_orientation, three_stations):
    return tracking.simulate(orbit, earth_orientation, three_stations, rso="iss", seed=1)


@pytest.fixture(scope="module")
def biased(rows):
    """All stations 50 m too far, 0.05 degrees too far east and too low."""
    off = np.radians(0.05)
    return rows.assign(
        range=rows["range"] + 50.0, azimuth=rows["azimuth"] + off, elevation=rows["elevation"] - off
    )


@pytest.fixture(scope="module")
def late(flight, orbit, earth_orientation, three_stations):
    """Estimates of several tracks, and how far [m] they are off."""

    def fitted(rows, settings=BEARING):
        starts = start_states.perturbed(orbit, rows, rso="iss", settings=settings, seed=42)
        measured = sightings.Measured(rows, earth_orientation, three_stations)
        found = estimation.estimate_all(flight, starts, measured, settings=settings)
        true = orbit.set_index("t").loc[found["t"], STATE[:3]].to_numpy()
        found = found.assign(off=np.linalg.norm(found[STATE[:3]].to_numpy() - true, axis=1))
        return found[found["tracks_used"] >= 3]

    return fitted


def test_a_constant_error_is_as_good_as_an_unknown():
    """Normal equations and gradient are those of a fit with one more unknown per instrument."""
    generator = np.random.default_rng(1)
    residuals, jacobian, sigma = generator.normal(size=20), generator.normal(size=(20, 3)), 2.5
    instruments = np.repeat([0, 2], [12, 8])
    each = (instruments[:, None] == [0, 2]).astype(float)
    whole = np.block([[jacobian, each], [np.zeros((2, 3)), np.eye(2) / sigma]])
    normal, gradient = whole.T @ whole, whole.T @ np.append(residuals, [0.0, 0.0])
    step = np.linalg.solve(normal, gradient)[:3]
    found = whitened(Evaluation(residuals, jacobian), instruments, sigma)
    n = found.jacobian.T @ found.jacobian
    np.testing.assert_allclose(np.linalg.solve(n, found.jacobian.T @ found.residuals), step, rtol=1e-10)
    np.testing.assert_allclose(np.linalg.inv(n), np.linalg.inv(normal)[:3, :3], rtol=1e-10)


def test_fits_bear_constant_errors(rows, biased, late):
    clean, borne = late(rows, SETTINGS), late(biased)
    assert borne["converged"].all()
    assert borne["off"].median() < 1.5 * clean["off"].median()
    assert late(biased, SETTINGS)["off"].median() > 3.0 * clean["off"].median()


def test_the_log_tells_the_noise_and_the_constant_errors(rows, biased, late, caplog):
    caplog.set_level(logging.INFO)
    late(rows, SETTINGS)
    late(biased)
    clean, off = (record.getMessage() for record in caplog.records if "residuals in sigmas" in record.msg)
    for message, mean in ((clean, 0.0), (off, 0.05 / 0.0154)):
        [line] = [line for line in message.splitlines() if "eglin azimuth" in line]
        assert float(line.split()[-1]) == pytest.approx(mean, abs=0.5)


def test_what_residuals_tell_of_an_instrument():
    found = summary(np.array(["a", "b", "a"]), np.array([3.0, 1.0, 5.0]))
    assert found["instrument"].tolist() == ["a", "b"]
    assert found["numbers"].tolist() == [2, 1]
    np.testing.assert_allclose(found[["rms", "mean"]], [[np.sqrt(17.0), 4.0], [1.0, 1.0]])
