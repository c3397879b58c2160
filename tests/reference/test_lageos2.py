"""Tides and relativity on an orbit that nobody simulated: LAGEOS-2 by laser ranging, fitted and predicted."""

import numpy as np
import pytest
from support import ASSUMED_BODIES, shared

import opml
from opml.base.constants import DAY
from opml.dynamics.ensemble import Departures, propagate
from opml.interop import truth_from_orbit
from opml.interop.orbit_from_files import OrbitFiles
from opml.orbits.elements import in_rsw
from opml.tables import STATE

EPOCH, DAYS, FITTED_DAYS = "2016-03-13T00:00:07", 6.9, 2.0
AREA_TO_MASS, CD, CR = 0.000697, 2.2, 1.12
STEPS = np.array([1.0, 1.0, 1.0, 1e-3, 1e-3, 1e-3, 1e-4, 1e-4])
"""By which state [m, m/s], Cd A/m and Cr A/m [m2/kg] are moved to see what they do."""


@pytest.fixture(scope="module")
def orbit():
    """Times [s] and GCRF states of the orbit, every 20 minutes."""
    paths = sorted(shared("real").glob("sp3/ilrsa.*"))
    table, _ = truth_from_orbit.truth(OrbitFiles(paths, EPOCH, DAYS * DAY), step=1200.0)
    return table["t"].to_numpy(), table[STATE].to_numpy()


@pytest.fixture(scope="module")
def environment():
    return opml.make_environment(EPOCH, days=7, degree=20)


def states_at(model, t, parameters):
    """GCRF states (arcs, n, 6) at times t from initial states and coefficients (arcs, 8)."""
    count = len(parameters)
    first, last = np.zeros(count, int), np.full(count, len(t) - 1)
    departures = Departures(parameters[:, :6], first, last, parameters[:, 6], parameters[:, 7])
    arcs = propagate(model, t, departures, integrator=opml.Integrator(position_tolerance_m=1e-3))
    return np.array([np.vstack([parameters[k, :6], arcs.path(k)]) for k in range(count)])


def predicted(model, t, states):
    """Root mean square errors along R, S and W [m] of what follows the positions that are fitted."""
    fitted = t <= FITTED_DAYS * DAY
    found = np.append(states[0], [CD * AREA_TO_MASS, CR * AREA_TO_MASS])
    for _ in range(4):
        flown = states_at(model, t, found + np.vstack([np.zeros(8), np.diag(STEPS)]))[:, fitted, :3]
        design = (flown[1:] - flown[0]).reshape(8, -1).T
        found = found + STEPS * np.linalg.lstsq(design, (states[fitted, :3] - flown[0]).ravel())[0]
    errors = in_rsw(states_at(model, t, found[None])[0] - states, states)[~fitted]
    return np.sqrt((errors**2).mean(axis=0))[:3]


def test_lageos_2_is_predicted_ten_times_as_well_with_tides_and_relativity(orbit, environment):
    without, tides, both = (
        predicted(
            opml.force_model(environment, degree=20, order=20, third_bodies=ASSUMED_BODIES, **options), *orbit
        )
        for options in ({}, {"forces": ["solid_tides"]}, {"forces": ["solid_tides", "relativity"]})
    )
    assert without[1] > 1.5
    assert without[2] > 2.5
    # The radius follows from the period by Kepler's law, which relativity bends by some centimetres.
    assert both[0] < 0.6 * tides[0]
    assert both[1] < 0.3
    assert both[2] < 0.5
