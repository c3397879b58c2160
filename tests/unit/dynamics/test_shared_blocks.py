"""Arcs of several callers in the same blocks: each as if it were alone, whoever flies beside it."""

from functools import partial

import numpy as np
import pytest

from opml.base.constants import HOUR, WGS84_A
from opml.dynamics import ensemble, shared_blocks
from opml.dynamics.ensemble import Departures, propagate
from opml.dynamics.settings import Integrator
from opml.dynamics.shared_blocks import STEP, SharedBlocks
from opml.orbits.elements import cartesian_from_coe

RASTER = STEP * np.arange(200.0)
SPANS = {"all": RASTER, "late": RASTER[90::3], "back": RASTER[150:20:-2], "even": RASTER[60:120:2]}


def departures(epochs, gm, seed, count=3):
    """Arcs of different orbits from different epochs to later ones."""
    random = np.random.default_rng(seed)
    angles = random.uniform(0.1, 3.0, (count, 4))
    orbits = [[WGS84_A + 500e3 + 1e4 * seed, 0.001, *row] for row in angles]
    first = random.integers(0, 5, count)
    return Departures(
        np.array([cartesian_from_coe(np.array(orbit), gm) for orbit in orbits]),
        first=first,
        last=len(epochs) - 1 - random.integers(0, 5, count),
        ballistic=random.uniform(0.01, 0.03, count),
        reflection=np.full(count, 0.02),
    )


def caller(blocks, model, epochs, seed, rounds=1, longest=90.0):
    """Fly some arcs, several times in a row."""
    integrator = Integrator(max_step_s=longest, position_tolerance_m=10.0 if longest > STEP else 0.1)
    flown = [
        blocks.propagate(model, epochs, departures(epochs, model.gm, seed + turn), integrator=integrator)
        for turn in range(rounds)
    ]
    return flown[-1]


@pytest.fixture
def flights(monkeypatch):
    """The number of arcs of every flight."""
    numbers = []

    def counted(model, epochs, arcs, **settings):
        numbers.append(len(arcs))
        return propagate(model, epochs, arcs, **settings)

    monkeypatch.setattr(ensemble, "propagate", counted)
    return numbers


@pytest.mark.parametrize("longest", [90.0, 600.0])
@pytest.mark.parametrize("span", SPANS)
def test_an_arc_is_the_same_whoever_flies_beside_it(assumed_model, span, longest):
    alone, beside = SharedBlocks(), SharedBlocks()
    flying = {"longest": longest}
    (one,) = alone.run([partial(caller, alone, assumed_model, SPANS[span], 5, **flying)])
    others = [partial(caller, beside, assumed_model, epochs, 7, **flying) for epochs in SPANS.values()]
    mine = partial(caller, beside, assumed_model, SPANS[span], 5, **flying)
    _, found, *_ = beside.run([others[0], mine, *others[1:]])
    np.testing.assert_array_equal(found.states, one.states)
    np.testing.assert_array_equal(found.start, one.start)
    np.testing.assert_array_equal(found.status, one.status)
    afterwards = caller(beside, assumed_model, SPANS[span], 5, **flying)
    np.testing.assert_array_equal(afterwards.states, one.states)


@pytest.mark.parametrize("begin", [60, 61])
def test_long_steps_are_those_of_an_arc_that_flies_without_a_raster(assumed_model, begin):
    """Their raster has an epoch every two of the others', from where they begin."""
    blocks, epochs = SharedBlocks(), RASTER[begin:120:2]
    integrator = Integrator(max_step_s=600.0, position_tolerance_m=10.0)
    expected = propagate(
        assumed_model, epochs, departures(epochs, assumed_model.gm, 5), integrator=integrator
    )
    (found,) = blocks.run([partial(caller, blocks, assumed_model, epochs, 5, longest=600.0)])
    np.testing.assert_array_equal(found.states, expected.states)


