"""Edges of the Earth's shadow within long steps: against SciPy, in steps that no edge can hide in."""

import numba
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from opml.base.constants import SRP_DISTANCE, SRP_PRESSURE, WGS84_A
from opml.dynamics.ensemble import Departures, propagate
from opml.dynamics.kernels import shadow_edges, surroundings
from opml.dynamics.kernels.radiation_pressure import lit_part
from opml.dynamics.kernels.surroundings import BODIES, SUN_ITRF
from opml.dynamics.settings import Integrator
from opml.orbits.elements import cartesian_from_coe

REFLECTION = 6.0
"""A hundred times the paper's Cr A/m, so that what edges do stands out."""


@numba.njit(cache=True, error_model="numpy")
def _sunlight(t, x, y, z, model, values, factors):
    """The Sun (3,) in GCRF and the part of it in sight."""
    surroundings.look_up(t, model, values, factors)
    r = values[:9].copy().reshape(3, 3)
    at = r @ np.array([x, y, z])
    return values[BODIES : BODIES + 3].copy(), lit_part(at[0], at[1], at[2], values[SUN_ITRF : SUN_ITRF + 3])


def by_scipy(model, epochs, state):
    """States (epochs - 1, 6) under central gravity and radiation pressure; the part in sight on the way."""
    values, factors = surroundings.allocate(model)

    def light(t, r):
        return _sunlight(t, *r, model, values, factors)

    def rates(t, y):
        sun, lit = light(t, y[:3])
        away = y[:3] - sun
        push = SRP_PRESSURE * SRP_DISTANCE**2 * REFLECTION * lit * away / np.linalg.norm(away) ** 3
        return np.concatenate([y[3:], -model.gm * y[:3] / np.linalg.norm(y[:3]) ** 3 + push])

    span = epochs[[0, -1]]
    found = solve_ivp(
        rates, span, state, method="DOP853", dense_output=True, rtol=1e-13, atol=1e-9, max_step_s=2.0
    )
    seen = [light(t, found.sol(t)[:3])[1] for t in np.linspace(*span, 1500)]
    return found.sol(epochs[1:]).T, np.array(seen)


def orbit(model, altitude, across):
    """A nearly circular orbit over the subsolar point, its plane `across` [rad] from the Sun's direction."""
    sun = surroundings.sun.py_func(0.0, model)
    raan, height = np.arctan2(sun[1], sun[0]), np.arcsin(sun[2] / np.linalg.norm(sun))
    coe = np.array([WGS84_A + altitude, 0.001, 0.5 * np.pi - across, 0.0, raan, height])
    turned = coe.copy()
    turned[4] += across
    return cartesian_from_coe(turned, model.gm)


@pytest.mark.parametrize(
    ("altitude", "across", "hours", "step", "within"),
    [
        (400e3, 0.2, 3.0, 90.0, 0.01),
        (400e3, 0.2, -3.0, 90.0, 0.01),
        (400e3, 0.2, 3.0, 180.0, 0.01),
        (400e3, 1.2, 3.0, 90.0, 0.01),  # a short eclipse, its edges crossed at a slant
        (5900e3, 0.1, 6.0, 90.0, 0.01),  # a penumbra of half a minute
    ],
)
def test_long_steps_are_as_good_as_short_ones(kepler_model, altitude, across, hours, step, within):
    state = orbit(kepler_model, altitude, across)
    epochs = np.array([0.0, 0.37, 1.0]) * hours * 3600.0
    expected, seen = by_scipy(kepler_model, epochs, state)
    assert {0.0, 1.0} < set(seen)
    found = propagate(
        kepler_model,
        epochs,
        Departures(state[None], first=[0], last=[2], ballistic=[0.0], reflection=[REFLECTION]),
        integrator=Integrator(max_step_s=step),
    ).path(0)
    assert np.linalg.norm(found[:, :3] - expected[:, :3], axis=1).max() < within


def test_the_path_goes_hermite_weights():
    """A polynomial of fifth degree is met exactly, from its values, slopes and curvatures at 0 and 1."""
    course = np.polynomial.Polynomial([1.0, -2.0, 0.5, 3.0, -1.0, 0.7])
    ends = [value for u in (0.0, 1.0) for value in (course(u), course.deriv(1)(u), course.deriv(2)(u))]
    places = np.linspace(0.0, 1.0, 7)
    np.testing.assert_allclose(shadow_edges._hermite_weights(places) @ ends, course(places), rtol=1e-12)
