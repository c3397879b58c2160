"""The vector of doubles: every operation against numpy's, and each lane on its own."""

import numba
import numpy as np
import pytest
from support import in_rows

from opml.dynamics.kernels.lanes import (
    WIDTH,
    absolute,
    exp,
    lanes_set,
    load,
    log,
    nearest,
    select,
    splat,
    sqrt,
    store,
)

kernel = numba.njit(cache=True, error_model="numpy")


@kernel
def _arithmetic(a, b, out):
    x, y = load(a, 0), load(b, 0)
    store(out, 0, x + y)
    store(out, 1, x - y)
    store(out, 2, x * y)
    store(out, 3, x / y)
    store(out, 4, -x)
    store(out, 5, absolute(x))
    store(out, 6, nearest(x))
    store(out, 7, sqrt(absolute(x)))
    store(out, 8, 3.0 - x)
    store(out, 9, x - 3.0)
    store(out, 10, 3.0 / x)
    store(out, 11, x / 3)
    store(out, 12, 2 * x)
    store(out, 13, splat(7))


@kernel
def _choices(a, b, out, bits):
    x, y = load(a, 0), load(b, 0)
    store(out, 0, select(x < y, x, y))
    store(out, 1, select(x > 0.0, 1.0, y))
    store(out, 2, select((x > 0.0) & (y > 0.0), 1.0, 0.0))
    store(out, 3, select((x > 0.0) | (y > 0.0), 1.0, 0.0))
    bits[0] = lanes_set(x < y)
    bits[1] = lanes_set(x > y)


@kernel
def _exp(x, out):
    for row in range(x.shape[0]):
        store(out, row, exp(load(x, row)))


@kernel
def _log(x, out):
    for row in range(x.shape[0]):
        store(out, row, log(load(x, row)))


def _mapped(function, x):
    rows = in_rows(x)
    out = np.empty_like(rows)
    function(rows, out)
    return out.ravel()[: len(x)]


def _ulps(actual, exact):
    """Error in units in the last place of the exact value, which is held in extended precision."""
    return np.abs((actual - exact) / np.spacing(np.abs(exact).astype(float))).astype(float)


@pytest.fixture
def pair():
    rng = np.random.default_rng(1)
    a, b = rng.normal(size=(1, WIDTH)) * 10.0, rng.normal(size=(1, WIDTH)) * 10.0
    a[0, :4] = [0.5, 1.5, -2.5, 2.5]
    return a, b


def test_one_operation_rounds_as_numpys(pair):
    out = np.empty((14, WIDTH))
    _arithmetic(*pair, out)
    x, y = pair[0][0], pair[1][0]
    expected = [
        *(x + y, x - y, x * y, x / y, -x, np.abs(x), np.rint(x), np.sqrt(np.abs(x))),
        *(3.0 - x, x - 3.0, 3.0 / x, x / 3.0, 2.0 * x, np.full(WIDTH, 7.0)),
    ]
    np.testing.assert_array_equal(out, expected)


def test_choices_are_made_lane_by_lane_and_nan_compares_false(pair):
    a, b = pair
    a[0, 5], b[0, 9] = np.nan, np.nan
    out, bits = np.empty((4, WIDTH)), np.zeros(2, np.int64)
    _choices(a, b, out, bits)
    x, y = a[0], b[0]
    np.testing.assert_array_equal(out[0], np.where(x < y, x, y))
    np.testing.assert_array_equal(out[1], np.where(x > 0.0, 1.0, y))
    np.testing.assert_array_equal(out[2], (x > 0.0) & (y > 0.0))
    np.testing.assert_array_equal(out[3], (x > 0.0) | (y > 0.0))
    # Lane 0 is the lowest bit; the sixteenth must not become a sign.
    for found, condition in zip(bits, (x < y, x > y), strict=True):
        assert found == sum(1 << lane for lane in range(WIDTH) if condition[lane])


def test_all_lanes_set_is_a_positive_number():
    bits, out = np.zeros(2, np.int64), np.empty((4, WIDTH))
    _choices(np.zeros((1, WIDTH)), np.ones((1, WIDTH)), out, bits)
    assert bits.tolist() == [2**WIDTH - 1, 0]


def test_exp_is_good_to_two_units_in_the_last_place():
    rng = np.random.default_rng(2)
    x = np.concatenate(
        [
            np.linspace(-700.0, 700.0, 20_011),
            rng.uniform(-2.0, 2.0, 20_000),
            rng.normal(size=2_000) * 1e-9,
            np.log(2.0) * (np.arange(-40, 40) + 0.5),
            [0.0, -700.0, 700.0],
        ]
    )
    assert _ulps(_mapped(_exp, x), np.exp(x.astype(np.longdouble))).max() <= 2.0
    assert _mapped(_exp, np.zeros(1))[0] == 1.0


def test_exp_stays_at_its_floor_below_minus_700():
    floor = _mapped(_exp, [-700.0])[0]
    np.testing.assert_array_equal(_mapped(_exp, [-700.5, -745.0, -1e4, -1e300, -np.inf]), floor)
    assert 0.0 < floor == pytest.approx(np.exp(-700.0), rel=1e-15)


def test_log_is_good_to_two_units_in_the_last_place():
    rng = np.random.default_rng(3)
    x = np.concatenate(
        [
            10.0 ** np.linspace(-300.0, 300.0, 20_011),
            rng.uniform(0.3, 3.0, 20_000),
            1.0 + rng.normal(size=2_000) * 1e-6,
            np.sqrt(0.5) * (1.0 + rng.normal(size=2_000) * 1e-12),
            np.array([np.nextafter(1.0, 0.0), np.nextafter(1.0, 2.0), 2.0, 0.5]),
        ]
    )
    assert _ulps(_mapped(_log, x), np.log(x.astype(np.longdouble))).max() <= 2.0
    assert _mapped(_log, np.ones(1))[0] == 0.0


@pytest.mark.parametrize("function", [_exp, _log])
def test_a_lane_depends_neither_on_its_place_nor_on_its_neighbours(function):
    rng = np.random.default_rng(4)
    alone = _mapped(function, np.full(WIDTH, 1.2345))
    assert len(set(alone)) == 1
    for lane in range(WIDTH):
        row = rng.uniform(0.1, 50.0, WIDTH)
        row[(lane + 1) % WIDTH] = np.nan
        row[lane] = 1.2345
        assert _mapped(function, row)[lane] == alone[0]
