"""Elements, frames and anomalies: textbook cases, singular cases and round trips."""

import numpy as np
import pytest
from hypothesis import given, strategies as st
from support import refusal

from opml.orbits.elements import (
    cartesian_from_coe,
    coe_from_cartesian,
    in_rsw,
    mean_from_true_anomaly,
    true_from_mean_anomaly,
    wrap_half_turn,
    wrap_turn,
)

GM = 3.986004418e14


def angle(limit=2 * np.pi):
    return st.floats(0.0, limit, exclude_max=True)


def test_vallado_example_2_5():
    # Vallado, Fundamentals of Astrodynamics and Applications, 4th ed., example 2-5 (printed to these digits).
    state = 1e3 * np.array([6524.834, 6862.875, 6448.296, 4.901327, 5.533756, -1.976341])
    a, e, inclination, argp, raan, nu = coe_from_cartesian(state, GM)
    assert a == pytest.approx(36127.343e3, rel=1e-6)
    assert e == pytest.approx(0.832853, abs=1e-6)
    assert np.degrees([inclination, raan, argp, nu]) == pytest.approx(
        [87.870, 227.898, 53.38, 92.335], abs=6e-3
    )


def test_circular_orbit_counts_from_the_node():
    coe = coe_from_cartesian(cartesian_from_coe([7e6, 0.0, 1.0, 0.3, 0.5, 0.4], GM), GM)
    assert coe[3] == 0.0
    assert coe == pytest.approx([7e6, 0.0, 1.0, 0.0, 0.5, 0.7], rel=1e-12, abs=1e-12)


@pytest.mark.parametrize(("inclination", "longitude"), [(0.0, 0.3 + 0.5), (np.pi, 0.3 - 0.5)])
def test_equatorial_orbit_counts_from_the_x_axis(inclination, longitude):
    # Perigee 0.3 after a node at 0.5: its angle from the x axis in the sense of motion, either way round.
    coe = coe_from_cartesian(cartesian_from_coe([7e6, 0.1, inclination, 0.3, 0.5, 0.4], GM), GM)
    assert coe[4] == 0.0
    assert coe == pytest.approx([7e6, 0.1, inclination, longitude % (2 * np.pi), 0.0, 0.4], rel=1e-9)


def test_circular_equatorial_orbit_counts_from_the_x_axis():
    speed = np.sqrt(GM / 7e6)
    coe = coe_from_cartesian(np.array([0.0, 7e6, 0.0, -speed, 0.0, 0.0]), GM)
    assert coe == pytest.approx([7e6, 0.0, 0.0, 0.0, 0.0, np.pi / 2], rel=1e-12, abs=1e-12)


def test_hyperbola_has_negative_semi_major_axis():
    coe = np.array([-9e6, 1.5, 0.7, 1.1, 2.2, 0.3])
    assert coe_from_cartesian(cartesian_from_coe(coe, GM), GM) == pytest.approx(coe, rel=1e-10)


@given(
    a=st.floats(6.6e6, 4.3e7),
    e=st.floats(0.0, 0.9),
    inclination=st.floats(0.0, np.pi),
    argp=angle(),
    raan=angle(),
    nu=angle(),
)
def test_state_survives_the_round_trip_everywhere(a, e, inclination, argp, raan, nu):
    state = cartesian_from_coe([a, e, inclination, argp, raan, nu], GM)
    back = cartesian_from_coe(coe_from_cartesian(state, GM), GM)
    assert back[:3] == pytest.approx(state[:3], abs=1e-7 * a)
    assert back[3:] == pytest.approx(state[3:], abs=1e-7 * np.linalg.norm(state[3:]))


@given(
    a=st.floats(6.6e6, 4.3e7),
    e=st.floats(1e-3, 0.9),
    inclination=st.floats(0.05, 3.09),
    argp=angle(),
    raan=angle(),
    nu=angle(),
)
def test_elements_survive_the_round_trip_off_the_singularities(a, e, inclination, argp, raan, nu):
    coe = np.array([a, e, inclination, argp, raan, nu])
    back = coe_from_cartesian(cartesian_from_coe(coe, GM), GM)
    assert back[:3] == pytest.approx(coe[:3], rel=1e-10)
    assert wrap_half_turn(back[3:] - coe[3:]) == pytest.approx(0.0, abs=1e-10)


def test_differences_in_rsw_are_along_its_axes():
    states = np.array([[7e6, 0.0, 0.0, 0.0, 7e3, 0.0], [0.0, 0.0, 7e6, -7e3, 0.0, 0.0]])
    ahead_and_faster_up = np.array([[0.0, 3.0, 0.0, 0.5, 0.0, 0.0], [-3.0, 0.0, 0.0, 0.0, 0.0, 0.5]])
    expected = np.tile([0.0, 3.0, 0.0, 0.5, 0.0, 0.0], (2, 1))
    np.testing.assert_allclose(in_rsw(ahead_and_faster_up, states), expected, atol=1e-12)


@given(mean=st.floats(-10.0, 10.0), e=st.floats(0.0, 0.99))
def test_true_anomaly_solves_keplers_equation(mean, e):
    nu = true_from_mean_anomaly(mean, e)
    eccentric = 2 * np.arctan2(np.sqrt(1 - e) * np.sin(nu / 2), np.sqrt(1 + e) * np.cos(nu / 2))
    assert wrap_half_turn(eccentric - e * np.sin(eccentric) - mean) == pytest.approx(0.0, abs=1e-11)


@given(mean=st.floats(-10.0, 10.0), e=st.floats(0.0, 0.99))
def test_mean_anomaly_undoes_the_true_one(mean, e):
    back = mean_from_true_anomaly(true_from_mean_anomaly(mean, e), e)
    assert wrap_half_turn(back - mean) == pytest.approx(0.0, abs=1e-11)


@pytest.mark.parametrize("e", [-0.1, 1.0, np.nan])
@pytest.mark.parametrize("convert", [true_from_mean_anomaly, mean_from_true_anomaly])
def test_anomalies_want_an_ellipse(convert, e):
    assert "eccentricity" in refusal(convert, 1.0, e)


def test_wraps():
    assert wrap_turn(np.array([-1e-20, 2 * np.pi, -0.5])) == pytest.approx([0.0, 0.0, 2 * np.pi - 0.5])
    assert wrap_half_turn(np.array([np.pi, -np.pi, 3.5, -3.5])) == pytest.approx(
        [np.pi, np.pi, 3.5 - 2 * np.pi, 2 * np.pi - 3.5]
    )
