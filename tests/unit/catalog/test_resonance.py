"""Drift by left-out harmonics: against sums made by hand, and against arcs with and without an order."""

import numpy as np
import pandas as pd
import pytest
from fits import on_orbit
from support import ASSUMED_BODIES, EPOCH, environment

from opml.base.constants import DAY, EARTH_RATE, HOUR
from opml.catalog.predict import resonance
from opml.catalog.predict.resonance import Resonances
from opml.dynamics import forces
from opml.dynamics.ensemble import Departures, propagate
from opml.dynamics.run_environment import Environment
from opml.dynamics.settings import ForceModelSettings, Integrator
from opml.environment import gravity_field
from opml.orbits.elements import cartesian_from_coe, rsw_rotation
from opml.tables import STATE

GM = 3.986004415e14
A = 6.77e6
PAIRS = ((1, 15), (2, 31))


def states(t):
    return pd.DataFrame(on_orbit(t, GM, a=A, e=1e-4), columns=STATE)


def tables(t):
    """Estimates at `t` and predictions among them, all on one Kepler orbit."""
    estimates = states(t).assign(track=np.arange(len(t)), t=t)
    i, j = np.triu_indices(len(t), 1)
    pairs = states(t[j]).assign(i=i, j=j, t_i=t[i], t_j=t[j])
    return estimates, pairs


def test_names_say_the_pair():
    assert resonance.columns(PAIRS) == ["cos_1_15", "sin_1_15", "cos_2_31", "sin_2_31"]


@pytest.mark.parametrize("hours", [12, 36])
def test_drift_is_the_double_integral_less_the_line_through_the_window(hours):
    t = np.array([0.0, 0.4, 1.3, 2.2, 3.9, 5.0]) * DAY
    estimates, pairs = tables(t)
    found = resonance.drifts(estimates, pairs, Resonances(PAIRS, hours, GM))
    assert list(found) == resonance.columns(PAIRS)
    n = np.sqrt(GM / A**3)
    for k, m in PAIRS:
        for i, j in ((0, 5), (2, 3)):
            row = np.flatnonzero((pairs["i"] == i) & (pairs["j"] == j))[0]
            # In closed form, up to a line, which is taken off anyway.
            rate = k * n - m * EARTH_RATE
            start = k * (0.3 + n * t[i]) + m * (1.2 - EARTH_RATE * t[i])
            s = np.arange(-hours * HOUR, 1.0, resonance.PHASE_STEP)
            line = np.polyfit(s, -np.exp(1j * (start + rate * s)) / rate**2, 1)
            span = t[j] - t[i]
            expected = -np.exp(1j * (start + rate * span)) / rate**2 - np.polyval(line, span)
            drift = found[f"cos_{k}_{m}"][row] + 1j * found[f"sin_{k}_{m}"][row]
            assert abs(drift - expected) < 1e-3 * (abs(expected) + 0.05 / rate**2)


def test_knows_nothing_that_comes_after_the_prediction():
    t = np.array([0.0, 0.4, 1.3, 2.2, 3.9, 5.0]) * DAY
    estimates, pairs = tables(t)
    whole = resonance.drifts(estimates, pairs, Resonances(PAIRS, 24, GM))
    later = estimates["track"] >= 3
    estimates.loc[later, STATE] *= 1.001
    again = resonance.drifts(estimates, pairs, Resonances(PAIRS, 24, GM))
    pd.testing.assert_frame_equal(whole[pairs["i"] < 3], again[pairs["i"] < 3], check_exact=True)


def field(*, order):
    """EGM2008 to degree 20, with or without one order of the degrees above."""
    read = gravity_field.read_icgem(gravity_field.resolve("EGM2008"))
    table = gravity_field.table(read, EPOCH)
    kept = (table["n"] <= 20) | (table["m"] == order)
    surroundings = Environment(
        EPOCH, **environment(), gravity_field=table[kept & (table["n"] <= 40)], gm=read.gm, radius=read.radius
    )
    return forces.build(
        surroundings, ForceModelSettings(degree=40, order=40, third_bodies=list(ASSUMED_BODIES))
    )


@pytest.mark.parametrize(("k", "m"), [(1, 15), (2, 31)])
def test_a_left_out_order_makes_the_drift_that_the_columns_describe(k, m, iss):
    # Arcs of both fields part at the estimate, both ways; a line through the window is taken off.
    hours, t = 24, np.arange(0.0, 6.01, 0.25) * DAY
    truth, assumed = field(order=m), field(order=None)
    coe = np.array([[iss.a, iss.e, iss.i, iss.argp, iss.raan, 0.5]])
    start = cartesian_from_coe(coe, GM)[0]

    def flown(model, epochs):
        arc = propagate(
            model,
            epochs,
            Departures(start[None], first=[0], last=[len(epochs) - 1], ballistic=[0.0], reflection=[0.0]),
            integrator=Integrator(),
        )
        return np.vstack([start, arc.path(0)])

    at = 2.0 * DAY
    back = at - np.arange(0.0, hours * HOUR + 1.0, 900.0)
    ahead = at + t
    parted = {}
    for name, epochs in (("back", back), ("ahead", ahead)):
        predicted, true = flown(assumed, epochs), flown(truth, epochs)
        along = rsw_rotation(true)[:, 1]
        parted[name] = np.einsum("ni,ni->n", along, (predicted - true)[:, :3])
        if name == "ahead":
            arrived = predicted
    drift = parted["ahead"] - np.polyval(np.polyfit(back - at, parted["back"], 1), t)

    estimates = pd.DataFrame({"track": np.arange(len(t)), "t": ahead})
    estimates[STATE] = arrived
    pairs = pd.DataFrame({"i": 0, "j": np.arange(1, len(t)), "t_i": at, "t_j": ahead[1:]})
    pairs[STATE] = arrived[1:]
    found = resonance.drifts(estimates, pairs, Resonances([(k, m)], hours, GM))
    coefficient = np.linalg.lstsq(found.to_numpy(), drift[1:])[0]
    left = drift[1:] - found.to_numpy() @ coefficient
    assert np.abs(drift).max() > 200.0
    assert np.abs(left).sum() < 0.12 * np.abs(drift[1:]).sum()
