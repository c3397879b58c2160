"""What SGP4 from one set is usually off: by hand, on histories that taught nothing, and its covariances."""

import numpy as np
import pytest
from support import shared

from opml.element_sets import catalogue
from opml.interop.element_sets import element_set, sgp4_errors
from opml.orbits.elements import bent_rsw
from opml.orbits.rsw_covariance import half_width, position_covariances

DAYS = np.array([0.0, 1.0, 7.0])
EPOCH = "2025-06-01T00:00:00"


def flown(height_km, *, bstar=1e-4, eccentricity=0.001):
    """A set of an orbit at a mean height."""
    motion = 60.0 * np.sqrt(3.986004418e14 / (6378137.0 + 1e3 * height_km) ** 3)
    return element_set.satellite(EPOCH, [motion, eccentricity, 1.2, 0.3, 0.4, 0.5, bstar])


def test_a_size_is_that_of_its_band_by_hand():
    satellite = flown(520.0)
    numbers = sgp4_errors.law()[3]  # 500 to 550 km
    drag = sgp4_errors.drag_displacement(satellite, DAYS)
    for axis, (constant, rate, share) in enumerate(numbers):
        by_hand = [
            np.sqrt(constant**2 + (rate * t) ** 2 + (share * d) ** 2) for t, d in zip(DAYS, drag, strict=True)
        ]
        assert sgp4_errors.usual_sigmas(satellite, DAYS)[:, axis] == pytest.approx(by_hand)


@pytest.mark.parametrize(
    ("satellite", "expected"),
    [
        (flown(520.0), True),
        (flown(250.0), False),
        (flown(1200.0), False),
        (flown(520.0, eccentricity=0.03), False),
    ],
    ids=["near", "low", "high", "eccentric"],
)
def test_only_orbits_like_those_learned_from_are_known(satellite, expected):
    assert sgp4_errors.are_known(satellite) is expected


def test_a_covariance_has_the_sizes_and_velocities_that_follow():
    satellite = flown(700.0)
    sigmas = sgp4_errors.expected(satellite, DAYS)
    states = sgp4_errors.sgp4_states(satellite, DAYS)
    found = position_covariances(sigmas, states)
    assert np.sqrt(np.diagonal(found, axis1=1, axis2=2))[:, :3] == pytest.approx(sigmas)
    rate = np.linalg.norm(states[:, 3:], axis=1) / np.linalg.norm(states[:, :3], axis=1)
    assert found[:, 3, 1] / found[:, 1, 1] == pytest.approx(-rate, rel=0.01)  # ahead by y: turned by y / r
    assert (np.linalg.eigvalsh(found) > 0.0).all()


def test_intervals_along_the_track_hold_on_histories_that_taught_nothing():
    inside = [one for name in ("Sentinel-3A", "CryoSat-2", "SARAL") for one in insides(name)]
    assert 0.85 < np.mean(inside) < 1.0


def insides(name):
    """Yield whether sets of a year at minimum are inside the intervals of those a week before at most."""
    sets = catalogue.read([shared(f"real/tle/dpshorten_{name}.tle.gz")], latency=0.0).daily()
    t = sets.table["t"].to_numpy()
    known = np.flatnonzero((t > 58119.0) & (t < 58484.0))  # 2018
    for first in known[:-8:20]:
        satellite, later = sets.satellites[first], first + np.arange(1, 8)
        sigmas = sgp4_errors.usual_sigmas(satellite, t[later] - t[first])
        judges = [sgp4_errors.sgp4_states(sets.satellites[judge], np.zeros(1))[0] for judge in later]
        flown = sgp4_errors.sgp4_states(satellite, t[later] - t[first])
        along = bent_rsw(flown[:, :3], np.array(judges))[:, 1]
        yield from np.abs(along) <= half_width(0.9) * sigmas[:, 1]
