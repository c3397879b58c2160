"""Close approaches: encounters that were built are all found, to a millisecond and a metre."""

import numpy as np
import pytest

from opml.base.constants import DAY, EARTH_GM
from opml.base.errors import InputError
from opml.conjunctions.approaches import find
from opml.interop.ephemeris import Ephemeris
from opml.orbits.elements import (
    cartesian_from_coe,
    coe_from_cartesian,
    mean_from_true_anomaly,
    true_from_mean_anomaly,
)

T = np.arange(0.0, 2.0 * DAY + 1.0, 60.0)


def kepler(state, at, t):
    """States (n, 6) at times (n,) of the ellipse through a state (6,) at a time."""
    a, e, i, argp, raan, nu = coe_from_cartesian(state, EARTH_GM)
    mean = mean_from_true_anomaly(nu, e) + np.sqrt(EARTH_GM / a**3) * (t - at)
    nu = true_from_mean_anomaly(np.mod(mean, 2.0 * np.pi), e)
    columns = np.broadcast_arrays(a, e, i, argp, raan, nu)
    return cartesian_from_coe(np.stack(columns, axis=1), EARTH_GM)


def built(rng):
    """An object, another that passes it, the time and the distance."""
    at, radius = rng.uniform(0.1, 1.9) * DAY, rng.uniform(6.8e6, 7.6e6)
    out, along = np.linalg.qr(rng.normal(size=(3, 2)))[0].T
    aside = np.cross(out, along)
    turn, speed = rng.uniform(0.02, np.pi), np.sqrt(EARTH_GM / radius)
    first = np.concatenate([radius * out, speed * along])
    velocity = speed * rng.uniform(0.999, 1.001) * (np.cos(turn) * along + np.sin(turn) * aside)
    relative = velocity - first[3:]
    miss = rng.uniform(0.0, 2000.0)
    across = np.cross(relative, rng.normal(size=3))
    second = np.concatenate([first[:3] + miss * across / np.linalg.norm(across), velocity])
    return first, second, at, miss


def distance(paths, t):
    one, other = (path.at(np.array([t]))[0, :3] for path in paths)
    return np.linalg.norm(other - one)


def test_a_hundred_encounters_are_all_found():
    rng = np.random.default_rng(1)
    for _ in range(100):
        first, second, at, miss = built(rng)
        paths = [Ephemeris(name, T, kepler(state, at, T)) for name, state in (("a", first), ("b", second))]
        (closest,) = (t for t, _ in find(*paths, within=5000.0) if abs(t - at) < 5.0)
        # Gravity bends a slow pass, which is then closest some milliseconds beside the time it was built at.
        assert distance(paths, closest) == pytest.approx(miss, abs=1.0)
        exact = [kepler(state, at, np.array([closest]))[0] for state in (first, second)]
        relative = exact[1] - exact[0]
        beside = relative[:3] @ relative[3:] / (relative[3:] @ relative[3:])
        assert abs(beside) < 1e-3
        assert np.linalg.norm(relative[:3]) == pytest.approx(distance(paths, closest), abs=1e-2)


@pytest.mark.parametrize("begin", [-20.0, 20.0 - 600.0 * 60.0])
def test_encounters_between_an_end_and_a_whole_minute_are_found(begin):
    first, second, _, miss = built(np.random.default_rng(6))
    at = 0.5 * DAY + 30.0
    t = at + begin + 60.0 * np.arange(601)
    paths = [Ephemeris(name, t, kepler(state, at, t)) for name, state in (("a", first), ("b", second))]
    near = [distance(paths, one) for one, _ in find(*paths, within=5000.0) if abs(one - at) < 5.0]
    assert near == [pytest.approx(miss, abs=1.0)]


def side_by_side(rng, radial, speed):
    """Velocities (2, 3) of an ellipse and of another that nearly keeps up; directions as in `built`."""
    ahead = np.array([radial, speed, 0.0])
    return ahead, ahead + rng.normal(size=3) * rng.choice([1.0, 10.0, 100.0])


def head_on(rng, radial, speed):
    ahead = np.array([radial, speed, 0.0])
    return ahead, -ahead * rng.uniform(0.98, 1.02)


@pytest.mark.parametrize("velocities", [side_by_side, head_on])
def test_slow_and_opposite_encounters_of_eccentric_orbits_are_found(velocities):
    rng = np.random.default_rng(7)
    for _ in range(10):
        at, radius, e = rng.uniform(0.1, 0.4) * DAY, rng.uniform(6.8e6, 9e6), rng.uniform(0.0, 0.6)
        nu = rng.uniform(-0.5, 0.5)
        scale = np.sqrt(EARTH_GM / (radius * (1.0 + e * np.cos(nu))))
        one, other = velocities(rng, scale * e * np.sin(nu), scale * (1.0 + e * np.cos(nu)))
        aside = np.cross(other - one, rng.normal(size=3))
        position = np.array([radius, 0.0, 0.0])
        beside = position + 500.0 * aside / np.linalg.norm(aside)
        t = T[T <= 0.5 * DAY] + 11.0
        states = (np.concatenate([position, one]), np.concatenate([beside, other]))
        paths = [Ephemeris(name, t, kepler(state, at, t)) for name, state in zip("ab", states, strict=True)]
        fine = np.arange(at - 300.0, at + 300.0, 0.1)
        apart = np.linalg.norm((kepler(states[1], at, fine) - kepler(states[0], at, fine))[:, :3], axis=1)
        (closest,) = (one for one, _ in find(*paths, within=5000.0) if abs(one - at) < 300.0)
        assert distance(paths, closest) == pytest.approx(apart.min(), abs=1.0)
        assert abs(closest - fine[np.argmin(apart)]) < 0.2


@pytest.mark.parametrize(("t", "expected"), [(T[:3], "at least 4 states, got 3"), (10.0 * T, "got 600")])
def test_states_that_do_not_make_a_path_are_refused(t, expected):
    with pytest.raises(InputError, match=f"^a: .*{expected}"):
        Ephemeris("a", t, np.ones((len(t), 6))).check()


def test_a_burn_parts_a_path_in_one_way_and_a_wrong_state_in_two():
    t = 60.0 * np.arange(40)
    state = np.array([7e6, 0.0, 0.0, 0.0, 7.5e3, 0.0])
    before = kepler(state, 0.0, t)
    at_burn = kepler(state, 0.0, np.array([1230.0]))[0] + [0.0, 0.0, 0.0, 60.0, 0.0, 80.0]
    burned = np.where((t < 1230.0)[:, None], before, kepler(at_burn, 1230.0, t))
    assert Ephemeris("burned", t, burned).heights[0] > 6e6
    burned[30, 2] += 5e3
    with pytest.raises(InputError, match="5 km off at 2000-01-01T12:30:00"):
        Ephemeris("spike", t, burned).check()
