"""Orbits, tracks and fits that tests of what stations measure share."""

from dataclasses import replace

import numpy as np
import pytest

from opml.base.constants import DAY
from opml.catalog.fit import estimation, sightings, start_states
from opml.catalog.flight import Flight
from opml.catalog.simulate import tracking, truth
from opml.tables import STATE


@pytest.fixture(scope="session")
def smooth(iss):
    """The RSO without radiation pressure, whose edge of the shadow makes two grids differ by a decimetre."""
    return replace(iss, cr=0.0)


@pytest.fixture(scope="session")
def smooth_orbit(assumed_model, smooth):
    """A day of it."""
    return truth.simulate(Flight(assumed_model, smooth), duration=DAY, step=20.0)


@pytest.fixture(scope="session")
def known_flight(assumed_model, iss):
    """The RSO under the assumed model, which errs in nothing here."""
    return Flight(assumed_model, iss)


@pytest.fixture(scope="session")
def known_orbit(known_flight):
    """A day of it."""
    return truth.simulate(known_flight, duration=DAY, step=20.0)


@pytest.fixture(scope="session")
def known_rows(known_orbit, earth_orientation, three_stations):
    """Its tracks of three radars."""
    return tracking.simulate(known_orbit, earth_orientation, three_stations, rso="iss", seed=1)


@pytest.fixture(scope="session")
def fits_to(known_flight, known_orbit, earth_orientation, three_stations):
    """The table of estimates of rows, with settings, and how far they are `off` [m]."""

    def fitted(rows, settings):
        starts = start_states.perturbed(known_orbit, rows, rso="iss", settings=settings, seed=42)
        measured = sightings.Measured(rows, earth_orientation, three_stations)
        found = estimation.estimate_all(known_flight, starts, measured, settings=settings)
        true = known_orbit.set_index("t").loc[found["t"], STATE[:3]].to_numpy()
        return found.assign(off=np.linalg.norm(found[STATE[:3]].to_numpy() - true, axis=1))

    return fitted
