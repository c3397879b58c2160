"""Equinoctial elements: there and back, Kepler's orbits, and circles in the plane of the axes."""

import numpy as np
from support import refusal

from opml.base.constants import EARTH_GM
from opml.orbits.elements import cartesian_from_coe
from opml.orbits.equinoctial import cartesian_from_equinoctial, equinoctial_from_cartesian

COE = np.array(
    [
        [7e6, 0.0, 0.0, 0.0, 0.0, 1.0],
        [7e6, 1e-3, 1.7, 0.3, 2.0, 4.0],
        [42e6, 0.7, 0.9, 5.0, 4.0, 3.0],
        [2.6e7, 0.2, 3.1, 1.0, 1.0, 6.0],
    ]
)
STATES = cartesian_from_coe(COE, EARTH_GM)


def test_states_come_back():
    elements = equinoctial_from_cartesian(STATES, EARTH_GM)
    found = cartesian_from_equinoctial(elements, np.zeros(4), EARTH_GM)
    np.testing.assert_allclose(found, STATES, rtol=1e-10, atol=1e-4)


def test_elements_are_those_of_their_definition():
    a, e, inclination, argp, raan, _ = COE[1:].T
    elements = equinoctial_from_cartesian(STATES[1:], EARTH_GM)
    half = np.tan(0.5 * inclination)
    expected = [e * np.sin(argp + raan), e * np.cos(argp + raan), half * np.sin(raan), half * np.cos(raan)]
    np.testing.assert_allclose(elements[:, 1:5].T, expected, rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(np.exp(elements[:, 0]), np.sqrt(EARTH_GM / a**3), rtol=1e-12)


def test_the_orbit_is_keplers():
    """The acceleration is that of the central mass."""
    elements, step = equinoctial_from_cartesian(STATES, EARTH_GM), 0.5
    before, at, after = (
        cartesian_from_equinoctial(elements, np.full(4, 777.0 + t), EARTH_GM) for t in (-step, 0.0, step)
    )
    rate = (after - before) / (2.0 * step)
    distance = np.linalg.norm(at[:, :3], axis=1, keepdims=True)
    np.testing.assert_allclose(rate[:, :3], at[:, 3:], rtol=1e-5, atol=1e-3)
    np.testing.assert_allclose(rate[:, 3:], -EARTH_GM * at[:, :3] / distance**3, rtol=1e-5, atol=1e-5)


def test_a_hyperbola_has_none():
    leaving = STATES[1] * np.array([1, 1, 1, 2, 2, 2])
    assert "eccentricity: expected a value in" in refusal(equinoctial_from_cartesian, leaving, EARTH_GM)
