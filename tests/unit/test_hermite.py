"""Hermite's polynomial: exact where the orbit is one, whatever the spacing of the nodes."""

import numpy as np
import pytest

from opml.interop import hermite


def states(polynomials, t):
    """States (n, 6) on three polynomials of time."""
    rates = [polynomial.deriv() for polynomial in polynomials]
    return np.stack([function(t) for function in (*polynomials, *rates)], axis=1)


@pytest.mark.parametrize("nodes", [2, 3, 4, 9])
def test_a_polynomial_of_the_nodes_degree_comes_back(nodes):
    generator = np.random.default_rng(3)
    degree = 2 * min(nodes, hermite.NODES) - 1
    polynomials = [np.polynomial.Polynomial(generator.normal(size=degree + 1)) for _ in range(3)]
    t = np.sort(generator.uniform(-1.0, 1.0, nodes))
    at = generator.uniform(t[0], t[-1], 50)
    back = hermite.interpolate(t, states(polynomials, t), at)
    np.testing.assert_allclose(back, states(polynomials, at), rtol=0, atol=1e-9)


def test_no_times_give_no_states():
    assert hermite.interpolate(np.zeros(1), np.zeros((1, 6)), np.empty(0)).shape == (0, 6)
