"""Orbits from three positions: the book's examples, Kepler's orbits, and curves through noise."""

import numpy as np
import pytest

from opml.base.constants import EARTH_GM, EARTH_RATE
from opml.catalog.fit.first.three_positions import gibbs, herrick_gibbs, orbit_state, unturned, velocity
from opml.orbits.elements import cartesian_from_coe, coe_from_cartesian, true_from_mean_anomaly


def kepler(t, *, a=6.8e6, e=0.01):
    """States (n, 6) at times t (n,) of a Kepler orbit."""
    mean = np.sqrt(EARTH_GM / a**3) * np.asarray(t)
    coe = np.tile([a, e, 0.9, 0.3, 1.1, 0.0], (len(mean), 1))
    coe[:, 5] = true_from_mean_anomaly(mean, np.full(len(mean), e))
    return cartesian_from_coe(coe, EARTH_GM)


def test_gibbs_is_the_books():
    """Vallado 2013, example 7-3."""
    positions = 1e3 * np.array(
        [[0.0, 0.0, 6378.1363], [0.0, -4464.696, -5102.509], [0.0, 5740.323, 3189.068]]
    )
    expected = [0.0, 5531.148, -5191.806]
    np.testing.assert_allclose(gibbs(positions, 3.986004415e14), expected, atol=0.05)


def test_herrick_gibbs_is_the_books():
    """Vallado 2013, example 7-4."""
    positions = 1e3 * np.array(
        [
            [3419.85564, 6019.82602, 2784.60022],
            [2935.91195, 6326.18324, 2660.59584],
            [2434.95202, 6597.38674, 2521.52311],
        ]
    )
    found = herrick_gibbs(positions, np.array([0.0, 76.48, 153.04]), 3.986004415e14)
    np.testing.assert_allclose(found, [-6441.632, 3777.625, -1720.582], atol=0.1)


@pytest.mark.parametrize("apart", [60.0, 900.0])
def test_the_velocity_is_keplers_whatever_the_angle(apart):
    t = apart * np.array([0.0, 1.0, 2.0])
    states = kepler(t)
    found = velocity(states[:, :3], t, EARTH_GM)
    # Taylor's series is cut off where positions are close, Gibbs's method is exact.
    np.testing.assert_allclose(found, states[1, 3:], atol=0.1 if apart < 100.0 else 1e-6)


def test_a_curve_through_a_noisy_track_gives_its_orbit():
    t = np.arange(0.0, 400.0, 20.0)
    states = kepler(t + 30.0)
    noise = np.random.default_rng(1).normal(size=(len(t), 3)) * 300.0
    middle, found = orbit_state(t, states[:, :3] + noise, EARTH_GM)
    expected = kepler([middle + 30.0])[0]
    assert np.linalg.norm((found - expected)[:3]) < 500.0
    assert np.linalg.norm((found - expected)[3:]) < 20.0
    assert abs(coe_from_cartesian(found, EARTH_GM)[0] - 6.8e6) < 50e3


def test_three_measurements_are_enough_without_noise():
    t = np.array([0.0, 60.0, 130.0])
    middle, found = orbit_state(t, kepler(t)[:, :3], EARTH_GM)
    np.testing.assert_allclose(found[3:], kepler([middle])[0, 3:], atol=20.0)


def test_the_earth_turns_eastwards():
    quarter = 0.5 * np.pi / EARTH_RATE
    np.testing.assert_allclose(
        unturned(np.array([quarter]), np.array([[1.0, 0.0, 2.0]])), [[0.0, 1.0, 2.0]], atol=1e-12
    )
