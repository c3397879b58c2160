"""Fits that bear constant errors of stations, and what their residuals tell of each instrument."""

import logging

import numpy as np
import pandas as pd
import pytest
from support import BOUNDED_ESTIMATION as SETTINGS, environment

from opml.catalog.fit.biases import facts, read_noise, summary, whiten
from opml.catalog.fit.fixes import Fixes
from opml.catalog.fit.least_squares import Evaluation
from opml.tables import FIX_SIGMAS, STATE, write_table

BEARING = SETTINGS.evolve(bias_sigma=3.0)


@pytest.fixture(scope="module")
def biased(known_rows):
    """All stations 50 m too far, 0.05 degrees too far east and too low."""
    off = np.radians(0.05)
    rows = known_rows
    return rows.assign(
        range=rows["range"] + 50.0, azimuth=rows["azimuth"] + off, elevation=rows["elevation"] - off
    )


@pytest.fixture(scope="module")
def late(fits_to):
    """Estimates of several tracks."""

    def fitted(rows, settings=BEARING):
        found = fits_to(rows, settings)
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
    found = whiten(Evaluation(residuals, jacobian), instruments, sigma)
    n = found.jacobian.T @ found.jacobian
    np.testing.assert_allclose(np.linalg.solve(n, found.jacobian.T @ found.residuals), step, rtol=1e-10)
    np.testing.assert_allclose(np.linalg.inv(n), np.linalg.inv(normal)[:3, :3], rtol=1e-10)


def test_fits_bear_constant_errors(known_rows, biased, late):
    clean, borne = late(known_rows, SETTINGS), late(biased)
    assert borne["converged"].all()
    assert borne["off"].median() < 1.5 * clean["off"].median()
    assert late(biased, SETTINGS)["off"].median() > 3.0 * clean["off"].median()


def test_the_log_tells_the_noise_and_the_constant_errors(known_rows, biased, late, caplog):
    caplog.set_level(logging.INFO)
    late(known_rows, SETTINGS)
    late(biased)
    clean, off = (record.getMessage() for record in caplog.records if "residuals in sigmas" in record.msg)
    for message, mean in ((clean, 0.0), (off, 0.05 / 0.0154)):
        [line] = [line for line in message.splitlines() if "eglin azimuth" in line]
        assert float(line.split()[-1]) == pytest.approx(mean, abs=0.5)


def test_what_residuals_tell_of_an_instrument():
    found = summary(np.array(["a", "b", "a"]), np.array([3.0, 1.0, 5.0]), np.array([1.0, 2.0, 7.0]))
    assert found["instrument"].tolist() == ["a", "b"]
    assert found["numbers"].tolist() == [2, 1]
    np.testing.assert_allclose(found[["sigma", "rms", "mean"]], [[5.0, np.sqrt(17.0), 4.0], [2.0, 1.0, 1.0]])


def test_a_table_keeps_what_residuals_tell(tmp_path):
    noise = summary(np.array(["a", "b"]), np.array([3.0, 1.0]), np.array([1.0, 2.0]))
    for name, metadata in (("measured", facts(noise)), ("simulated", {})):
        write_table(
            tmp_path / name, environment()["earth_orientation"], "earth_orientation", metadata=metadata
        )
    pd.testing.assert_frame_equal(read_noise(tmp_path / "measured"), noise)
    assert read_noise(tmp_path / "simulated").empty


def test_positions_have_an_instrument_for_each_axis():
    points = pd.DataFrame({"t": [0.0, 60.0], "track": [0, 0]})
    points = points.assign(**dict.fromkeys(STATE, 7e6), **dict.fromkeys(FIX_SIGMAS[:3], 5.0))
    measured = Fixes(points.assign(**dict.fromkeys(FIX_SIGMAS[3:], np.nan)))
    assert measured.instruments(slice(0, 2)).tolist() == [0, 1, 2, 0, 1, 2]
    assert measured.instrument_names()[:3] == ["radial", "along track", "across track"]
    assert measured.deviations(slice(0, 2)).tolist() == [5.0] * 6
