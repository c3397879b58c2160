"""Bridges between nodes follow an orbit that was flown; breaks are found where it was broken."""

import numpy as np
import pytest
from orbit_files import attraction_of, flown

from opml.interop.curves import orbit_breaks
from opml.interop.curves.gravity_interpolation import Bridges, bridge

STEP = 5.0
START = np.array([6778e3, 0.0, 0.0, 0.0, 4750.0, 6025.0])


@pytest.fixture(scope="module")
def attraction(earth_orientation):
    return attraction_of(earth_orientation)


@pytest.fixture(scope="module")
def orbit(attraction):
    """Three hours every 5 s, under gravity and a pull of 1e-6 m/s2."""
    t = np.arange(0.0, 10800.0 + STEP, STEP)
    return t, flown(attraction, START, t, lambda t: 1e-6 * np.array([0.0, np.cos(1e-3 * t), 1.0]))


def bridged(orbit, attraction, cadence, velocities):
    """Bridges over an orbit's nodes every `cadence` seconds."""
    nodes = slice(None, None, int(cadence / STEP))
    t, states = orbit[0][nodes], orbit[1][nodes]
    bridges = bridge(t, states[:, :3], attraction, wanted=np.ones(len(t) - 1, bool))
    found = states[:, 3:] if velocities else bridges.mean_velocities()
    return bridges.match_velocities(found, free=np.zeros(len(t), bool))


@pytest.mark.parametrize(
    ("cadence", "velocities", "within"),
    [(60.0, True, 1e-5), (300.0, True, 1e-3), (60.0, False, 1e-3), (300.0, False, 2e-2), (600.0, True, 1e-2)],
)
def test_a_bridge_follows_the_orbit(orbit, attraction, cadence, velocities, within):
    apart = bridged(orbit, attraction, cadence, velocities).states(orbit[0]) - orbit[1]
    assert np.abs(apart[:, :3]).max() < within
    assert np.abs(apart[:, 3:]).max() < within / 10.0


def test_nodes_are_met_and_nothing_is_known_outside(orbit, attraction):
    bridges = bridged(orbit, attraction, 300.0, velocities=True)
    np.testing.assert_allclose(bridges.states(bridges.t), orbit[1][::60], rtol=0, atol=1e-6)
    assert np.isnan(bridges.states(np.array([-1.0, 10801.0]))).all()


def test_an_interval_that_is_not_wanted_or_cannot_be_flown_is_left_open(orbit, attraction):
    t, states = orbit[0][::60], orbit[1][::60].copy()
    states[10, :3] = 1e3  # inside the Earth
    wanted = np.arange(len(t) - 1) != 3
    bridges = bridge(t, states[:, :3], attraction, wanted=wanted)
    assert np.flatnonzero(~bridges.bridged).tolist() == [3, 9, 10]
    assert np.flatnonzero((bridges.jumps == 0.0).all(axis=1)).tolist() == [0, 3, 4, 9, 10, 11, len(t) - 1]


def test_an_interval_does_not_depend_on_the_others(orbit, attraction):
    t, positions = orbit[0][::60], orbit[1][::60, :3]
    everything = bridge(t, positions, attraction, wanted=np.ones(len(t) - 1, bool))
    one = bridge(t, positions, attraction, wanted=np.arange(len(t) - 1) == 7)
    np.testing.assert_allclose(one.coefficients[7], everything.coefficients[7], rtol=0, atol=1e-6)


def jumps_of(orbit, attraction, cadence, change):
    """Times of nodes, and jumps of an orbit whose states were changed."""
    nodes = slice(None, None, int(cadence / STEP))
    t, states = orbit[0][nodes], orbit[1][nodes].copy()
    change(t, states)
    bridges: Bridges = bridge(t, states[:, :3], attraction, wanted=np.ones(len(t) - 1, bool))
    return t, bridges.jumps


def test_a_smooth_orbit_has_no_breaks(orbit, attraction):
    for cadence in (10.0, 60.0, 300.0):
        found, jumping, broken = orbit_breaks.find(
            *jumps_of(orbit, attraction, cadence, lambda t, states: None)
        )
        assert (found, jumping.any(), broken.any()) == ([], False, False)


def test_a_step_is_a_seam_between_two_nodes(orbit, attraction):
    def shifted(t, states):
        states[t >= 6000.0, :3] += [3.0, 4.0, 0.0]

    found, jumping, broken = orbit_breaks.find(*jumps_of(orbit, attraction, 60.0, shifted))
    assert (found[0].first, found[0].last, found[0].is_seam) == (99, 100, True)
    assert found[0].step == pytest.approx(5.0, rel=0.01)
    assert np.flatnonzero(jumping).tolist() == [99, 100]
    assert np.flatnonzero(broken).tolist() == [99]


def test_a_step_within_the_accuracy_of_an_orbit_is_bridged(orbit, attraction):
    def shifted(t, states):
        states[t >= 6000.0, 0] += 0.03

    found, _, broken = orbit_breaks.find(*jumps_of(orbit, attraction, 10.0, shifted))
    assert not any(one.is_seam or one.one_way for one in found)
    assert not broken.any()


def test_a_wrong_node_stands_alone(orbit, attraction):
    def astray(t, states):
        states[t == 6000.0, 1] += 1000.0

    found, _, broken = orbit_breaks.find(*jumps_of(orbit, attraction, 60.0, astray))
    assert [(one.first, one.last, one.is_seam, one.one_way) for one in found] == [(99, 101, False, False)]
    assert np.flatnonzero(broken).tolist() == [99, 100]


def test_wrong_nodes_side_by_side_stand_alone(orbit, attraction):
    def astray(t, states):
        states[100:105, :3] += np.random.default_rng(2).normal(0.0, 1e4, (5, 3))

    found, _, broken = orbit_breaks.find(*jumps_of(orbit, attraction, 60.0, astray))
    assert [(one.first, one.last) for one in found] == [(99, 105)]
    assert np.flatnonzero(broken).tolist() == list(range(99, 105))


@pytest.mark.parametrize("node", [0, 180])
def test_a_wrong_node_at_an_end_stands_alone(orbit, attraction, node):
    def astray(t, states):
        states[node, 1] += 1000.0

    _, _, broken = orbit_breaks.find(*jumps_of(orbit, attraction, 60.0, astray))
    assert broken[0 if node == 0 else -1]
    assert broken.sum() == 1


@pytest.mark.parametrize("at", [6000.0, 6010.0, 6030.0, 6055.0])
def test_a_kick_is_a_manoeuvre_with_its_size(orbit, attraction, at):
    kick = np.array([0.0, 0.3, 0.4])
    k = int(at / STEP)
    after = flown(attraction, orbit[1][k] + np.append(np.zeros(3), kick), orbit[0][k:])

    def kicked(t, states):
        states[t > at] = after[np.isin(orbit[0][k:], t[t > at])]

    found, _, broken = orbit_breaks.find(*jumps_of(orbit, attraction, 60.0, kicked))
    assert [one.one_way for one in found] == [True]
    assert found[0].velocity == pytest.approx(0.5, rel=0.01)
    assert abs(found[0].t - at) <= 30.0
    assert np.flatnonzero(broken).tolist() == ([] if at == 6000.0 else [100])


def test_an_orbit_that_becomes_noisy_does_not_break(orbit, attraction):
    def noisy(t, states):
        states[t > 5000.0, 0] += np.where(np.arange((t > 5000.0).sum()) % 2, 4.0, -4.0)

    found, jumping, broken = orbit_breaks.find(*jumps_of(orbit, attraction, 60.0, noisy))
    assert (found, jumping.any(), broken.any()) == ([], False, False)
