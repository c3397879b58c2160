"""Long encounters: Alfano's Monte Carlo, one of our own, the straight line, and what never is apart."""

import math
from dataclasses import replace

import numpy as np
import pytest
from support import shared

from opml.base.constants import EARTH_GM
from opml.conjunctions import as_text, cdm, long_encounter
from opml.conjunctions.conjunction import Conjunction, Participant
from opml.conjunctions.likeliest_collision import UncertainPairs
from opml.interop.object_ids import ObjectId
from opml.orbits.elements import rsw_rotation
from opml.orbits.equinoctial import cartesian_from_equinoctial, equinoctial_from_cartesian

EPOCH = "2000-01-01T00:00:00"
ALFANO = {1: 0.217467140, 4: 0.073089530, 6: 0.004300500, 7: 0.000161462, 9: 0.365116060}
"""Probabilities of Alfano 2009 (AAS 09-233), by Monte Carlo with 10^8 draws."""

SPEED = math.sqrt(3.986004418e14 / 7e6)


def met(turn, sigma, miss=30.0, slower=0.0):
    """Two objects on circular orbits that cross at a small angle, `miss` above each other."""
    first = np.array([7e6, 0.0, 0.0, 0.0, SPEED, 0.0])
    way = np.array([0.0, math.cos(turn), math.sin(turn)])
    second = np.concatenate([[7e6 + miss, 0.0, 0.0], (SPEED - slower) * way])
    mixed = np.diag(sigma)
    mixed[3, 1] = mixed[4, 0] = -SPEED / 7e6
    mixed[3, 1] *= sigma[1]
    mixed[4, 0] *= sigma[0]
    pair = (
        Participant(ObjectId(name), state, mixed @ mixed.T) for name, state in (("a", first), ("b", second))
    )
    return Conjunction(0.0, *pair, 20.0)


SLOW = met(1e-4, (15.0, 60.0, 20.0, 0.01, 0.01, 0.01))


@pytest.mark.parametrize("number", ALFANO)
def test_alfanos_long_cases_have_their_probability(number):
    conjunction = cdm.read(shared(f"real/cdm/AlfanoTestCase{number:02d}.cdm"), epoch=EPOCH)[0]
    assert not conjunction.is_short
    assert conjunction.chance.probability == pytest.approx(ALFANO[number], rel=0.01)


def slope(elements, t):
    """How a state (6,) at a time varies with elements (6, 6)."""
    steps = 1e-6 * np.eye(6)
    ahead, behind = (
        cartesian_from_equinoctial(elements + sign * steps, np.full(6, t), EARTH_GM) for sign in (1, -1)
    )
    return (ahead - behind).T / 2e-6


def drawn(conjunction, begin, end, draws):
    """The share of drawn pairs of orbits that collide from a time to another, and its standard error."""
    rng, step = np.random.default_rng(1), 25.0
    orbits = []
    for one in (conjunction.first, conjunction.second):
        elements = equinoctial_from_cartesian(one.state, EARTH_GM)
        root = np.linalg.solve(slope(elements, 0.0), np.linalg.cholesky(one.inertial_covariance))
        orbits.append(elements + rng.standard_normal((draws, 6)) @ root.T)
    nearest = np.full(draws, np.inf)
    for t in np.arange(begin + 0.5 * step, end, step):
        first, second = (cartesian_from_equinoctial(elements, np.array(t), EARTH_GM) for elements in orbits)
        position, velocity = np.split(second - first, 2, axis=1)
        along = -np.sum(position * velocity, axis=1) / np.sum(velocity**2, axis=1)
        passed = position + np.clip(along, -0.5 * step, 0.5 * step)[:, None] * velocity
        nearest = np.minimum(nearest, np.linalg.norm(passed, axis=1))
    share = float((nearest < conjunction.radius).mean())
    return share, math.sqrt(share * (1.0 - share) / draws)


def test_a_slow_encounter_is_that_of_drawn_orbits():
    """Between the times of least flow, a quarter of a revolution to either side."""
    expected, error = drawn(SLOW, -1450.0, 1450.0, 10_000)
    assert not SLOW.is_short
    assert SLOW.chance.probability == pytest.approx(expected, abs=3.0 * error)


