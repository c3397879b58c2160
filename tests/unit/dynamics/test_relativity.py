"""General relativity against eq. 10.12 of the IERS Conventions 2010 as it stands there, in vectors."""

import numba
import numpy as np
import pytest
from support import environment, in_rows, precise_model

from opml.base.constants import GM, SPEED_OF_LIGHT
from opml.dynamics.kernels.lanes import load, sqrt, store
from opml.dynamics.kernels.relativity import relativity

EARTH = 3.986004415e14
AXIS = np.array([0.0016, -0.0003, np.sqrt(1.0 - 0.0016**2 - 0.0003**2)])
ARCSECOND = np.pi / 648000.0


@numba.njit(cache=True, error_model="numpy")
def _relativity(states, gm, axis, precession, out):
    for row in range(states.shape[1]):
        x, y, z = load(states[0], row), load(states[1], row), load(states[2], row)
        vx, vy, vz = load(states[3], row), load(states[4], row), load(states[5], row)
        inverse_r = 1.0 / sqrt(x * x + y * y + z * z)
        ax, ay, az = relativity(x, y, z, vx, vy, vz, inverse_r, gm, axis, precession)
        store(out[0], row, ax)
        store(out[1], row, ay)
        store(out[2], row, az)


def acceleration(states, precession):
    rows = np.array([in_rows(column) for column in states.T])
    out = np.empty((3, *rows.shape[1:]))
    _relativity(rows, EARTH, AXIS, np.asarray(precession, float), out)
    return out.reshape(3, -1)[:, : len(states)].T


@pytest.fixture(scope="module")
def states():
    rng = np.random.default_rng(3)
    positions, velocities = rng.normal(size=(2, 20, 3))
    positions *= np.linspace(6.6e6, 4.2e7, 20)[:, None] / np.linalg.norm(positions, axis=1, keepdims=True)
    return np.hstack([positions, 4000.0 * velocities])


def test_the_sum_is_that_of_the_conventions(states):
    sun, motion = np.array([-1.49e11, -1.3e10, -5.8e9]), np.array([2.9e3, -2.7e4, -1.18e4])
    r, v = states[:, :3], states[:, 3:]
    distance = np.linalg.norm(r, axis=1, keepdims=True)
    speed2, radial = (v**2).sum(axis=1, keepdims=True), (r * v).sum(axis=1, keepdims=True)
    spin = 9.8e8 * AXIS
    mass = EARTH / distance**3 * ((4 * EARTH / distance - speed2) * r + 4 * radial * v)
    upwards = (r @ spin)[:, None]
    rotation = 2 * EARTH / distance**3 * (3 / distance**2 * np.cross(r, v) * upwards + np.cross(v, spin))
    turn = 3 * np.cross(motion, -GM["sun"] * -sun / np.linalg.norm(sun) ** 3) / SPEED_OF_LIGHT**2
    expected = (mass + rotation) / SPEED_OF_LIGHT**2 + np.cross(turn, v)
    np.testing.assert_allclose(acceleration(states, turn), expected, rtol=1e-11, atol=1e-24)


def test_velocities_turn_at_twice_the_geodesic_precession():
    turn = precise_model(8).columns_of_added
    # 1.9198 arcseconds a century about the pole of the ecliptic (IERS Conventions 2010, sec. 10.1), with the
    # Earth's distance in autumn and winter.
    rate = np.linalg.norm(turn, axis=1) / 2 * 36525 * 86400 / ARCSECOND
    assert rate.mean() == pytest.approx(1.9198, rel=0.04)
    obliquity = np.radians(23.4393)
    pole = np.array([0.0, -np.sin(obliquity), np.cos(obliquity)])
    assert np.all((turn / np.linalg.norm(turn, axis=1, keepdims=True)) @ pole > 1.0 - 1e-6)
    assert len(turn) == len(environment()["ephemerides"])
