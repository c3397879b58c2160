"""Third bodies against the direct and the indirect term, summed in 50 decimal digits."""

from decimal import Decimal, localcontext

import numba
import numpy as np
import pytest
from support import in_rows

from opml.base.constants import GM
from opml.dynamics.kernels.lanes import load, store
from opml.dynamics.kernels.third_body import third_bodies

SUN = (-1.49e11, -1.3e10, -5.8e9)
MOON = (-3.7e8, 1.1e8, 4.7e7)
NEPTUNE = (4.08e12, -1.36e12, -6.6e11)
INTRUDER = (9.0e6, 1.0e6, -2.0e6)
"""A made-up body close by, where no term is small."""


@numba.njit(cache=True, error_model="numpy")
def _third_bodies(x, y, z, bodies, gms, count, out):
    for row in range(x.shape[0]):
        ax, ay, az = third_bodies(load(x, row), load(y, row), load(z, row), bodies, gms, count)
        store(out[0], row, ax)
        store(out[1], row, ay)
        store(out[2], row, az)


def acceleration(positions, bodies, gms, count=None):
    rows = [in_rows(positions[:, k]) for k in range(3)]
    out = np.empty((3, *rows[0].shape))
    flat = np.ravel(bodies).astype(float)
    _third_bodies(*rows, flat, np.array(gms), len(gms) if count is None else count, out)
    return out.reshape(3, -1)[:, : len(positions)].T


def exact(position, body, gm):
    """gm (d/|d|^3 - s/|s|^3) with d = s - r (Vallado 2013, eq. 8-34)."""
    with localcontext() as context:
        context.prec = 50
        s = [Decimal(float(v)) for v in body]
        d = [a - Decimal(float(v)) for a, v in zip(s, position, strict=True)]
        s3, d3 = (sum(v * v for v in w).sqrt() ** 3 for w in (s, d))
        return np.array([float(Decimal(gm) * (a / d3 - b / s3)) for a, b in zip(d, s, strict=True)])


@pytest.fixture(scope="module")
def positions():
    directions = np.random.default_rng(1).normal(size=(20, 3))
    return (
        directions
        / np.linalg.norm(directions, axis=1, keepdims=True)
        * np.linspace(6.6e6, 4.2e7, 20)[:, None]
    )


@pytest.mark.parametrize(
    ("body", "gm"),
    [(SUN, GM["sun"]), (MOON, GM["moon"]), (NEPTUNE, GM["neptune"]), (INTRUDER, 1e13)],
    ids=["sun", "moon", "neptune", "intruder"],
)
def test_one_body(positions, body, gm):
    expected = np.array([exact(position, body, gm) for position in positions])
    error = np.linalg.norm(acceleration(positions, [body], [gm]) - expected, axis=1)
    assert np.all(error < 2e-14 * np.linalg.norm(expected, axis=1))


def test_bodies_add_up_and_no_more_than_asked_for(positions):
    bodies, gms = [SUN, MOON, NEPTUNE], [GM["sun"], GM["moon"], GM["neptune"]]
    each = [acceleration(positions, [body], [gm]) for body, gm in zip(bodies, gms, strict=True)]
    # Neptune's part, 1e-7 of the whole, must show.
    close = {"rtol": 1e-14, "atol": 1e-21}
    np.testing.assert_allclose(acceleration(positions, bodies, gms), sum(each), **close)
    np.testing.assert_allclose(acceleration(positions, bodies, gms, count=2), each[0] + each[1], **close)
    np.testing.assert_array_equal(acceleration(positions, bodies, [GM["sun"], 0.0, 0.0]), each[0])
