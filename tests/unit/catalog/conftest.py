"""An orbit that tests of what stations measure share."""

from dataclasses import replace

import pytest

from opml.base.constants import DAY
from opml.catalog.flight import Flight
from opml.catalog.simulate import truth


@pytest.fixture(scope="session")
def smooth(iss):
    """The RSO without radiation pressure, whose edge of the shadow makes two grids differ by a decimetre."""
    return replace(iss, cr=0.0)


@pytest.fixture(scope="session")
def smooth_orbit(assumed_model, smooth):
    """A day of it."""
    return truth.simulate(Flight(assumed_model, smooth), duration=DAY, step=20.0)
