"""What depends on time alone, looked up between the nodes of a force model."""

import erfa
import numba
import numpy as np
import pytest
from support import EPOCH, environment, force_model

from opml.base import epochs
from opml.base.constants import BODIES as NAMES, DAY, EARTH_RATE
from opml.dynamics.kernels import dtm2000, surroundings
from opml.dynamics.kernels.lanes import WIDTH
from opml.dynamics.kernels.surroundings import BODIES, ROTATION, SPIN, SUN_ITRF, TIDE
from opml.environment import celestial_bodies, earth_orientation, solar_activity

TIMES = [0.0, 1.0, 3599.9, DAY * 3 + 1234.5, DAY * 17 + 0.25, DAY * 49.99]


@numba.njit(cache=True, error_model="numpy")
def _look_up(t, model, values, factors):
    surroundings.look_up(t, model, values, factors)


@numba.njit(cache=True, error_model="numpy")
def _earth_rotation(x, y, s, x_pole, y_pole, angle, values):
    surroundings.earth_rotation(x, y, s, x_pole, y_pole, angle, values)


@numba.njit(cache=True, error_model="numpy")
def _reduce(a, season, f107, f107_mean, kp_3h, kp_24h, factors):
    dtm2000.reduce_to_date(a, season, f107, f107_mean, kp_3h, kp_24h, factors)


def looked_up(t, model):
    """(rotation (3, 3), spin (3,), Sun in ITRF (3,), bodies (n, 3), DTM2000's factors) at t [s]."""
    values = np.full(BODIES + model.bodies.shape[1], np.nan)
    factors = np.full((dtm2000.FACTORS, WIDTH), np.nan)
    _look_up(t, model, values, factors)
    rotation = values[ROTATION : ROTATION + 9].reshape(3, 3)
    return rotation, values[SPIN:SUN_ITRF], values[SUN_ITRF:TIDE], values[BODIES:].reshape(-1, 3), factors


@pytest.fixture(scope="module")
def model():
    return force_model(8)


@pytest.mark.parametrize("exaggerated", [1.0, 1e4])
def test_rotation_is_erfas_from_the_same_angles(exaggerated):
    rng = np.random.default_rng(1)
    for _ in range(20):
        x, y, s, x_pole, y_pole = rng.normal(size=5) * np.array([2e-3, 3e-5, 1e-8, 1e-6, 2e-6])
        y, s, x_pole, y_pole = exaggerated * np.array([y, s, x_pole, y_pole])
        angle = rng.uniform(-10.0, 300.0)
        values = np.empty(9)
        _earth_rotation(x, y, s, x_pole, y_pole, angle, values)
        expected = erfa.c2tcio(erfa.c2ixys(x, y, s), angle, erfa.pom00(x_pole, y_pole, 0.0))
        rotation = values.reshape(3, 3)
        np.testing.assert_allclose(rotation, expected, rtol=0.0, atol=5e-13)
        np.testing.assert_allclose(rotation @ rotation.T, np.eye(3), rtol=0.0, atol=2e-15)
        assert np.linalg.det(rotation) == pytest.approx(1.0, abs=1e-14)


@pytest.mark.parametrize("t", TIMES)
def test_rotation_between_the_nodes_is_erfas_at_that_time(model, t):
    row = earth_orientation.tabulate(EPOCH, np.array([t])).iloc[0]
    tt = epochs.tt(EPOCH, np.array([t]))
    celestial = erfa.c2ixys(row.x_cip, row.y_cip, row.s_cio)
    tio = erfa.sp00(tt[0][0], tt[1][0])
    expected = erfa.c2tcio(
        celestial, row.era_offset + EARTH_RATE * t, erfa.pom00(row.x_pole, row.y_pole, tio)
    )
    # Left out is s', 4e-11 rad.
    assert np.abs(looked_up(t, model)[0] - expected).max() < 1e-10


