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


def jumps_of(t, states, attraction):
    """Jumps of an orbit at its nodes, beside their times."""
    bridges: Bridges = bridge(t, states[:, :3], attraction, wanted=np.ones(len(t) - 1, bool))
    return t, bridges.jumps


def kind_of(one):
    return "seam" if one.is_seam else "one way" if one.one_way else ""


FAR = np.random.default_rng(2).normal(0.0, 1e4, (5, 3))
TO_AND_FRO = np.outer(np.where(np.arange(97) % 2, 4.0, -4.0), [1.0, 0.0, 0.0])
MOVED = {  # cadence, nodes, by how much [m]; breaks: first and last node and kind; intervals that stay open
    "none": (60.0, slice(0), 0.0, [], []),
    "none, dense": (10.0, slice(0), 0.0, [], []),
    "none, thin": (300.0, slice(0), 0.0, [], []),
    "to and fro": (60.0, slice(84, None), TO_AND_FRO, [], []),
    "a step": (60.0, slice(100, None), [3.0, 4.0, 0.0], [(99, 100, "seam")], [99]),
    "a step within the accuracy": (10.0, slice(600, None), [0.03, 0.0, 0.0], [(599, 600, "")], []),
    "one": (60.0, slice(100, 101), [0.0, 1e3, 0.0], [(99, 101, "")], [99, 100]),
    "side by side": (60.0, slice(100, 105), FAR, [(99, 105, "")], range(99, 105)),
    "the first": (60.0, slice(1), [0.0, 1e3, 0.0], [(1, 1, "one way")], [0]),
    "the last": (60.0, slice(180, 181), [0.0, 1e3, 0.0], [(179, 179, "one way")], [179]),
}


@pytest.mark.parametrize(("cadence", "nodes", "by", "breaks", "are_open"), MOVED.values(), ids=MOVED)
def test_breaks_are_where_nodes_were_moved(orbit, attraction, cadence, nodes, by, breaks, are_open):
    raster = slice(None, None, int(cadence / STEP))
    t, states = orbit[0][raster], orbit[1][raster].copy()
    states[nodes, :3] += by
    found, jumping, broken = orbit_breaks.find(*jumps_of(t, states, attraction))
    assert [(one.first, one.last, kind_of(one)) for one in found] == breaks
    assert np.flatnonzero(broken).tolist() == list(are_open)
    assert np.flatnonzero(jumping).tolist() == [
        k for first, last, _ in breaks for k in range(first, last + 1)
    ]


@pytest.mark.parametrize("at", [6000.0, 6010.0, 6030.0, 6055.0])
def test_a_kick_is_a_manoeuvre_with_its_size(orbit, attraction, at):
    kick = np.array([0.0, 0.3, 0.4])
    k = int(at / STEP)
    after = flown(attraction, orbit[1][k] + np.append(np.zeros(3), kick), orbit[0][k:])

    t, states = orbit[0][::12], orbit[1][::12].copy()
    states[t > at] = after[np.isin(orbit[0][k:], t[t > at])]
    found, _, broken = orbit_breaks.find(*jumps_of(t, states, attraction))
    assert [one.one_way for one in found] == [True]
    assert found[0].velocity == pytest.approx(0.5, rel=0.01)
    assert abs(found[0].t - at) <= 30.0
    assert np.flatnonzero(broken).tolist() == ([] if at == 6000.0 else [100])
