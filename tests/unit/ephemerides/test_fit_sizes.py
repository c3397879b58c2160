"""Sizes of errors of fits: typical ones without a past, scaled by it part by part."""

import numpy as np
import pandas as pd
import pytest

from opml.base.constants import DAY, SRP_PRESSURE, WGS84_A
from opml.ephemerides import fit_sizes
from opml.ephemerides.fit_sizes import FitSizes
from opml.orbits.sheets import Rso
from opml.tables import DOUBT, PARAMETER_COVARIANCES, SIGMA_STATE, STATE

RATE = 0.0011
LEADS = np.array([0.5, 1.0, 3.0, 7.0])


def estimates(*, cd=1.0, sigma_cd=0.01, rise=0.0, swing=0.0, inclination=0.0, rms=1.0):
    """Fits over 12 and 48 h of one track on a circular orbit, 0.1 m in each position."""
    state = [7e6, 0.0, 0.0, 0.0, 7e6 * RATE * np.cos(inclination), 7e6 * RATE * np.sin(inclination)]
    columns = dict.fromkeys(PARAMETER_COVARIANCES, 0.0)
    columns |= {f"cov_{axis}_{axis}": 0.01 for axis in "xyz"} | {"cov_cd_cd": sigma_cd**2}
    columns |= {"cov_vy_vy": max(rise, swing) ** 2, "cov_vz_vz": swing**2}
    row = {
        "track": 4,
        "t": 2 * DAY,
        "converged": True,
        "weighted_rms": rms,
        "cd": cd,
        **dict(zip(STATE, state, strict=True)),
    }
    rows = [row | columns | {"window_hours": hours} for hours in (12.0, 48.0)]
    first = row | columns | {"track": 0, "t": 0.0, "window_hours": 12.0}
    return pd.DataFrame([first, *rows])


def causes(days):
    """Drag and weather that grow by the square of the days, along the track alone."""
    along = 10.0 * np.asarray(days) ** 2
    parts = {f"{name}_{axis}": along * (axis == "y") for name in ("drag", "weather") for axis in "xyz"}
    return pd.DataFrame(parts).assign(duration=DAY * np.asarray(days), rate=RATE)


def formal(area_to_mass=0.0, **known):
    rso = Rso("one", *[0.0] * 6, area_to_mass=area_to_mass, cd=1.0, cr=1.25)
    daily = pd.Series({4: 10.0})
    return fit_sizes.formal_errors(estimates(**known), daily, base=12.0, rso=rso, light=fit_sizes.GUESSED)


def past(errors, days):
    """Rows of what ephemerides of track 4 were off by along the track."""
    rows = causes(days).assign(i=4, morning=0.0, e_y=errors, t_known=DAY, t_j=DAY, model="fit48")
    others = dict.fromkeys(["e_x", "e_z", *DOUBT, *SIGMA_STATE], 0.0)
    return rows.assign(**others)


def sigmas(rows, known=None):
    known = formal() if known is None else known
    return FitSizes.learned(known.loc[4], rows, known).sigmas(causes(LEADS))[:, :3]


def test_what_misses_its_measurements_is_known_no_better():
    assert formal(rms=100.0)["a_x"].item() == pytest.approx(np.hypot(fit_sizes.CONSTANT[0], 10.0))
    assert formal(rms=1.2).equals(formal())


def test_without_a_past_they_are_the_usual_ones():
    expected = np.sqrt(
        0.01
        + fit_sizes.CONSTANT[1] ** 2
        + (fit_sizes.DAILY * 10.0) ** 2
        + formal()["b_y"].item() ** 2 * LEADS**2
        + (formal()["c"].item() ** 2 + fit_sizes.WEATHER**2) * (10.0 * LEADS**2) ** 2
    )
    np.testing.assert_allclose(sigmas(past([], []))[:, 1], expected)


def test_an_orbit_of_unknown_height_drifts():
    # Higher by x it falls back by 3 n x, faster by v by 3 v.
    drift = 3.0 * DAY * np.hypot(0.1 * RATE, 0.02)
    np.testing.assert_allclose(formal(rise=0.02)["b_y"], np.hypot(fit_sizes.RATE[1], drift))


def test_a_plane_is_known_by_the_velocity_across_it_and_its_node_goes_on():
    plane = np.sqrt(0.5 * (0.1**2 + (0.02 / RATE) ** 2))
    for inclination in (0.0, 1.0, np.pi / 2):
        known = formal(swing=0.02, inclination=inclination)
        np.testing.assert_allclose(known["a_z"], np.hypot(fit_sizes.CONSTANT[2], plane))
        # What the node of this orbit regresses by, by a difference of the inclination.
        turn = [1.5 * fit_sizes.J2 * (WGS84_A / 7e6) ** 2 * RATE * np.cos(inclination + d) for d in (0, 1e-6)]
        daily = (turn[0] - turn[1]) / 1e-6 * np.sin(inclination) * DAY / np.sqrt(2.0)
        np.testing.assert_allclose(known["b_z"], np.hypot(fit_sizes.RATE[2], plane * daily), rtol=1e-5)


def test_light_of_a_body_that_is_a_guess_makes_an_orbit_eccentric():
    # Twice as far along the track as radially; what fits take half a day of has a quarter of a day of it.
    known, dark = formal(area_to_mass=0.02), formal()
    daily = fit_sizes.GUESSED * 1.5 * SRP_PRESSURE * 1.25 * 0.02 / RATE * DAY / np.sqrt(2.0)
    for axis, times in (("x", 1.0), ("y", 2.0), ("z", 0.0)):
        more = {name: known[f"{name}_{axis}"] ** 2 - dark[f"{name}_{axis}"] ** 2 for name in "ab"}
        np.testing.assert_allclose(more["b"], (times * daily) ** 2, atol=1e-9)
        np.testing.assert_allclose(more["a"], (times * daily / 4.0) ** 2, atol=1e-9)


@pytest.mark.parametrize("sigma_cd", [0.05, 0.2])
def test_a_doubtful_cd_is_doubtful_drag(sigma_cd):
    np.testing.assert_allclose(
        formal(sigma_cd=sigma_cd)["c"], np.hypot(fit_sizes.DENSITY, 10.0 * sigma_cd), rtol=0.05
    )
    assert formal(sigma_cd=9.0)["c"].item() == fit_sizes.VAGUE


def test_a_past_scales_the_part_that_it_shows():
    usual = sigmas(past([], []))
    low = sigmas(past(np.full(40, 1.0), np.linspace(3.0, 7.0, 40)))
    high = sigmas(past(np.full(40, 3e3), np.linspace(3.0, 7.0, 40)))
    assert (low[2:, 1] < 0.95 * usual[2:, 1]).all()
    assert (high[2:, 1] > 2.0 * usual[2:, 1]).all()
    # Errors of the first hours are of the fit, and say less of drag.
    soon = sigmas(past(np.full(40, 300.0), np.full(40, 0.1)))[:, 1] / usual[:, 1]
    assert soon[0] > 1.5 * soon[-1] > 1.5


def test_a_past_from_another_start_does_not_count():
    other = past(np.full(40, 3e3), np.linspace(3.0, 7.0, 40)).assign(i=3)
    np.testing.assert_array_equal(sigmas(other), sigmas(other[:0]))


def test_sizes_come_back_from_their_row():
    rows = past(np.full(40, 3e3), np.linspace(3.0, 7.0, 40))
    sizes = FitSizes.learned(formal().loc[4], rows, formal())
    back = FitSizes.from_row(sizes.row)
    np.testing.assert_array_equal(back.sigmas(causes(LEADS)), sizes.sigmas(causes(LEADS)))