def test_spin_is_the_rate_of_the_rotation(model):
    t, h = DAY * 8 + 777.0, 30.0
    before, now, after = (looked_up(t + dt, model)[0] for dt in (-h, 0.0, h))
    # dR/dt = -R [w x], and the difference over a step is sin(w h) / h of it.
    product = now.T @ (before - after) / (2.0 * np.sin(EARTH_RATE * h) / EARTH_RATE)
    rate = np.array([product[2, 1], product[0, 2], product[1, 0]])
    np.testing.assert_allclose(rate, looked_up(t, model)[1], rtol=0.0, atol=2e-13)


@pytest.mark.parametrize("t", TIMES)
def test_bodies_between_the_nodes_are_the_ephemerides(model, t):
    row = celestial_bodies.tabulate(EPOCH, np.array([t])).iloc[0]
    expected = np.array([[row[f"{name}_{axis}"] for axis in "xyz"] for name in NAMES])
    rotation, _, sun_itrf, bodies, _ = looked_up(t, model)
    error = np.linalg.norm(bodies - expected, axis=1)
    assert error[NAMES.index("moon")] < 1e-4
    assert np.all(error < 1e-2)
    np.testing.assert_allclose(sun_itrf, rotation @ expected[0], rtol=0.0, atol=1e-2)


@pytest.mark.parametrize("t", [*TIMES, 42614.9, 42615.1, 42615.0 + DAY * 20 - 0.1, 42615.0 + DAY * 20 + 0.1])
def test_thermosphere_is_that_of_the_day_and_its_activity(model, t):
    # The epoch's day, the 272nd of 2016, ends 42 615 s after 12:09:45.
    day = 272 + int(np.floor((t + DAY - 42615.0) / DAY))
    row = solar_activity.tabulate("MSAFE", EPOCH, np.array([t]), 50).iloc[0]
    season = np.ascontiguousarray(dtm2000.seasons(model.thermosphere, [day])[0])
    expected = np.empty((dtm2000.FACTORS, WIDTH))
    _reduce(model.thermosphere, season, row.f107, row.f107_mean, row.kp_3h, row.kp_24h, expected)
    factors = looked_up(t, model)[4]
    # Kp is not quite linear in time; seasons change by more than this from one day to the next.
    scale = np.abs(expected).max(axis=0)
    assert np.all(np.abs(factors - expected) <= 1e-8 * scale)
    other = np.ascontiguousarray(dtm2000.seasons(model.thermosphere, [day + 1])[0])
    _reduce(model.thermosphere, other, row.f107, row.f107_mean, row.kp_3h, row.kp_24h, expected)
    assert not np.all(np.abs(factors - expected) <= 1e-8 * scale)


def test_bodies_that_do_not_pull_have_no_gm_but_the_sun_is_always_there():
    model = force_model(8, ("moon", "jupiter"))
    assert model.gms.shape == (3,)
    assert model.gms[0] == 0.0
    assert np.all(model.gms[1:] > 0.0)
    sun = environment()["ephemerides"][["sun_x", "sun_y", "sun_z"]].to_numpy()
    np.testing.assert_array_equal(model.bodies[:, :3], sun)


@pytest.mark.parametrize("way", [1, -1])
def test_jumps_are_on_both_sides_of_each_midnight_between(model, way):
    midnight = model.midnight + DAY
    begin, end = (midnight - 1.0, midnight + 2.0 * DAY + 1.0)[::way]
    around = model.jumps(begin, end)
    days = (around - model.midnight) / DAY
    assert np.floor(days).tolist() == [0, 1, 1, 2, 2, 3]
    assert np.abs(days - np.round(days)).max() < 1e-8
    assert model.jumps(midnight + 1.0, midnight + DAY - 1.0).size == 0
    # A span that begins or ends at midnight itself has the side that lies in it.
    assert np.floor((model.jumps(midnight, midnight + 60.0) - model.midnight) / DAY).tolist() == [1]
    assert model.jumps(midnight, midnight).size == 0