def moved(conjunction, dt):
    """The conjunction as it is told for another time, by which both have flown on."""
    pair = []
    for one in (conjunction.first, conjunction.second):
        elements = equinoctial_from_cartesian(one.state, EARTH_GM)
        state = cartesian_from_equinoctial(elements, np.array(dt), EARTH_GM)
        change = np.kron(np.eye(2), rsw_rotation(state)) @ slope(elements, dt)
        change = change @ np.linalg.inv(slope(elements, 0.0))
        pair.append(replace(one, state=state, covariance=change @ one.inertial_covariance @ change.T))
    return replace(conjunction, first=pair[0], second=pair[1])


@pytest.mark.parametrize("name", ["19_182317_20211217_232706", "20_012535_20211215_145954"])
@pytest.mark.parametrize("dt", [-30.0, 10.0, 60.0], ids="{} s later".format)
def test_a_long_encounter_is_the_same_from_another_time(name, dt):
    told = cdm.read(shared(f"real/cara/000048901_conj_000048903_202112{name}.cdm.gz"), epoch=EPOCH)[0]
    assert told.method == "3D-Nc"
    assert moved(told, dt).chance.probability == pytest.approx(told.chance.probability, rel=1e-4)


def test_a_fast_encounter_is_that_in_two_dimensions():
    fast = met(0.3, (15.0, 200.0, 20.0, 0.01, 0.01, 0.01))
    assert fast.is_short
    states = np.array([fast.first.state, fast.second.state])
    covariances = np.array([fast.first.inertial_covariance, fast.second.inertial_covariance])
    found = long_encounter.chance(
        UncertainPairs(states, covariances, np.array(fast.radius)), fast.first.period
    )
    assert found.probability == pytest.approx(fast.chance.probability, rel=1e-3)


def test_what_flows_at_other_times_of_the_revolution_is_told():
    conjunction = cdm.read(shared("real/cdm/AlfanoTestCase06.cdm"), epoch=EPOCH)[0]
    # Of 100 000 drawn orbits 413 collide half a revolution away, beside those of the approach.
    assert conjunction.chance.around == pytest.approx(0.0043 + 0.0041, rel=0.01)
    (remark,) = as_text.table([conjunction], epoch=EPOCH)["remark"]
    assert remark == "8.4e-03 in its revolution"
    assert SLOW.chance.probability <= SLOW.chance.around < 1.5 * SLOW.chance.probability


def test_objects_that_never_are_apart_collide():
    docked = met(1e-7, (1.0, 1.0, 1.0, 1e-4, 1e-4, 1e-4), miss=2.0)
    assert docked.chance.probability == pytest.approx(1.0, abs=0.01)
    assert not docked.chance.mended
    assert met(1e-7, np.zeros(6), miss=2.0).chance.mended


def test_a_long_encounter_is_told(tmp_path):
    row = as_text.table([SLOW], epoch=EPOCH).iloc[0]
    assert row["method"] == "3D-Nc"
    assert row["remark"] == ""
    assert row["probability"] == SLOW.chance.probability
    assert np.isnan(row["largest"])
    cdm.write(tmp_path / "slow.cdm", SLOW, epoch=EPOCH)
    text = (tmp_path / "slow.cdm").read_text()
    assert f"COLLISION_PROBABILITY = {SLOW.chance.probability!r}" in text
    assert "METHOD = FOSTER" not in text


def test_one_known_object_is_enough_and_ellipses_are_needed():
    bare = Participant(ObjectId("b"), SLOW.second.state)
    alone = Conjunction(0.0, SLOW.first, bare, SLOW.radius)
    assert 0.0 < alone.chance.probability < 1.0
    leaving = SLOW.first.state * np.array([1, 1, 1, 1, 1.5, 1])
    gone = Conjunction(0.0, SLOW.first, Participant(ObjectId("gone"), leaving, 1e12 * np.eye(6)), SLOW.radius)
    assert gone.chance is None
    (remark,) = as_text.table([gone], epoch=EPOCH)["remark"]
    assert remark == "long encounter: no probability"
