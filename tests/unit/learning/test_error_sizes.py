"""How far corrected orbits may be off: what the past says, what may happen, and what few days are worth."""

import numpy as np
import pandas as pd
import pytest
from mornings import RATE, SIZES, replays
from scipy import optimize

from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.learning.judge import simplex_kernels
from opml.learning.judge.error_sizes import INSIDE, Sizes, widening
from opml.orbits import rsw_covariance
from opml.tables import COMPONENTS, SPREAD

AHEAD = pd.DataFrame({"duration": [DAY, 7.0 * DAY], "rate": RATE} | dict.fromkeys(SPREAD, 0.0))


def test_sizes_are_those_of_the_past():
    sizes = Sizes.learned(replays(days=60), now=60.0 * DAY)
    sigma = sizes.sigmas(AHEAD)
    np.testing.assert_allclose(sigma[:, 0], SIZES["e_x"], rtol=0.25)
    np.testing.assert_allclose(sigma[:, 1], [100.0, 700.0], rtol=0.25)
    np.testing.assert_allclose(sigma[:, 2], SIZES["e_z"], rtol=0.25)
    np.testing.assert_allclose(sigma[:, 3:], [[2e-2, 5e-3, 3e-2]] * 2, rtol=0.3)


@pytest.mark.parametrize("seed", range(4))
def test_the_compiled_simplex_ends_where_scipys_does(seed):
    draw, units = np.random.default_rng(seed), np.array([100.0, 100.0 / DAY, 1.0])
    duration = draw.uniform(0.0, 7.0 * DAY, 90)
    drag, still = 1e-9 * duration**2, 1e-18 * duration**4
    size, weight = np.abs(draw.normal(100.0, 900.0, 90)), draw.uniform(size=90) / 9e3

    def loss(logarithms):
        a, b, c = units * np.exp(logarithms)
        above = size - INSIDE * np.sqrt(a**2 + (b * duration) ** 2 + (c * drag) ** 2 + still)
        return np.sum(weight * np.maximum(0.9 * above, -0.1 * above)) + 1e-5 * np.sum(logarithms**2)

    start, options = np.array([-0.5, -1.0, -1.0]), {"maxiter": 400, "xatol": 1e-2, "fatol": 1e-6}
    least = optimize.minimize(loss, start, method="Nelder-Mead", options=options)
    errors = size, duration, drag, still, weight
    found = simplex_kernels.minimum(start, units, errors, INSIDE, 0.9)
    np.testing.assert_allclose(found[0], least.x, rtol=1e-9)


def test_the_weather_ahead_is_never_less_than_its_futures():
    past, now = replays(days=30), 30.0 * DAY
    calm, stormy = AHEAD, AHEAD.assign(weather_y=[500.0, 9000.0])
    before, after = (Sizes.learned(past, now=now).sigmas(rows)[:, 1] for rows in (calm, stormy))
    np.testing.assert_array_less(np.sqrt(before**2 + stormy["weather_y"] ** 2) * 0.9, after)


def test_sizes_are_wider_after_few_days():
    assert widening(np.array([7.0 * DAY]), 9.0)[0] == pytest.approx(2.920 / 1.645, abs=1e-3)
    assert widening(np.array([0.1 * DAY]), 400.0)[0] == pytest.approx(1.0, abs=0.01)
    short, long = (Sizes.learned(replays(days=days), now=days * DAY) for days in (14, 60))
    wider = short.sigmas(AHEAD)[1, 0] / long.sigmas(AHEAD)[1, 0]
    assert wider == pytest.approx(2.920 / 1.782, rel=0.2)


def test_beyond_the_longest_prediction_that_is_over_errors_grow_by_its_square():
    past = replays(days=30)
    short = past[past["duration"] < 3.0 * DAY]
    whole, cut = (Sizes.learned(one, now=30.0 * DAY) for one in (past, short))
    calm = AHEAD.assign(duration=[2.9 * DAY, 5.8 * DAY])
    np.testing.assert_allclose(cut.sigmas(calm)[0, 1] / whole.sigmas(calm)[0, 1], 1.0, rtol=0.3)
    assert cut.sigmas(calm)[1, 1] > 3.0 * cut.sigmas(calm)[0, 1]
    assert whole.sigmas(calm)[1, 1] < 2.5 * whole.sigmas(calm)[0, 1]


def test_drag_that_the_past_did_not_foretell_is_learned():
    """The error of 30 % of drag, in units of a tenth."""
    past = replays(days=40, along=0.0)
    displaced = 50.0 * (past["duration"] / DAY) ** 2
    rng = np.random.default_rng(2)
    past = past.assign(drag_y=displaced, e_y=3.0 * displaced * rng.normal(size=len(past)))
    sizes = Sizes.learned(past, now=40.0 * DAY)
    assert sizes.drag[1] == pytest.approx(3.0, rel=0.25)


def without_widening(sizes, rows):
    """Return what is stated of rows but for the factor of a short past: drawn errors do not overlap."""
    return sizes.sigmas(rows) / widening(rows["duration"].to_numpy(), sizes.days)[:, None]


