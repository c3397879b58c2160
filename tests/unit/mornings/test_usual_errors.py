"""Sizes of errors of fits: the usual ones without a past, scaled by it part by part."""

import numpy as np
import pandas as pd
import pytest

from opml.base.constants import DAY, SRP_PRESSURE, WGS84_A
from opml.mornings import usual_errors
from opml.mornings.records import Paths
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
    path = causes([0.5, 1.0, 7.0]).assign(i=4, t_i=0.0, morning=0.0)
    paths = [Paths(path.assign(t_j=path["duration"]))]
    return usual_errors.formal_errors(
        estimates(**known), paths, base=12.0, rso=rso, light=usual_errors.GUESSED
    )


def past(errors, days):
    """Rows of what ephemerides of track 4 were off by along the track."""
    rows = causes(days).assign(i=4, morning=0.0, e_y=errors, t_known=DAY, t_j=DAY, model="fit48")
    others = dict.fromkeys(["e_x", "e_z", *DOUBT, *SIGMA_STATE], 0.0)
    return rows.assign(**others)


def sigmas(rows, known=None):
    made = usual_errors.sizes(rows, formal() if known is None else known, start=4, now=2 * DAY)
    return made.sigmas(causes(LEADS))[:, :3]


def test_what_misses_its_measurements_is_known_no_better():
    assert formal(rms=100.0)["a_x"].item() == pytest.approx(np.hypot(usual_errors.CONSTANT[0], 10.0))
    assert formal(rms=1.2).equals(formal())


def test_without_a_past_they_are_the_usual_ones():
    expected = np.sqrt(
        0.01
        + usual_errors.CONSTANT[1] ** 2
        + (usual_errors.DAILY * 10.0) ** 2
        + formal()["b_y"].item() ** 2 * LEADS**2
        + (formal()["c"].item() ** 2 + usual_errors.WEATHER**2) * (10.0 * LEADS**2) ** 2
    )
    np.testing.assert_allclose(sigmas(past([], []))[:, 1], expected)


def test_an_orbit_of_unknown_height_drifts():
    # Higher by x it falls back by 3 n x, faster by v by 3 v.
    drift = 3.0 * DAY * np.hypot(0.1 * RATE, 0.02)
    np.testing.assert_allclose(formal(rise=0.02)["b_y"], np.hypot(usual_errors.RATE[1], drift))


def test_a_plane_is_known_by_the_velocity_across_it_and_its_node_goes_on():
    plane = np.sqrt(0.5 * (0.1**2 + (0.02 / RATE) ** 2))
    for inclination in (0.0, 1.0, np.pi / 2):
        known = formal(swing=0.02, inclination=inclination)
        np.testing.assert_allclose(known["a_z"], np.hypot(usual_errors.CONSTANT[2], plane))
        # What the node of this orbit regresses by, by a difference of the inclination.
        turn = [
            1.5 * usual_errors.J2 * (WGS84_A / 7e6) ** 2 * RATE * np.cos(inclination + d) for d in (0, 1e-6)
        ]
        daily = (turn[0] - turn[1]) / 1e-6 * np.sin(inclination) * DAY / np.sqrt(2.0)
        np.testing.assert_allclose(known["b_z"], np.hypot(usual_errors.RATE[2], plane * daily), rtol=1e-5)


def test_light_of_a_body_that_is_a_guess_makes_an_orbit_eccentric():
    # Twice as far along the track as radially; what fits take half a day of has a quarter of a day of it.
    known, dark = formal(area_to_mass=0.02), formal()
    daily = usual_errors.GUESSED * 1.5 * SRP_PRESSURE * 1.25 * 0.02 / RATE * DAY / np.sqrt(2.0)
    for axis, times in (("x", 1.0), ("y", 2.0), ("z", 0.0)):
        more = {name: known[f"{name}_{axis}"] ** 2 - dark[f"{name}_{axis}"] ** 2 for name in "ab"}
        np.testing.assert_allclose(more["b"], (times * daily) ** 2, atol=1e-9)
        np.testing.assert_allclose(more["a"], (times * daily / 4.0) ** 2, atol=1e-9)


@pytest.mark.parametrize("sigma_cd", [0.05, 0.2])
def test_a_doubtful_cd_is_doubtful_drag(sigma_cd):
    np.testing.assert_allclose(
        formal(sigma_cd=sigma_cd)["c"], np.hypot(usual_errors.DENSITY, 10.0 * sigma_cd), rtol=0.05
    )
    assert formal(sigma_cd=9.0)["c"].item() == usual_errors.VAGUE


def test_a_past_scales_the_part_that_it_shows():
    usual = sigmas(past([], []))
    low = sigmas(past(np.full(40, 1.0), np.linspace(3.0, 7.0, 40)))
    high = sigmas(past(np.full(40, 3e3), np.linspace(3.0, 7.0, 40)))
    assert (low[2:, 1] < 0.95 * usual[2:, 1]).all()
    assert (high[2:, 1] > 2.0 * usual[2:, 1]).all()
    # Errors of the first hours are of the fit, and say less of drag.
    soon = sigmas(past(np.full(40, 300.0), np.full(40, 0.1)))[:, 1] / usual[:, 1]
    assert soon[0] > 1.5 * soon[-1] > 1.5


def test_what_came_later_has_no_say():
    told = past(np.full(40, 3e3), np.linspace(3.0, 7.0, 40)).assign(t_known=3 * DAY, t_j=3 * DAY)
    np.testing.assert_array_equal(sigmas(told), sigmas(told[:0]))


def test_each_morning_states_what_was_known_on_it():
    first = past(np.full(4, 20.0), [1.0, 2.0, 3.0, 4.0])
    later = first.assign(morning=2 * DAY, t_known=9 * DAY)
    stated = usual_errors.with_sigmas(pd.concat([first, later], ignore_index=True), formal())
    expected = usual_errors.sizes(first[:0], formal(), start=4, now=0.0).sigmas(first)
    np.testing.assert_allclose(stated[SIGMA_STATE].to_numpy()[:4], expected)
    assert (stated["sigma_y"].to_numpy()[4:] < expected[:, 1]).all()
