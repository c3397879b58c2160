"""Edges of the Earth's shadow within long steps: against SciPy, in steps that no edge can hide in."""

import numba
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from opml.base.constants import SRP_DISTANCE, SRP_PRESSURE, WGS84_A
from opml.dynamics.ensemble import Departures, propagate
from opml.dynamics.kernels import surroundings
from opml.dynamics.kernels.radiation_pressure import lit_part
from opml.dynamics.kernels.surroundings import BODIES, SUN_ITRF
from opml.dynamics.settings import Integrator
from opml.orbits.elements import cartesian_from_coe

REFLECTION = 6.0
"""A hundred times the paper's Cr A/m, so that what edges do stands out."""


@numba.njit(cache=True, error_model="numpy")
def _rates(t, y, model, values, factors):
    """Rates (6,) under central gravity and radiation pressure, and the part of the Sun in sight."""
    surroundings.look_up(t, model, values, factors)
    to_itrf = values[:9].copy().reshape(3, 3)
    at = to_itrf @ y[:3]
    lit = lit_part(at[0], at[1], at[2], values[SUN_ITRF : SUN_ITRF + 3])
    away = y[:3] - values[BODIES : BODIES + 3]
    push = SRP_PRESSURE * SRP_DISTANCE**2 * REFLECTION * lit * away / np.linalg.norm(away) ** 3
    return np.concatenate((y[3:], push - model.gm * y[:3] / np.linalg.norm(y[:3]) ** 3)), lit


def by_scipy(model, epochs, state, max_step):
    """States (epochs - 1, 6) in steps of `max_step` [s] at most; the part of the Sun in sight on the way."""
    values, factors = surroundings.allocate(model)

    def rates(t, y):
        return _rates(t, y, model, values, factors)

    solution = solve_ivp(
        lambda t, y: rates(t, y)[0],
        epochs[[0, -1]],
        state,
        dense_output=True,
        rtol=1e-13,
        atol=1e-9,
        max_step=max_step,
    )
    seen = {rates(t, y)[1] for t, y in zip(solution.t, solution.y.T, strict=True)}
    return solution.sol(epochs[1:]).T, seen


def orbit(model, altitude, across):
    """A nearly circular orbit over the subsolar point, its plane `across` [rad] from the Sun's direction."""
    sun = surroundings.sun(0.0, model)
    raan, height = np.arctan2(sun[1], sun[0]), np.arcsin(sun[2] / np.linalg.norm(sun))
    coe = np.array([WGS84_A + altitude, 0.001, 0.5 * np.pi - across, 0.0, raan, height])
    turned = coe.copy()
    turned[4] += across
    return cartesian_from_coe(turned, model.gm)


@pytest.mark.parametrize(
    ("altitude", "across", "hours", "steps"),
    [
        (400e3, 0.2, 3.0, (90.0, 180.0)),
        (400e3, 0.2, -3.0, (90.0,)),
        (400e3, 1.2, 3.0, (90.0,)),  # a short eclipse, its edges crossed at a slant
        (5900e3, 0.1, 3.0, (90.0,)),  # a penumbra of half a minute
    ],
)
def test_long_steps_are_as_good_as_short_ones(kepler_model, altitude, across, hours, steps):
    state = orbit(kepler_model, altitude, across)
    epochs = np.array([0.0, 0.37, 1.0]) * hours * 3600.0
    expected, seen = by_scipy(kepler_model, epochs, state, max_step=0.5)
    assert {0.0, 1.0} < seen
    coarse, _ = by_scipy(kepler_model, epochs, state, max_step=1.0)  # a reference that checks itself
    assert farthest(coarse, expected) < 0.001  # 0.68 mm seen
    for step in steps:
        path = propagate(
            kepler_model,
            epochs,
            Departures(state[None], first=[0], last=[2], ballistic=[0.0], reflection=[REFLECTION]),
            integrator=Integrator(max_step_s=step),
        ).path(0)
        assert farthest(path, expected) < 0.01  # 3.4 mm seen


def farthest(states, others):
    """The largest distance [m] between two paths (n, 6)."""
    return np.linalg.norm(states[:, :3] - others[:, :3], axis=1).max()