def test_ellipsoids_of_each_duration_hold_nine_tenths_where_a_few_errors_are_far_larger():
    """On the first day a fifth of the errors is eight times as large, of all axes together."""
    past, rng = replays(days=60), np.random.default_rng(5)
    far = np.where((past["duration"] < 1.3 * DAY) & (rng.uniform(size=len(past)) < 0.2), 8.0, 1.0)
    past = past.assign(**{name: past[name] * far for name in ("e_x", "e_y", "e_z")})
    sizes = Sizes.learned(past, now=60.0 * DAY)
    first, last = past[past["duration"] < 1.3 * DAY], past[past["duration"] > 5.0 * DAY]
    for rows in (first, last):
        sigma = without_widening(sizes, rows)[:, :3]
        distance = np.sum((rows[["e_x", "e_y", "e_z"]].to_numpy() / sigma) ** 2, axis=1)
        assert np.mean(distance < 6.251) == pytest.approx(0.9, abs=0.04)


def test_the_doubt_of_later_estimates_is_no_part_of_a_size():
    """Errors compared with estimates that are 40 m off cross-track, and say so."""
    past = replays(days=40)
    noise = 40.0 * np.random.default_rng(4).normal(size=len(past))
    held = past.assign(e_z=past["e_z"] + noise, doubt_z=40.0)
    plain, doubted, trusted = (
        Sizes.learned(one, now=40.0 * DAY).sigmas(AHEAD)[0, 2]
        for one in (past, held, held.assign(doubt_z=0.0))
    )
    assert doubted == pytest.approx(plain, rel=0.3)
    assert trusted > 1.4 * plain


def test_the_newest_errors_weigh_most():
    calm, wild = replays(days=30, along=100.0), replays(days=15, along=400.0, seed=1, first=30)
    both = pd.concat([calm, wild], ignore_index=True)
    then, since = (Sizes.learned(both, now=day * DAY).sigmas(AHEAD)[1, 1] for day in (30, 45))
    assert since > 2.0 * then


def test_intervals_and_ellipsoids_of_another_month_hold_their_share():
    past, ahead = replays(days=40), replays(days=40, seed=7)
    sigma = without_widening(Sizes.learned(past, now=40.0 * DAY), ahead)
    covariance = rsw_covariance.rsw_covariances(sigma, ahead["rate"].to_numpy())[:, :3, :3]
    errors = ahead[list(COMPONENTS[:3])].to_numpy()
    distance = rsw_covariance.mahalanobis(errors, covariance)
    for day in (1.0, 3.0, 7.0):
        near = ((ahead["duration"] / DAY - day).abs() < 0.25).to_numpy()
        # 160 errors at each duration show a share to 2.4 %, and so do those that the sizes are from.
        inside = np.mean(np.abs(errors[near]) <= INSIDE * sigma[near, :3], axis=0)
        np.testing.assert_allclose([*inside, np.mean(distance[near] < 6.251)], 0.9, atol=0.1)


def test_what_is_known_later_moves_no_earlier_size():
    past = replays(days=10)
    later = past["t_known"] > 5.0 * DAY
    moved = past.assign(**{name: past[name].where(~later, 99.0 * past[name]) for name in COMPONENTS})
    first, again = (Sizes.learned(table, now=5.0 * DAY).sigmas(AHEAD) for table in (past, moved))
    np.testing.assert_array_equal(first, again)
    then, since = (Sizes.learned(table, now=9.0 * DAY).sigmas(AHEAD) for table in (past, moved))
    assert (since[:, 1] > then[:, 1]).all()


def test_no_past_no_sizes():
    with pytest.raises(InputError, match=r"sizes: expected 20 predictions that were over by day 1 to learn"):
        Sizes.learned(replays(), now=DAY)


def test_a_covariance_is_that_of_its_parts():
    """Many errors drawn from the parts have the covariance that is stated."""
    sigma, rate = np.array([[10.0, 500.0, 30.0, 0.02, 0.01, 0.03]]), np.array([RATE])
    (covariance,) = rsw_covariance.rsw_covariances(sigma, rate)
    draws = np.random.default_rng(0).multivariate_normal(np.zeros(6), covariance, size=20000)
    free = rsw_covariance.free_parts(draws, np.full(len(draws), RATE))
    np.testing.assert_allclose(free.std(axis=0), sigma[0], rtol=0.03)
    correlation = np.corrcoef(free.T) - np.eye(6)
    assert np.abs(correlation).max() < 0.03
    assert covariance[0, 1] == 0.0
    distance = rsw_covariance.mahalanobis(draws[:, :3], np.tile(covariance[:3, :3], (len(draws), 1, 1)))
    assert np.mean(distance < INSIDE**2) == pytest.approx(0.561, abs=0.02)  # chi-square(3) at 2.706


def test_a_circular_orbit_that_is_ahead_or_high_has_no_free_velocity():
    """Two states on circular orbits of one angular momentum per height, a small angle and height apart."""
    gm, radius = 3.986e14, 7e6
    rate = np.sqrt(gm / radius**3)
    angle = 1e-4
    there = np.array([radius * np.cos(angle), radius * np.sin(angle), 0.0])
    velocity = rate * radius * np.array([-np.sin(angle), np.cos(angle), 0.0])
    errors = np.array([[*there, *velocity]]) - [[radius, 0.0, 0.0, 0.0, rate * radius, 0.0]]
    free = rsw_covariance.free_parts(errors, np.array([rate]))
    assert np.abs(free[0, 3:]).max() < 1e-3 * rate * radius * angle
    assert rsw_covariance.rates(np.array([[radius, 0, 0, 0, rate * radius, 0.0]]))[0] == pytest.approx(rate)
