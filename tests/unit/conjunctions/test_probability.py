"""The probability of a collision: published cases, another integration, dilution, and what is no case."""

import numpy as np
import pytest
from scipy.integrate import dblquad
from scipy.stats import ncx2
from support import refusals

from opml.base.errors import InputError
from opml.conjunctions.probability import Encounter, chance, in_plane, integral


def encounter(position=(100.0, 50.0, 0.0), sigma=(200.0, 900.0, 50.0), radius=10.0, speed=1e4):
    """Return an encounter with the motion along z."""
    covariance = np.diag(np.square(sigma))
    return Encounter(np.array(position), np.array([0.0, 0.0, speed]), covariance, radius)


@pytest.mark.parametrize("ratio", [1.0, 3.0, 40.0, 1e4])
@pytest.mark.parametrize("radius", [0.01, 1.0, 30.0])
def test_the_integral_is_that_over_the_circle(ratio, radius):
    middle, sigmas = np.array([1.3, -0.4]), np.array([1.0, 1.0 * ratio])

    def density(y, x):
        return np.exp(-0.5 * np.sum(((np.array([x, y]) - middle) / sigmas) ** 2)) / (2 * np.pi * ratio)

    x = max(-radius, middle[0] - 12.0), min(radius, middle[0] + 12.0)
    expected, _ = dblquad(
        density,
        *x,
        lambda x: -np.sqrt(radius**2 - x**2),
        lambda x: np.sqrt(radius**2 - x**2),
        epsrel=1e-9,
        epsabs=0.0,
    )
    assert integral(middle, sigmas, radius) == pytest.approx(expected, rel=1e-6)
    assert integral(middle[::-1], sigmas[::-1], radius) == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize("miss", [0.0, 1.0, 8.0, 30.0])
def test_a_round_covariance_has_a_known_probability(miss):
    """Rice's distribution, down to probabilities of 1e-190."""
    expected = ncx2.cdf(4.0, 2, miss**2)
    assert integral(np.array([miss, 0.0]), np.ones(2), 2.0) == pytest.approx(expected, rel=1e-6)


def test_only_what_lies_across_the_motion_counts():
    one, other = encounter(), encounter(position=(100.0, 50.0, 777.0), sigma=(200.0, 900.0, 5000.0))
    assert chance(one).probability == pytest.approx(chance(other).probability, rel=1e-12)
    miss, covariance = in_plane(one)
    assert np.linalg.norm(miss) == pytest.approx(np.hypot(100.0, 50.0))
    assert np.linalg.det(covariance) == pytest.approx((200.0 * 900.0) ** 2)


def test_a_wide_covariance_dilutes_the_probability():
    wide, narrow = (chance(encounter(sigma=np.full(3, sigma))) for sigma in (5000.0, 30.0))
    assert wide.is_diluted
    assert not narrow.is_diluted
    # For a circle that is small beside the miss, the largest is at sigma = miss / sqrt(2).
    assert wide.scale * 5000.0 == pytest.approx(np.hypot(100.0, 50.0) / np.sqrt(2.0), rel=0.01)
    assert wide.most == pytest.approx(narrow.most, rel=1e-6)
    assert wide.probability < wide.most > narrow.probability


def test_a_covariance_that_is_none_is_widened_and_told():
    assert not chance(encounter()).mended
    flat = chance(encounter(position=(3.0, 0.0, 0.0), sigma=(0.0, 0.0, 0.0)))
    assert flat.mended
    assert flat.probability == pytest.approx(1.0)
    wrong = Encounter(np.array([3.0, 0, 0]), np.array([0, 0, 1e4]), np.diag([400.0, -1e-6, 1.0]), 10.0)
    assert chance(wrong).mended
    assert 0.0 < chance(wrong).probability < 1.0


def test_an_encounter_lasts_as_the_place_along_the_motion_is_uncertain():
    """Of a place along the motion that is uncertain by 50 m, and together with that across it by less."""
    assert encounter().duration == pytest.approx(2.0 * (5.73 * 50.0 + 10.0) / 1e4, rel=0.01)
    assert encounter(speed=0.5).duration == pytest.approx(2e4 * encounter().duration)
    tied = encounter()
    tied.covariance[2, 0] = tied.covariance[0, 2] = 0.8 * 200.0 * 50.0
    assert tied.duration == pytest.approx(2.0 * (5.73 * 0.6 * 50.0 + 10.0) / 1e4, rel=0.02)
    assert encounter(speed=0.0).duration == np.inf
    tied.covariance[2, 2] = -100.0
    assert tied.duration > 1e100


@pytest.mark.parametrize(("changes", "expected"), refusals("encounters"))
def test_no_encounter_is_refused(changes, expected):
    with pytest.raises(InputError, match=expected):
        encounter(**changes)
