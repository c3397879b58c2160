"""Spans of fits, told by sets whose errors along the track are parabolas about the middle of each span."""

import logging

import numpy as np
import pytest
from element_histories import history
from support import EPOCH

from opml.base.constants import DAY, HOUR
from opml.interop.element_sets import spans
from opml.interop.element_sets.measured_sets import Taking, measured
from opml.interop.element_sets.sgp4_points import Sampling

DAYS = np.arange(1.0, 21.0)
RADIUS = 6.78e6


def curvature():
    """By how much a difference of 1 in B* bends the path along the track, halved [rad/s2]."""
    two = history([1.0, 2.0])
    two.loc[0, "bstar"] = 1e-3
    return spans._parting(two.iloc[0], two.iloc[1], EPOCH)[0] / RADIUS / 1e-3


def fitted(hours, *, bend=400.0, rate=60.0):
    """Sets that were fitted to so many hours; bend and rate of their errors over a day are random [m]."""
    sets, half = history(DAYS), 0.5 * hours * HOUR
    generator = np.random.default_rng(2)
    bends = bend / DAY**2 / RADIUS * generator.normal(size=len(sets))
    rates = rate / DAY / RADIUS * generator.normal(size=len(sets))
    sets["bstar"] += bends / curvature()
    sets["mean_motion"] += rates + 2.0 * bends * half
    sets["mean_anomaly"] += rates * half + bends * half**2
    return sets


@pytest.mark.parametrize("hours", [36.0, 72.0])
def test_the_span_of_fits_is_found(hours):
    assert spans.span(fitted(hours), epoch=EPOCH) == pytest.approx(hours * HOUR, rel=0.15)


def test_rates_that_no_span_explains_tell_none():
    assert spans.span(fitted(72.0, bend=20.0, rate=400.0), epoch=EPOCH) is None


def test_a_few_sets_tell_no_span():
    assert spans.span(fitted(72.0).iloc[:8], epoch=EPOCH) is None


def test_sets_by_which_the_object_decays_do_not_count():
    sets = fitted(72.0)
    sets.loc[5, "bstar"] = 10.0
    assert spans.span(sets, epoch=EPOCH) == pytest.approx(72.0 * HOUR, rel=0.15)


def test_the_span_is_logged_beside_the_sets_that_count(caplog):
    caplog.set_level(logging.INFO)
    measured(fitted(72.0), Taking(Sampling(DAY, 1200.0)), epoch=EPOCH, duration=30 * DAY)
    (line,) = [line for line in caplog.messages if "reach_hours" in line]
    assert 60.0 < float(line.split("fits to ")[1].split()[0]) < 84.0
