"""Where two objects most likely collide: drawn orbits, real ones, straight motion, standstill."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import block_diag
from support import shared

from opml.base.constants import EARTH_GM
from opml.conjunctions import cdm
from opml.conjunctions.likeliest_collision import UncertainPairs
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


def along_track(state):
    """A shift along the track by a metre, with the velocity that turns by it."""
    position, velocity = np.split(state, 2)
    ahead, rate = velocity / np.linalg.norm(velocity), np.linalg.norm(velocity) / A
    return np.concatenate([ahead, -rate * position / A])


def root(covariance):
    variances, axes = np.linalg.eigh(covariance)
    return axes * np.sqrt(np.maximum(variances, 0.0))


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
    cloud, velocity, is_straight = pair.collisions()
    assert is_straight
    return chance(
        Encounter(cloud.mean[:3], velocity, cloud.covariance[:3, :3], float(pair.radius))
    ).probability


class Errors:
    """Relative states of a pair by twelve standard normal numbers."""

    def __init__(self, pair):
        self.elements = equinoctial_from_cartesian(pair.states, EARTH_GM)
        step, inverse = 1e-6 * np.eye(6), []
        for elements in self.elements:
            ahead, behind = (
                cartesian_from_equinoctial(elements + sign * step, np.zeros(6), EARTH_GM)
                for sign in (1.0, -1.0)
            )
            inverse.append(np.linalg.inv((ahead - behind).T / 2e-6))
        states = block_diag(*pair.covariances)
        if pair.common is not None:
            states[:6, 6:] = np.outer(*pair.common)
            states[6:, :6] = states[:6, 6:].T
        spread = block_diag(*inverse) @ states @ block_diag(*inverse).T
        sigma = np.sqrt(np.diag(spread))
        variances, axes = np.linalg.eigh(spread / np.outer(sigma, sigma))
        self.mixed = sigma[:, None] * axes * np.sqrt(np.maximum(variances, 0.0))

    def at(self, numbers, t):
        """Relative positions and velocities (..., 3) of numbers (..., 12) at times (...)."""
        first, second = (
            cartesian_from_equinoctial(elements + part, t, EARTH_GM)
            for elements, part in zip(
                self.elements, np.split(numbers @ self.mixed.T, 2, axis=-1), strict=True
            )
        )
        return np.split(second - first, 2, axis=-1)

    def slope(self, numbers, t, ways):
        """Change (..., 3, k) of relative positions along ways (k, 12)."""
        steps, t = 1e-3 * ways, np.asarray(t)[..., None]
        ahead, behind = (self.at(numbers[..., None, :] + sign * steps, t)[0] for sign in (1.0, -1.0))
        return np.swapaxes(ahead - behind, -1, -2) / 2e-3


def sampled(pair, draws):
    """The probability by importance sampling, and its standard error.

    All but two numbers are drawn; these two and the time are solved for a collision, and weighed.
    """
    errors, rng, radius = Errors(pair), np.random.default_rng(1), float(pair.radius)
    likeliest, t = np.zeros(12), 0.0
    for _ in range(12):
        position, velocity = errors.at(likeliest, t)
        slope = errors.slope(likeliest, t, np.eye(12))
        plane = np.linalg.svd(velocity[None])[2][1:]
        met = np.linalg.pinv(plane @ slope) @ plane @ (slope @ likeliest - position)
        t -= velocity @ (position + slope @ (met - likeliest)) / (velocity @ velocity)
        likeliest = met
    ways = np.linalg.qr((plane @ slope).T)[0].T
    numbers = rng.standard_normal((draws, 12))
    numbers += (ways @ likeliest - numbers @ ways.T) @ ways
    place, t = rng.standard_normal((draws, 3)), np.full(draws, t)
    place -= np.outer(place @ velocity, velocity) / (velocity @ velocity)
    place *= radius * np.sqrt(rng.uniform(size=(draws, 1))) / np.linalg.norm(place, axis=1, keepdims=True)
    for _ in range(8):
        position, velocity = errors.at(numbers, t)
        jacobian = np.concatenate([errors.slope(numbers, t, ways), velocity[..., None]], axis=-1)
        change = np.linalg.solve(jacobian, (place - position)[..., None])[..., 0]
        numbers, t = numbers + change[:, :2] @ ways, t + change[:, 2]
    area = np.abs(np.linalg.det(jacobian)) / np.linalg.norm(velocity, axis=1)
    weights = 0.5 * radius**2 * np.exp(-0.5 * np.sum((numbers @ ways.T) ** 2, axis=1)) / area
    return weights.mean(), weights.std() / math.sqrt(draws)


def test_a_collision_far_along_the_orbits_is_that_of_drawn_ones():
    pair, draws = pairs(), 60_000
    errors, numbers, t = Errors(pair), np.random.default_rng(1).standard_normal((draws, 12)), np.zeros(draws)
    for _ in range(4):
        position, velocity = errors.at(numbers, t)
        t = t - np.sum(position * velocity, axis=1) / np.sum(velocity**2, axis=1)
    expected = float((np.linalg.norm(position, axis=1) < pair.radius).mean())
    assert bent(pair) == pytest.approx(expected, abs=3.0 * math.sqrt(expected / draws))
    assert straight(pair) < 0.4 * expected
    found, error = sampled(pair, 1000)
    assert error < 0.01 * found
    assert bent(pair) == pytest.approx(found, abs=3.0 * error)


@pytest.mark.parametrize(
    "name",
    [
        pytest.param("000043613_conj_000052010_20230626_045217_20230620_061741", id="far from NASA's"),
        pytest.param("000039574_conj_000039477_20220711_110033_20220705_220442", id="60 times too likely"),
        pytest.param("000029479_conj_000054630_20230725_134006_20230718_222924", id="slow"),
    ],
)
def test_real_conjunctions_are_those_of_importance_sampling(name):
    conjunction = cdm.read(shared(f"real/cara/{name}.cdm.gz"), epoch="2000-01-01T00:00:00")[0]
    together = conjunction.correlated
    for one in (conjunction, together):
        pair = (one.first, one.second)
        states = np.array([each.state for each in pair])
        covariances = np.array([each.inertial_covariance for each in pair])
        drawn = UncertainPairs(states, covariances, np.array(one.radius), one.common)
        found, error = sampled(drawn, 4000)
        assert error < 0.015 * found
        assert one.chance.probability == pytest.approx(found, abs=3.0 * error)
    assert abs(together.chance.probability / conjunction.chance.probability - 1.0) > 0.1


@pytest.mark.parametrize("turn", [0.3, 1.0, 1.6, 2.3, 3.0], ids="turned by {} rad".format)
@pytest.mark.parametrize("share", [0.5, 0.99])
def test_errors_that_both_share_are_those_of_drawn_ones(turn, share):
    """What the air does to both is drawn once."""
    both = [circling(0.0, 0.0, 3e3, 30.0), circling(turn, 1e3, 2e3, 30.0)]
    states, covariances = (np.array(one) for one in zip(*both, strict=True))
    common = np.array(
        [share * along * along_track(state) for state, along in zip(states, (3e3, 2e3), strict=True)]
    )
    pair, draws = UncertainPairs(states, covariances, np.array(100.0), common), 200_000
    numbers = np.random.default_rng(1).standard_normal((draws, 13))
    own = [
        numbers[:, 6 * k : 6 * k + 6] @ root(covariances[k] - np.outer(common[k], common[k])).T
        for k in range(2)
    ]
    first, second = (states[k] + own[k] + numbers[:, 12:] * common[k] for k in range(2))
    position, velocity = np.split(second - first, 2, axis=1)
    along = np.sum(position * velocity, axis=1) / np.sum(velocity**2, axis=1)
    expected = float((np.linalg.norm(position - along[:, None] * velocity, axis=1) < 100.0).mean())
    assert bent(pair) == pytest.approx(expected, abs=3.0 * math.sqrt(expected / draws))
    alone = UncertainPairs(states, covariances, np.array(100.0))
    assert abs(bent(alone) / expected - 1.0) > 0.1


def test_negative_variances_of_rounded_covariances_are_taken_away():
    """Of the first object, whose axes are those of the elements."""
    pair = pairs()
    found = []
    for least in (0.0, -1e-3):
        covariance = pair.covariances[0]
        sigma = np.sqrt(np.diag(covariance))
        variances, axes = np.linalg.eigh(covariance / np.outer(sigma, sigma))
        variances[0] = least
        rounded = np.outer(sigma, sigma) * ((axes * variances) @ axes.T)
        found.append(replace(pair, covariances=np.array([rounded, pair.covariances[1]])))
    assert np.linalg.eigvalsh(found[1].covariances[0])[0] < 0.0
    assert bent(found[1]) == pytest.approx(bent(found[0]), rel=1e-2)
    assert (found[1].clouds(np.linspace(-2000.0, 2000.0, 9))[1] >= 0.0).all()


def test_objects_side_by_side_and_known_ones_are_no_fault():
    state, covariance = circling(0.0, 0.0, 100.0, 10.0)
    beside = UncertainPairs(
        np.array([state, state]), np.array([covariance, np.zeros((6, 6))]), np.array(10.0)
    )
    assert np.isfinite(beside.collisions()[0].mean).all()
    _, velocity, _ = UncertainPairs(pairs().states, np.zeros((2, 6, 6)), np.array(10.0)).collisions()
    np.testing.assert_allclose(velocity, pairs().states[1, 3:] - pairs().states[0, 3:], rtol=1e-2)
