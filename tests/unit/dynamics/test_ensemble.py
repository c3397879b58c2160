"""Many arcs on one clock: against Kepler and SciPy, and each arc as if it were alone."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from opml.base.constants import DAY, HOUR, WGS84_A
from opml.dynamics import ensemble
from opml.dynamics.ensemble import REASONS, Departures, propagate
from opml.dynamics.kernels.gravity import weights
from opml.dynamics.settings import Integrator
from opml.orbits.elements import TURN, cartesian_from_coe, coe_from_cartesian, true_from_mean_anomaly

BALLISTIC, REFLECTION = 0.11, 0.0625


def orbit(altitude, e=0.001, i=0.9, argp=1.0, raan=2.0, nu=0.5, gm=3.986004415e14):
    """A state whose perigee lies at `altitude` [m] over the equator's radius."""
    return cartesian_from_coe(np.array([(WGS84_A + altitude) / (1.0 - e), e, i, argp, raan, nu]), gm)


def fly(
    model,
    epochs,
    states,
    *,
    first=None,
    last=None,
    ballistic=BALLISTIC,
    reflection=REFLECTION,
    threads=1,
    integrator=None,
):
    """Propagate arcs that by default begin at the first epoch and end at the last."""
    count = len(states)
    return propagate(
        model,
        np.asarray(epochs, float),
        Departures(
            np.asarray(states),
            first=np.zeros(count, int) if first is None else first,
            last=np.full(count, len(epochs) - 1) if last is None else last,
            ballistic=np.broadcast_to(ballistic, count),
            reflection=np.full(count, reflection),
        ),
        integrator=integrator or Integrator(),
        threads=threads,
    )


def fly_freely(model, epochs, states, **settings):
    """Without drag and radiation pressure, from the first epoch to the last."""
    return fly(model, epochs, states, ballistic=0.0, reflection=0.0, integrator=Integrator(**settings))


def test_kepler_orbits(kepler_model):
    gm = kepler_model.gm
    states = np.array(
        [orbit(400e3), orbit(300e3, e=0.3), orbit(5900e3, e=0.005, i=1.9), orbit(250e3, e=0.73)]
    )
    epochs = np.array([0.0, 20.0, 50.0, 5000.0, 43210.0])
    arcs = fly_freely(kepler_model, epochs, states, position_tolerance_m=1e-4)
    assert np.all(arcs.status == 0)
    for k, state in enumerate(states):
        coe = coe_from_cartesian(state, gm)
        eccentric = 2.0 * np.arctan(np.sqrt((1 - coe[1]) / (1 + coe[1])) * np.tan(coe[5] / 2.0))
        mean = eccentric - coe[1] * np.sin(eccentric) + np.sqrt(gm / coe[0] ** 3) * epochs[1:]
        elements = np.repeat(coe[None], len(mean), axis=0)
        elements[:, 5] = true_from_mean_anomaly(np.mod(mean, TURN), coe[1])
        expected = cartesian_from_coe(elements, gm)
        assert np.abs(arcs.path(k)[:, :3] - expected[:, :3]).max() < 0.02
        assert np.abs(arcs.path(k)[:, 3:] - expected[:, 3:]).max() < 2e-5
        assert np.abs(arcs.path(k)[:2, :3] - expected[:2, :3]).max() < 1e-6


def test_small_steps_at_perigee_agree_with_scipys(assumed_model):
    """Oblateness and an orbit that falls from far away: grid steps at perigee fail and are taken in parts."""
    c20 = -4.84165143790815e-4
    c = np.zeros((assumed_model.degree, assumed_model.columns - 1))
    c[2, 0] = c20
    model = assumed_model._replace(
        weights=weights(c, np.zeros_like(c)),
        gms=np.zeros_like(assumed_model.gms),
        orientation=np.zeros_like(assumed_model.orientation),
    )
    assert model.weights.shape == assumed_model.weights.shape
    gm, factor = model.gm, -1.5 * -np.sqrt(5.0) * c20 * model.gm * model.radius**2

    def rates(_, state):
        r = np.linalg.norm(state[:3])
        flat = 5.0 * state[2] ** 2 / r**2
        acceleration = -gm / r**3 * state[:3] + factor / r**5 * state[:3] * np.array(
            [1 - flat, 1 - flat, 3 - flat]
        )
        return np.concatenate([state[3:], acceleration])

    start = orbit(220e3, e=0.8, i=0.5, nu=-2.5)
    epochs = np.array([0.0, 1000.0, 20_000.0, 60_000.0])
    expected = solve_ivp(
        rates, (0.0, epochs[-1]), start, method="DOP853", t_eval=epochs[1:], rtol=1e-13, atol=1e-6
    ).y.T
    # Companions keep the grid's pace while this one takes its own.
    states = np.array([orbit(8e6), start, orbit(7e6)])
    for ceiling in (90.0, 600.0):
        arcs = fly_freely(model, epochs, states, position_tolerance_m=1e-4, max_step_s=ceiling)
        assert np.linalg.norm(arcs.path(1)[:, :3] - expected[:, :3], axis=1).max() < 0.05
    # Without the smaller steps it would be lost: 600 s are a seventh of a circular orbit at perigee's height.
    blind = fly_freely(model, epochs, states, position_tolerance_m=1e12, max_step_s=600.0)
    assert np.linalg.norm(blind.path(1)[-1, :3] - expected[-1, :3]) > 1e3


