"""Fits that reckon with light time, compared with measurements whose light was followed by iteration."""

import numpy as np
import pytest
from fits import fitted, without_noise
from scipy.interpolate import CubicHermiteSpline
from support import BOUNDED_ESTIMATION as SETTINGS

from opml.base.constants import HOUR, SPEED_OF_LIGHT
from opml.catalog.fit.observations import Measured
from opml.catalog.propagator import Propagator
from opml.catalog.simulate import tracking
from opml.catalog.simulate.observing import observe, retarded, site
from opml.dynamics.frames import gcrf_to_itrf
from opml.tables import STATE

PLACE = STATE[:3]


@pytest.fixture(scope="module")
def orbit(smooth_orbit):
    return smooth_orbit


@pytest.fixture(scope="module")
def geometric(orbit, earth_orientation, three_stations):
    """Tracks without noise or light time."""
    return without_noise(tracking.simulate(orbit, earth_orientation, three_stations, rso="iss", seed=1))


@pytest.fixture(scope="module")
def sites(geometric, three_stations):
    """Position (n, 3) and rotation to the horizon (n, 3, 3) of each measurement's station."""
    places = {station.name: site(station) for station in three_stations}
    return tuple(np.array([places[name][k] for name in geometric["station"]]) for k in (0, 1))


def at(orbit, t):
    """Positions (n, 3) in GCRF between the orbit's states."""
    return CubicHermiteSpline(orbit["t"], orbit[PLACE], orbit[STATE[3:]])(t)


@pytest.fixture(scope="module")
def followed(orbit, geometric, sites, earth_orientation):
    """Where the light left (n, 3) ITRF [m], and its travel time (n,) [s], by iteration."""
    t = geometric["t"].to_numpy()
    to_itrf, travel = gcrf_to_itrf(earth_orientation, t), np.zeros(len(t))
    for _ in range(5):
        left = np.einsum("nij,nj->ni", to_itrf, at(orbit, t - travel))
        travel = np.linalg.norm(left - sites[0], axis=1) / SPEED_OF_LIGHT
    return left, travel


@pytest.fixture(scope="module")
def received(geometric, followed, sites):
    """The same tracks as they are received."""
    values = observe(followed[0], *sites)
    return geometric.assign(**dict(zip(tracking.QUANTITIES, values.T, strict=True)))


def estimates(model, orbit, rows, earth_orientation, stations, rso, **settings):
    settings = SETTINGS.evolve(convergence=1e-6, **settings)
    found = fitted(Propagator(model, rso), orbit, rows, earth_orientation, stations, settings)
    return found[found["tracks_used"] >= 3]


def off(found, orbit):
    """Errors (n, 2) [m]: ahead along the velocity, and the distance."""
    true = orbit.set_index("t").loc[found["t"], STATE].to_numpy()
    difference = found[PLACE].to_numpy() - true[:, :3]
    along = np.sum(difference * true[:, 3:], axis=1) / np.linalg.norm(true[:, 3:], axis=1)
    return np.column_stack([along, np.linalg.norm(difference, axis=1)])


def test_where_the_light_left(orbit, geometric, sites, followed, earth_orientation):
    t = geometric["t"].to_numpy()
    states = orbit.set_index("t").loc[t, STATE].to_numpy().reshape(-1, 2, 3)
    positions, velocities = np.einsum("nij,nkj->kni", gcrf_to_itrf(earth_orientation, t), states)
    found, _, travel = retarded(positions, velocities, sites[0])
    moved = np.linalg.norm(found - positions, axis=1)
    assert 10.0 < moved.min() < moved.max() < 70.0
    assert np.linalg.norm(found - followed[0], axis=1).max() < 2e-4
    np.testing.assert_allclose(travel, followed[1], atol=1e-12)


def test_a_fit_predicts_what_is_received(
    orbit, geometric, received, sites, earth_orientation, three_stations
):
    measured = Measured(geometric, earth_orientation, three_stations)
    window = measured.window(4, 12 * HOUR)
    states = orbit.set_index("t").loc[measured.epochs[window.first : window.last + 1], STATE].to_numpy()
    rows, states = window.rows, np.repeat(states[None], 8, axis=0)
    light = measured.evaluation(window, states, light_time=True)
    residuals = light.residuals.reshape(-1, 3) * measured.sigmas[rows]
    expected = (
        geometric[tracking.QUANTITIES].to_numpy()[rows] - received[tracking.QUANTITIES].to_numpy()[rows]
    )
    np.testing.assert_allclose(residuals[:, 2], expected[:, 2], atol=2e-3)
    np.testing.assert_allclose(residuals[:, :2], expected[:, :2], atol=1e-8)
    # What it is: the range's rate, of a station at rest, times the light's travel.
    t = measured.epochs[measured.epoch_of_row[rows]]
    flown = states[0, measured.epoch_of_row[rows] - window.first].reshape(-1, 2, 3)
    position, velocity = np.einsum("nij,nkj->kni", gcrf_to_itrf(earth_orientation, t), flown)
    away = position - sites[0][rows]
    distance = np.linalg.norm(away, axis=1)
    rate = np.sum(away * velocity, axis=1) / distance
    np.testing.assert_allclose(residuals[:, 2], rate * distance / SPEED_OF_LIGHT, atol=0.2)
    assert np.abs(residuals[:, 2]).max() > 30.0
    np.testing.assert_allclose(measured.evaluation(window, states).residuals, 0.0, atol=1e-6)


def test_light_time_on_both_sides_gives_the_truth(
    assumed_model, orbit, geometric, received, earth_orientation, three_stations, smooth
):
    given = assumed_model, orbit
    known = earth_orientation, three_stations, smooth
    both = estimates(*given, received, *known, light_time=True)
    neither = estimates(*given, geometric, *known)
    assert len(both) > 10
    assert both["converged"].all()
    assert off(both, orbit)[:, 1].max() < 1e-2
    # Partials have it too, so that it costs no iteration.
    assert both["iterations"].tolist() == neither["iterations"].tolist()


def test_light_time_on_one_side_moves_estimates_along_the_orbit(
    assumed_model, orbit, geometric, received, earth_orientation, three_stations, smooth
):
    given = assumed_model, orbit
    known = earth_orientation, three_stations, smooth
    ahead = off(estimates(*given, geometric, *known, light_time=True), orbit)
    behind = off(estimates(*given, received, *known), orbit)
    assert 20.0 < ahead[:, 0].min() < ahead[:, 0].max() < 70.0
    np.testing.assert_allclose(behind[:, 0], -ahead[:, 0], rtol=0.02)
