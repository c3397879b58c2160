"""Along-track corrections of a path: where they put it, its velocity and its energy."""

import numpy as np
import pandas as pd
import pytest

from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.ephemerides.along_track_shift import (
    LEAST_EPOCHS,
    check_smooth,
    corrected,
    corrected_by_each,
    radial_part,
)
from opml.ephemerides.paths import Paths
from opml.orbits.elements import cartesian_from_coe, coe_from_cartesian, in_rsw
from opml.tables import STATE

GM = 3.986004415e14
T = 60.0 * np.arange(3 * 1440)
AXIS = 6.8e6
RATE = np.sqrt(GM / AXIS**3)


def orbit(a=AXIS, e=1e-3, argp=0.3, ahead=0.0):
    """Kepler's orbit (n, 6), `ahead` [rad] of where it would be, for small e to its second order."""
    mean = np.sqrt(GM / a**3) * T + ahead
    nu = mean + 2.0 * e * np.sin(mean) + 1.25 * e**2 * np.sin(2.0 * mean)
    coe = np.stack([*np.broadcast_arrays(a, e, 0.9, argp, 1.2, nu)], axis=-1)
    return cartesian_from_coe(coe, GM)


@pytest.fixture(scope="module")
def drifting():
    """(truth, prediction, corrected by the along-track error) of an orbit 20 m too high, less eccentric."""
    true, predicted = orbit(), orbit(a=AXIS + 20.0, e=1e-3 - 1e-5)
    along = in_rsw(predicted - true, true)[:, 1]
    return true, predicted, corrected(T, predicted, along)


def test_along_track_nothing_is_left(drifting):
    true, predicted, found = drifting
    before, after = (np.abs(in_rsw(one - true, true)).max(axis=0) for one in (predicted, found))
    assert before[1] > 8000.0
    assert after[1] < 0.1


def test_the_radial_error_goes_with_it(drifting):
    true, predicted, found = drifting
    before, after = (np.abs(in_rsw(one - true, true)[:, 0]).max() for one in (predicted, found))
    assert before > 80.0
    assert after < 0.02 * before


def test_velocity_is_that_of_the_path_and_of_the_truth(drifting):
    true, predicted, found = drifting
    # Central differences of the eighth order, far from the ends.
    weights = np.array([1 / 280, -4 / 105, 1 / 5, -4 / 5, 0.0, 4 / 5, -1 / 5, 4 / 105, -1 / 280]) / 60.0
    path = sum(weight * found[k : len(T) - 8 + k, :3] for k, weight in enumerate(weights))
    np.testing.assert_allclose(path, found[4:-4, 3:], rtol=0, atol=2e-4)
    before, after = (np.abs(one[:, 3:] - true[:, 3:]).max() for one in (predicted, found))
    assert before > 8.0
    assert after < 5e-3


def test_the_orbit_has_the_energy_of_the_truth(drifting):
    true, predicted, found = drifting
    axes = [coe_from_cartesian(one, GM)[:, 0] for one in (true, predicted, found)]
    assert np.median(np.abs(axes[1] - axes[0])) == pytest.approx(20.0, abs=0.1)
    assert np.median(np.abs(axes[2] - axes[0])) < 0.5


def test_a_part_of_a_path_is_corrected_as_the_whole(drifting):
    true, predicted, found = drifting
    along = in_rsw(predicted - true, true)[:, 1]
    (part,) = corrected_by_each(T, predicted, along[None], slice(2000, 2200))
    np.testing.assert_allclose(part[60:-60], found[2060:2140], rtol=0, atol=1e-6)


def test_an_ephemeris_of_steps_of_five_minutes_misses_where_the_whole_path_does(drifting):
    """Of a path, what is near a time tells the miss: of several times, what is between them, too."""
    true, predicted, _ = drifting
    along = in_rsw(predicted - true, true)[:, 1]
    table = pd.DataFrame(predicted, columns=STATE).assign(t_j=T, t_i=0.0, morning=0.0, e_y_mine=along)
    path = Paths(table[::5])
    later = dict(zip(STATE, true.T, strict=True)) | {"t_j": T}
    misses = [
        pd.DataFrame(path.differences({name: values[rows] for name, values in later.items()}))
        for rows in ([9, 2003, 4300], [2003])
    ]
    pd.testing.assert_frame_equal(misses[0].iloc[[1]].reset_index(drop=True), misses[1], rtol=0, atol=1e-6)
    assert (misses[0]["before"].abs() > 10.0).all()
    assert misses[1]["e_y"].abs().item() < 0.2


def test_a_drift_tells_a_height_and_a_swing_an_eccentricity():
    radius = np.full(len(T), AXIS)
    drift = radial_part(T, -1.5 * 20.0 / AXIS * T, radius)
    np.testing.assert_allclose(drift, 20.0, rtol=1e-6)
    swing = radial_part(T, 2.0 * 30.0 / AXIS / RATE * np.sin(RATE * T), radius)
    middle = slice(500, -500)
    np.testing.assert_allclose(swing[middle], -30.0 * np.cos(RATE * T)[middle], atol=0.5)


def test_without_an_error_nothing_moves():
    states = orbit()
    np.testing.assert_allclose(corrected(T, states, np.zeros(len(T))), states, rtol=0, atol=1e-6)


def test_a_correction_with_steps_is_no_path():
    stairs = 100.0 * np.floor(T / (0.25 * DAY))
    with pytest.raises(InputError, match=r"expected a correction that is smooth in time, .* steps of \d+"):
        check_smooth(T, stairs)
    check_smooth(T, 1e4 * np.sin(T / 5400.0))
    # As SGP4 differs from all forces at 450 km: a spline's ends are four times farther off.
    sparse = 5.0 * T
    check_smooth(sparse, 5.0 * np.sin(2.0 * np.pi * sparse / 1400.0))


def test_a_path_needs_some_epochs():
    few = slice(0, LEAST_EPOCHS - 1)
    with pytest.raises(InputError, match="expected at least 16 epochs to correct, got 15"):
        corrected(T[few], orbit()[few], np.zeros(LEAST_EPOCHS - 1))
