"""The gravity kernel against the gradient of a potential that is summed in another way."""

import math

import numba
import numpy as np
import pytest
from numpy.polynomial import Legendre
from support import in_rows

from opml.dynamics.kernels.gravity import gravity, weights
from opml.dynamics.kernels.lanes import load, sqrt, store
from opml.environment import gravity_field

GM, RADIUS = 3.986004415e14, 6378136.3


@numba.njit(cache=True, error_model="numpy")
def _gravity(x, y, z, table, columns, degree, gm, radius, out):
    for row in range(x.shape[0]):
        px, py, pz = load(x, row), load(y, row), load(z, row)
        r2 = px * px + py * py + pz * pz
        ax, ay, az = gravity(px, py, pz, 1.0 / sqrt(r2), table, columns, degree, gm, radius)
        store(out[0], row, ax)
        store(out[1], row, ay)
        store(out[2], row, az)


def acceleration(positions, c, s):
    """The kernel's acceleration (n, 3) at positions (n, 3) under coefficients (degree + 1, order + 1)."""
    rows = [in_rows(positions[:, k]) for k in range(3)]
    out = np.empty((3, *rows[0].shape))
    _gravity(*rows, weights(c, s), c.shape[1] + 1, c.shape[0], GM, RADIUS, out)
    return out.reshape(3, -1)[:, : len(positions)].T


def potential(x, y, z, c, s):
    """Potential without the central term, analytic in x, y and z so that they may be complex.

    The definition (Heiskanen & Moritz 1967, sec. 1-14): derivatives of Legendre polynomials, each
    with its norm; cos(m lon) and sin(m lon) times cos(lat)^m are polynomials of x/r and y/r.
    """
    r = (x * x + y * y + z * z) ** 0.5
    u, total = z / r, 0.0
    for n in range(1, c.shape[0]):
        across, up = 1.0, 0.0
        for m in range(min(n, c.shape[1] - 1) + 1):
            norm = math.sqrt(
                (1 if m == 0 else 2) * (2 * n + 1) * math.factorial(n - m) / math.factorial(n + m)
            )
            legendre = Legendre.basis(n).deriv(m)(u)
            total = total + (RADIUS / r) ** n * norm * legendre * (c[n, m] * across + s[n, m] * up)
            across, up = (x * across - y * up) / r, (x * up + y * across) / r
    return GM / r * total


def gradient(position, c, s):
    """Gradient (3,) of the potential by complex steps, which lose nothing to differences."""
    step = 1e-30
    stepped = position + 1j * step * np.eye(3)
    return np.array([potential(*row, c, s).imag / step for row in stepped])


def random_field(degree, order, seed):
    rng = np.random.default_rng(seed)
    c, s = rng.normal(size=(2, degree + 1, order + 1)) * 1e-3
    below = np.tri(degree + 1, order + 1, dtype=bool)
    c, s = np.where(below, c, 0.0), np.where(below, s, 0.0)
    s[:, 0] = 0.0
    return c, s


def places(count, seed):
    rng = np.random.default_rng(seed)
    directions = rng.normal(size=(count, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    return directions * RADIUS * rng.uniform(1.02, 4.0, (count, 1))


@pytest.mark.parametrize(("degree", "order"), [(1, 1), (2, 2), (6, 6), (6, 3), (6, 0), (7, 6)])
def test_acceleration_is_the_potentials_gradient(degree, order):
    c, s = random_field(degree, order, seed=degree + 10 * order)
    positions = places(20, seed=degree)
    expected = np.array([gradient(position, c, s) for position in positions])
    error = np.linalg.norm(acceleration(positions, c, s) - expected, axis=1)
    assert np.all(error < 1e-13 * np.linalg.norm(expected, axis=1).max())
    assert np.all(error < 1e-12 * np.linalg.norm(expected, axis=1))


def test_the_real_field_to_degree_40_is_its_potentials_gradient():
    field = gravity_field.read_icgem(gravity_field.resolve("EGM2008")).truncate(40, 40)
    directions = places(2, seed=3)
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    positions = directions * (RADIUS + 300e3)
    expected = np.array([gradient(position, field.c, field.s) for position in positions])
    error = np.linalg.norm(acceleration(positions, field.c, field.s) - expected, axis=1)
    assert np.all(error < 1e-12 * np.linalg.norm(expected, axis=1))


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_the_poles_are_places_like_any_other(side):
    c, s = random_field(6, 6, seed=8)
    pole = np.array([[0.0, 0.0, side * 1.1 * RADIUS]])
    expected = gradient(pole[0], c, s)
    np.testing.assert_allclose(acceleration(pole, c, s)[0], expected, rtol=1e-12)
    beside = acceleration(pole + [1e-3, 0.0, 0.0], c, s)[0]
    np.testing.assert_allclose(beside, expected, rtol=1e-7)
