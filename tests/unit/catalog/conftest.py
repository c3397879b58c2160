"""Orbits, tracks and fits that tests of what stations measure share."""

from dataclasses import replace

import pytest
from fits import fitted

from opml.base.constants import DAY
from opml.catalog.propagator import Propagator
from opml.catalog.simulate import tracking, truth


@pytest.fixture(scope="session")
def smooth(iss):
    """The RSO without radiation pressure, whose edge of the shadow makes two grids differ by a decimetre."""
    return replace(iss, cr=0.0)


@pytest.fixture(scope="session")
def smooth_orbit(assumed_model, smooth):
    """A day of it."""
    return truth.simulate(Propagator(assumed_model, smooth), duration=DAY, step=20.0)


@pytest.fixture(scope="session")
def known_propagator(assumed_model, iss):
    """The RSO under the assumed model, which errs in nothing here."""
    return Propagator(assumed_model, iss)


@pytest.fixture(scope="module")
def rows(orbit, earth_orientation, three_stations):
    """Tracks of three radars of a module's orbit."""
    return tracking.simulate(orbit, earth_orientation, three_stations, rso="iss", seed=1)


@pytest.fixture(scope="session")
def known_orbit(known_propagator):
    """A day of it."""
    return truth.simulate(known_propagator, duration=DAY, step=20.0)


@pytest.fixture(scope="session")
def known_rows(known_orbit, earth_orientation, three_stations):
    """Its tracks of three radars."""
    return tracking.simulate(known_orbit, earth_orientation, three_stations, rso="iss", seed=1)


@pytest.fixture(scope="session")
def fits_to(known_propagator, known_orbit, earth_orientation, three_stations):
    """The table of estimates of rows, with settings, and how far they are `off` [m]."""

    def fit(rows, settings):
        return fitted(known_propagator, known_orbit, rows, earth_orientation, three_stations, settings)

    return fit
