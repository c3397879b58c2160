"""Where two objects most likely collide: drawn orbits, many pairs, a straight motion, and standstill."""

import math

import numpy as np
import pytest

from opml.base.constants import EARTH_GM
from opml.conjunctions.likeliest import UncertainPairs
from opml.conjunctions.probability import Encounter, chance
from opml.orbits.elements import rsw_rotation
from opml.orbits.equinoctial import cartesian_from_equinoctial, equinoctial_from_cartesian

A = 7e6


def circling(turn, ahead, along, radial):
    """An object on a circular orbit that is tilted about x, `ahead` of x, as uncertain along its curve."""
    x, way, phase = np.eye(3)[0], np.array([0.0, math.cos(turn), math.sin(turn)]), ahead / A
    position = A * (math.cos(phase) * x + math.sin(phase) * way)
    rate = math.sqrt(EARTH_GM / A**3)
    velocity = rate * A * (math.cos(phase) * way - math.sin(phase) * x)
    mixed = np.diag([radial, along, radial, 0.01, 0.01, 0.01])
    mixed[3, 1], mixed[4, 0] = -rate * along, -rate * radial
    state = np.concatenate([position, velocity])
    axes = np.kron(np.eye(2), rsw_rotation(state))
    return state, axes.T @ mixed @ mixed.T @ axes


def pairs(ahead=2e5, along=1e5, radial=1e3, radius=2e3):
    both = [circling(0.0, 0.0, along, radial), circling(1.0, ahead, along, radial)]
    states, covariances = (np.array(one) for one in zip(*both, strict=True))
    return UncertainPairs(states, covariances, np.array(radius))


def straight(pair):
    """The probability in two dimensions about the expected states."""
    position, velocity = np.split(pair.states[1] - pair.states[0], 2)
    covariance = pair.covariances.sum(axis=0)[:3, :3]
    return chance(Encounter(position, velocity, covariance, float(pair.radius))).probability


def bent(pair):
    """The probability in two dimensions about where both most likely collide."""
    found = pair.collisions()
    assert found.settled
    covariance = found.cloud.covariance[:3, :3]
    encounter = Encounter(found.cloud.mean[:3], found.velocity, covariance, float(pair.radius))
    return chance(encounter).probability


def drawn(state, covariance, rng, draws):
    """Elements (draws, 6) of normal errors."""
    elements, step = equinoctial_from_cartesian(state, EARTH_GM), 1e-6 * np.eye(6)
    ahead, behind = (
        cartesian_from_equinoctial(elements + sign * step, np.zeros(6), EARTH_GM) for sign in (1.0, -1.0)
    )
    mixed = np.linalg.solve((ahead - behind).T / 2e-6, np.linalg.cholesky(covariance))
    return elements + rng.standard_normal((draws, 6)) @ mixed.T


def test_a_collision_far_along_the_orbits_is_that_of_drawn_ones():
    pair, draws, rng = pairs(), 60_000, np.random.default_rng(1)
    elements = [drawn(*one, rng, draws) for one in zip(pair.states, pair.covariances, strict=True)]
    t = np.zeros(draws)
    for _ in range(4):
        first, second = (cartesian_from_equinoctial(one, t, EARTH_GM) for one in elements)
        position, velocity = np.split(second - first, 2, axis=1)
        t = t - np.sum(position * velocity, axis=1) / np.sum(velocity**2, axis=1)
    expected = float((np.linalg.norm(position, axis=1) < pair.radius).mean())
    assert bent(pair) == pytest.approx(expected, abs=3.0 * math.sqrt(expected / draws))
    assert straight(pair) < 0.4 * expected


def test_two_dimensions_about_the_expected_states_suffice_where_paths_are_straight():
    near = pairs(ahead=100.0, along=200.0, radial=20.0, radius=10.0)
    assert bent(near) == pytest.approx(straight(near), rel=1e-3)


def test_many_pairs_are_each_alone():
    alone = [pairs(), pairs(ahead=1e5, along=5e4, radial=300.0, radius=500.0)]
    together = UncertainPairs(
        *(np.array([getattr(one, name) for one in alone]) for name in ("states", "covariances", "radius"))
    )
    found = together.collisions()
    for k, one in enumerate(alone):
        expected = one.collisions()
        np.testing.assert_allclose(found.velocity[k], expected.velocity, rtol=1e-3, atol=1.0)
        np.testing.assert_allclose(found.cloud.mean[k, :3], expected.cloud.mean[:3], rtol=1e-2, atol=10.0)


def test_each_time_has_the_likeliest_collision():
    """Both are there at the time at which a collision is likeliest, and it is the farthest at others."""
    pair = pairs()
    cloud, squared = pair.clouds(np.array([-60.0, -13.5, 30.0]))
    assert squared.argmin() == 1
    assert cloud.mean.shape == (3, 6)
    now, _ = pairs(ahead=10.0).clouds(np.zeros(1))
    np.testing.assert_allclose(
        now.mean[0], pairs(ahead=10.0).states[1] - pairs(ahead=10.0).states[0], atol=0.1
    )


def test_objects_side_by_side_and_known_ones_are_no_fault():
    state, covariance = circling(0.0, 0.0, 100.0, 10.0)
    beside = UncertainPairs(
        np.array([state, state]), np.array([covariance, np.zeros((6, 6))]), np.array(10.0)
    )
    found = beside.collisions()
    assert np.isfinite(found.cloud.mean).all()
    known = UncertainPairs(pairs().states, np.zeros((2, 6, 6)), np.array(10.0)).collisions()
    np.testing.assert_allclose(known.velocity, pairs().states[1, 3:] - pairs().states[0, 3:], rtol=1e-2)
