"""Drag against cases worked by hand."""

import numba
import numpy as np
import pytest

from opml.base.constants import EARTH_RATE
from opml.dynamics.kernels.drag import drag
from opml.dynamics.kernels.lanes import WIDTH, load, splat, store

DENSITY, BALLISTIC = 3e-12, 0.11


@numba.njit(cache=True, error_model="numpy")
def _drag(state, spin, density, ballistic, out):
    x, y, z = load(state, 0), load(state, 1), load(state, 2)
    vx, vy, vz = load(state, 3), load(state, 4), load(state, 5)
    wx, wy, wz = spin
    ax, ay, az = drag(x, y, z, vx, vy, vz, (wx, wy, wz), splat(density), splat(ballistic))
    store(out, 0, ax)
    store(out, 1, ay)
    store(out, 2, az)


def acceleration(state, spin, density=DENSITY, ballistic=BALLISTIC):
    out = np.empty((3, WIDTH))
    _drag(
        np.repeat(np.array(state, float)[:, None], WIDTH, 1), tuple(map(float, spin)), density, ballistic, out
    )
    assert np.all(out == out[:, :1])
    return out[:, 0]


def test_without_spin_it_opposes_the_velocity():
    velocity = np.array([3000.0, -5000.0, 4000.0])
    found = acceleration([7e6, 0.0, 0.0, *velocity], (0.0, 0.0, 0.0))
    expected = -0.5 * DENSITY * BALLISTIC * np.linalg.norm(velocity) * velocity
    np.testing.assert_allclose(found, expected, rtol=1e-14)


def test_what_turns_with_the_earth_feels_none():
    spin, position = np.array([1e-6, -2e-6, EARTH_RATE]), np.array([3e6, -5e6, 4e6])
    carried = np.cross(spin, position)
    assert np.linalg.norm(acceleration([*position, *carried], spin)) < 1e-30
    ahead = acceleration([*position, *(carried + [10.0, 0.0, 0.0])], spin)
    np.testing.assert_allclose(ahead, [-0.5 * DENSITY * BALLISTIC * 100.0, 0.0, 0.0], rtol=1e-9, atol=1e-25)


def test_eastward_and_westward_orbits_differ_by_the_winds_speed():
    wind = EARTH_RATE * 7e6
    east = acceleration([7e6, 0.0, 0.0, 0.0, 7500.0, 0.0], (0.0, 0.0, EARTH_RATE))
    west = acceleration([7e6, 0.0, 0.0, 0.0, -7500.0, 0.0], (0.0, 0.0, EARTH_RATE))
    assert east[1] == pytest.approx(-0.5 * DENSITY * BALLISTIC * (7500.0 - wind) ** 2, rel=1e-14)
    assert west[1] == pytest.approx(0.5 * DENSITY * BALLISTIC * (7500.0 + wind) ** 2, rel=1e-14)