@pytest.mark.parametrize(("reflection", "within"), [(0.0, 0.01), (REFLECTION, 0.05)])
def test_back_to_where_it_began(assumed_model, reflection, within):
    """To a centimetre where forces are smooth; each edge of the shadow inside a step of 90 s costs little."""
    states, epochs = np.array([orbit(400e3), orbit(800e3, e=0.02, i=1.7)]), np.linspace(0.0, DAY, 20)
    forward = fly(assumed_model, epochs, states, reflection=reflection)
    ends = np.array([forward.path(k)[-1] for k in range(2)])
    backward = fly(assumed_model, epochs[::-1], ends, reflection=reflection)
    for k in range(2):
        assert np.linalg.norm(backward.path(k)[-1, :3] - states[k, :3]) < within
        # The way back passes the same places.
        assert np.linalg.norm(backward.path(k)[:-1, :3] - forward.path(k)[-2::-1, :3], axis=1).max() < within


@pytest.fixture(scope="module")
def crowd():
    """Forty-one arcs, among them one that decays, one that explodes, some that join late or leave early."""
    rng = np.random.default_rng(1)
    count = 41
    states = np.array(
        [
            orbit(rng.uniform(350e3, 900e3), nu=rng.uniform(0.0, 6.0), i=rng.uniform(0.1, 3.0))
            for _ in range(count)
        ]
    )
    ballistic = rng.uniform(0.05, 0.2, count)
    states[5], ballistic[5] = orbit(135e3), 1.0
    states[11], ballistic[11] = orbit(300e3), -1e8
    states[17], ballistic[17] = orbit(220e3, e=0.7), 0.1
    states[23, :3] = np.nan
    epochs = np.array([0.0, 20.0, 40.0, 3000.0, 3100.0, 9000.0, 20_000.0])
    first, last = np.zeros(count, int), np.full(count, len(epochs) - 1)
    first[30:36], last[36:] = [1, 1, 2, 3, 3, 4], [1, 1, 3, 5, 4]
    last[29] = 0
    return epochs, states, ballistic, first, last


@pytest.fixture(scope="module")
def together(assumed_model, crowd):
    epochs, states, ballistic, first, last = crowd
    return fly(assumed_model, epochs, states, first=first, last=last, ballistic=ballistic)


def test_states_lie_where_the_arcs_say(crowd, together):
    _, _, _, first, last = crowd
    assert together.start.tolist() == np.concatenate([[0], np.cumsum(last - first)]).tolist()
    assert together.states.shape == (together.start[-1], 6)
    assert together.path(29).shape == (0, 6)
    assert np.all(np.isfinite(together.states), axis=1).tolist() == [
        bool(fine) for k in range(41) for fine in np.isfinite(together.path(k)[:, 0])
    ]


def test_lost_arcs_say_why_and_nobody_else_is_touched(together):
    lost = np.flatnonzero(together.status)
    assert lost.tolist() == [5, 11, 23]
    assert REASONS[together.status[5]] == "decayed below 120 km"
    for arc in (11, 23):
        assert together.status[arc] in (2, 3)
    assert np.all(np.isnan(together.path(23)))
    for arc in set(range(41)) - set(lost):
        assert np.all(np.isfinite(together.path(arc)))


@pytest.mark.parametrize("arc", [0, 4, 5, 6, 11, 12, 15, 16, 17, 23, 24, 31, 33, 37, 40])
def test_an_arc_flies_alone_as_among_others(assumed_model, crowd, together, arc):
    epochs, states, ballistic, first, last = crowd
    one = slice(arc, arc + 1)
    alone = fly(
        assumed_model, epochs, states[one], first=first[one], last=last[one], ballistic=ballistic[one]
    )
    assert alone.states.tobytes() == together.path(arc).tobytes()
    assert alone.status[0] == together.status[arc]


@pytest.mark.parametrize("threads", [1, 2])
def test_order_and_threads_change_nothing(assumed_model, crowd, together, threads):
    epochs, states, ballistic, first, last = crowd
    order = np.random.default_rng(2).permutation(len(states))
    shuffled = fly(
        assumed_model,
        epochs,
        states[order],
        first=first[order],
        last=last[order],
        ballistic=ballistic[order],
        threads=threads,
    )
    for place, arc in enumerate(order):
        assert shuffled.path(place).tobytes() == together.path(arc).tobytes()
        assert shuffled.status[place] == together.status[arc]