def test_arcs_of_all_callers_are_one_flight_and_the_shortest_are_first(assumed_model, flights):
    """Who has short ones again does not keep the long ones of others from waiting for his."""
    blocks, ahead = SharedBlocks(), partial(caller, epochs=RASTER, seed=1)
    back = partial(caller, epochs=SPANS["back"], seed=1)
    blocks.run(
        [
            partial(ahead, blocks, assumed_model, rounds=2),
            partial(back, blocks, assumed_model, rounds=2),
            partial(ahead, blocks, assumed_model, rounds=1),
        ]
    )
    assert flights == [3, 3, 6, 3]


def test_arcs_beyond_the_most_that_fly_at_once_fly_next(assumed_model, flights, monkeypatch):
    blocks = SharedBlocks()
    calls = [partial(caller, blocks, assumed_model, RASTER, seed, rounds=2) for seed in range(3)]
    whole = blocks.run(calls)
    assert flights == [9, 9]
    flights.clear()
    monkeypatch.setattr(shared_blocks, "MOST", 7)
    for found, expected in zip(blocks.run(calls), whole, strict=True):
        np.testing.assert_array_equal(found.states, expected.states)
    assert flights == [6, 6, 6]


def test_epochs_off_the_raster_fly_alone(assumed_model, flights):
    blocks, epochs = SharedBlocks(), RASTER + 1.0
    alone, other = blocks.run(
        [partial(caller, blocks, assumed_model, epochs, 3), partial(caller, blocks, assumed_model, RASTER, 3)]
    )
    assert flights == [3, 3]
    plain = propagate(assumed_model, epochs, departures(epochs, assumed_model.gm, 3), integrator=Integrator())
    np.testing.assert_array_equal(alone.states, plain.states)
    assert not np.array_equal(alone.states, other.states)


def test_what_is_wrong_with_one_caller_is_raised_when_all_have_ended(assumed_model):
    blocks, ended = SharedBlocks(), []

    def wrong():
        raise ValueError("mine")

    def right():
        ended.append(caller(blocks, assumed_model, RASTER, 2, rounds=2))

    with pytest.raises(ValueError, match="mine"):
        blocks.run([right, wrong, right])
    assert len(ended) == 2


def test_a_flight_that_fails_fails_all_that_wait_for_it(assumed_model, monkeypatch):
    def lost(*_, **__):
        raise MemoryError("no room")

    monkeypatch.setattr(ensemble, "propagate", lost)
    blocks, told = SharedBlocks(), []

    def told_of_it():
        try:
            caller(blocks, assumed_model, RASTER, 2)
        except MemoryError as reason:
            told.append(str(reason))

    blocks.run([told_of_it] * 3)
    assert told == ["no room"] * 3


def test_an_arc_flies_under_the_outlook_that_it_names(assumed_model):
    """Each as under the model of that outlook alone."""
    t = assumed_model.first + assumed_model.step * np.arange(assumed_model.activity.shape[1])
    stormy = assumed_model.activity[0] + [80.0, 0.0, 3.0, 3.0]
    known = int(np.searchsorted(t, HOUR))
    two = np.stack([assumed_model.activity[0][known:], stormy[known:]])
    model = assumed_model._replace(issued=np.array([0.0]), known=np.array([known] * 2), outlooks=two)
    arcs = departures(RASTER, model.gm, 4)
    blocks = SharedBlocks()

    def under(outlook):
        return blocks.propagate(
            model,
            RASTER,
            Departures(
                arcs.states, arcs.first, arcs.last, arcs.ballistic, arcs.reflection, np.full(3, outlook)
            ),
            integrator=Integrator(),
        )

    calm, storm, newest = blocks.run(
        [partial(under, 0), partial(under, 1), partial(caller, blocks, model, RASTER, 4)]
    )
    np.testing.assert_array_equal(calm.states, newest.states)
    assert np.linalg.norm((storm.states - calm.states)[-1, :3]) > 1.0
