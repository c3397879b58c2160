"""Spans of fits, told by sets whose errors along the track are parabolas about the middle of each span."""

import logging

import numpy as np
import pytest
from element_histories import history
from support import EPOCH

from opml.base.constants import DAY, HOUR
from opml.interop.element_sets import fit_spans, histories
from opml.interop.element_sets.measured_sets import Taking, measured
from opml.orbits.manoeuvres import Manoeuvre

DAYS = np.arange(1.0, 21.0)
RADIUS = 6.78e6


def parting(two):
    """How two sets part: half the curvature, and the rate."""
    satellites = histories.satellites(two, epoch=EPOCH)
    return fit_spans._partings(satellites, np.array([1]), two["t"].to_numpy(), EPOCH)[0]


def curvature():
    """By how much a difference of 1 in B* bends the path along the track, halved [rad/s2]."""
    two = history([1.0, 2.0])
    two.loc[0, "bstar"] = 1e-3
    return parting(two)[0] / RADIUS / 1e-3


def fitted(hours, *, bend=400.0, rate=60.0, days=DAYS):
    """Sets that were fitted to so many hours; bend and rate of their errors over a day are random [m]."""
    sets, half = history(days), 0.5 * hours * HOUR
    generator = np.random.default_rng(2)
    bends = bend / DAY**2 / RADIUS * generator.normal(size=len(sets))
    rates = rate / DAY / RADIUS * generator.normal(size=len(sets))
    sets["bstar"] += bends / curvature()
    sets["mean_motion"] += rates + 2.0 * bends * half
    sets["mean_anomaly"] += rates * half + bends * half**2
    return sets


def newest(sets):
    """Over how long the newest of the sets was fitted, as all of them tell [h]."""
    return fit_spans.fit_spans(sets, epoch=EPOCH)[-1] / HOUR


@pytest.mark.parametrize(("hours", "days"), [(36.0, np.arange(1.0, 21.0, 0.5)), (72.0, DAYS)])
def test_the_span_of_fits_is_found(hours, days):
    assert newest(fitted(hours, days=days)) == hours


@pytest.mark.parametrize(("bend", "rate"), [(20.0, 400.0), (200.0, 200.0)])
def test_rates_that_a_span_does_not_explain_or_not_enough_tell_none(bend, rate):
    assert np.isnan(newest(fitted(72.0, bend=bend, rate=rate)))


def test_a_span_whose_middle_lies_before_all_that_was_looked_at_is_none():
    assert newest(fitted(216.0, bend=200.0)) == 216.0
    assert np.isnan(newest(fitted(480.0, bend=200.0)))


def test_a_few_sets_tell_no_span():
    lengths = fit_spans.fit_spans(fitted(72.0), epoch=EPOCH)
    assert np.isnan(lengths[:8]).all()
    assert np.isfinite(lengths[8:]).all()


def test_sets_by_which_the_object_decays_do_not_count():
    sets = fitted(72.0)
    sets.loc[5, "bstar"] = 10.0
    assert newest(sets) == 72.0


def test_the_same_orbit_twice_tells_nothing():
    assert np.isnan(parting(history([1.0, 2.0]).iloc[[0, 0]])).all()


def reaches(sets, **taking):
    """How far the points of each set reach back [h]."""
    found = measured(sets, Taking(1200.0, **taking), epoch=EPOCH, duration=30 * DAY)
    t = found.points.groupby("track")["t"]
    return ((t.max() - t.min()) / HOUR).tolist()


def test_points_reach_back_over_the_span_once_it_is_told(caplog):
    caplog.set_level(logging.INFO)
    sets = fitted(72.0).iloc[:11]
    found = reaches(sets)
    assert found == [24.0] * 8 + [72.0] * 3
    (line,) = [line for line in caplog.messages if "sets part" in line]
    assert line.startswith("sets part as fits to 72 hours each do")
    assert reaches(sets.iloc[:10]) == found[:10]
    assert reaches(sets, reach=36 * HOUR) == [24.0] + [36.0] * 10


def test_sets_about_a_burn_tell_nothing_once_it_is_known():
    calm, burns = fitted(72.0), DAY * np.array([4.5, 7.5, 10.5, 13.5])
    sets = calm.copy()
    for burn in burns:
        faster = 3e3 / DAY / RADIUS
        sets["mean_motion"] += np.where(sets["t"] > burn, faster, 0.0)
        sets["mean_anomaly"] += faster * np.maximum(sets["t"] - burn, 0.0)
    at_once, late = ([Manoeuvre(t, known) for t in burns] for known in (-np.inf, 18.5 * DAY))
    expected = fit_spans.fit_spans(calm, epoch=EPOCH, manoeuvres=at_once)[-1]
    assert expected == 60.0 * HOUR  # of eleven pairs, half a day from the truth
    assert newest(sets) != 60.0
    assert fit_spans.fit_spans(sets, epoch=EPOCH, manoeuvres=at_once)[-1] == expected
    lengths, before = fit_spans.fit_spans(sets, epoch=EPOCH, manoeuvres=late), sets["t"] < 18.5 * DAY
    np.testing.assert_array_equal(lengths[before], fit_spans.fit_spans(sets[before], epoch=EPOCH))
    assert (lengths[~before] == expected).all()