def test_joining_late_is_starting_there(assumed_model):
    """An arc gives what a run gives that begins where it joins, under the outlook of then."""
    epochs = np.array([0.0, 200.0, 1000.0, 5000.0])
    storms = np.multiply.outer([0.0, 40.0, 80.0], [1.0, 0.0, 0.03, 0.03])[:, None]
    model = assumed_model._replace(
        issued=epochs[:3], known=np.zeros(3, int), outlooks=assumed_model.activity + storms
    )
    states = np.array([orbit(500e3), orbit(420e3, nu=2.0), orbit(350e3)])
    all_three = fly(model, epochs, states, first=[0, 1, 2], last=[2, 3, 3])
    for k in range(3):
        alone = fly(model, epochs[k:], states[k : k + 1])
        assert all_three.path(k).tobytes() == alone.states[: 2 if k < 2 else 1].tobytes()
    calm = fly(assumed_model, epochs[2:], states[2:])
    assert np.linalg.norm((calm.states - all_three.path(2))[-1, :3]) > 0.1


def test_a_decaying_arc_has_states_until_it_decays(assumed_model):
    epochs = np.arange(0.0, 5 * HOUR, 300.0)
    arcs = fly(assumed_model, epochs, np.array([orbit(160e3, e=0.0005)]), ballistic=0.6)
    found = arcs.path(0)
    flown = np.isfinite(found[:, 0])
    assert REASONS[arcs.status[0]] == "decayed below 120 km"
    assert 0 < flown.sum() < len(flown)
    assert np.all(flown[: flown.sum()])
    altitude = np.linalg.norm(found[flown, :3], axis=1) - WGS84_A
    assert np.all(altitude > 95e3)  # over the equator's radius; the poles lie 21 km deeper
    assert altitude[-1] < 160e3
    assert np.all(np.isnan(found[~flown]))


@pytest.mark.parametrize("ceiling", [90.0, 900.0], ids=["on the grid", "in smaller steps"])
def test_an_orbit_that_dips_below_the_floor_is_lost_without_any_drag(kepler_model, ceiling):
    states = np.array([orbit(perigee, e=0.02, i=0.1, nu=np.pi) for perigee in (110e3, 130e3)])
    epochs = [0.0, 900.0, 1800.0, 2600.0, 5400.0]
    arcs = fly_freely(kepler_model, epochs, states, max_step_s=ceiling)
    assert [REASONS[status] for status in arcs.status] == ["decayed below 120 km", ""]
    assert np.isfinite(arcs.path(0)[:, 0]).tolist() == [True, True, False, False]
    assert np.all(np.isfinite(arcs.path(1)))


def test_a_state_too_far_to_mean_anything(assumed_model):
    arcs = fly(assumed_model, [0.0, 90.0], np.array([[2e12, 0.0, 0.0, 0.0, 1.0, 0.0]]))
    assert REASONS[arcs.status[0]] == "state not finite"
    assert np.all(np.isnan(arcs.states))


def test_a_step_below_the_minimum(assumed_model):
    wanting = Integrator(position_tolerance_m=1e-9, min_step_s=40.0)
    arcs = fly(assumed_model, [0.0, 90.0, 180.0], np.array([orbit(400e3)]), integrator=wanting)
    assert REASONS[arcs.status[0]] == "step below the minimum"
    assert np.all(np.isnan(arcs.states))


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_grid_hits_every_epoch_and_keeps_below_the_ceiling(sign):
    epochs = sign * np.array([0.0, 20.0, 110.0, 200.00001, 1234.5, 1235.0, 9999.0])
    times, index = ensemble._grid(epochs, np.empty(0), 90.0)
    np.testing.assert_array_equal(times[index], epochs)
    steps = sign * np.diff(times)
    assert np.all(steps > 0.0)
    assert np.all(steps <= 90.0 * (1.0 + 1e-8))
    # As few as that takes, and even between two epochs.
    assert np.diff(index).tolist() == [1, 1, 2, 12, 1, 98]
    for begin, end in pairwise(index):
        assert np.ptp(steps[begin:end]) < 1e-8


@pytest.mark.parametrize("way", [1, -1])
def test_no_step_has_midnight_in_it(assumed_model, way):
    """DTM2000's day of the year changes there, and the density with it."""
    midnights = assumed_model.midnight + DAY * np.arange(1, 4)
    epochs = (midnights[0] + np.array([-5000.0, -4000.0, 0.0, 40.0, DAY + 20_000.0]))[::way]
    states = np.array([orbit(300e3)])
    coarse, fine = (
        fly(assumed_model, epochs, states, reflection=0.0, integrator=Integrator(max_step_s=step)).path(0)
        for step in (90.0, 15.0)
    )
    assert np.linalg.norm(coarse[:, :3] - fine[:, :3], axis=1).max() < 1e-3
    over = assumed_model._replace(midnight=assumed_model.midnight + 0.5 * DAY)  # the same sky at noon
    assert np.linalg.norm(fly(over, epochs, states, reflection=0.0).path(0)[-1, :3] - fine[-1, :3]) > 1.0


def test_progress_ends_at_one(assumed_model):
    seen = []
    propagate(
        assumed_model,
        np.array([0.0, 60.0]),
        Departures(
            np.repeat(orbit(500e3)[None], 40, axis=0),
            first=np.zeros(40, int),
            last=np.ones(40, int),
            ballistic=np.zeros(40),
            reflection=np.zeros(40),
        ),
        integrator=Integrator(),
        progress=seen.append,
    )
    assert seen == sorted(seen)
    assert seen[-1] == 1.0
