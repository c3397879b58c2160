"""Points before the epoch of mean elements, and fits to them."""

import logging

import numpy as np
import pandas as pd
import pytest
from element_histories import history
from support import BOUNDED_ESTIMATION, EPOCH

from opml.base.constants import DAY, HOUR
from opml.catalog.fit import estimation, fixes
from opml.catalog.fit.first import first_orbit
from opml.catalog.propagator import Propagator
from opml.interop.ccsds import utc_texts
from opml.interop.element_sets import histories, mean_elements, measured_sets
from opml.interop.element_sets.accuracy import SetSampling
from opml.tables import STATE

SAMPLING = SetSampling(12 * HOUR, 600.0)


def points_of(sets, sampling, **options):
    """The points of sets as deviations of their own are stated, over three days."""
    taking = measured_sets.Taking(sampling.step, sampling.reach, (300.0, 1000.0, 300.0), **options)
    return measured_sets.measured(sets, taking, epoch=EPOCH, duration=3 * DAY).points


@pytest.mark.parametrize("days", [1.0, 2.5])
def test_points_are_states_of_sgp4_up_to_the_epoch(days):
    sets = history([days])
    row, points = sets.iloc[0], points_of(sets, SAMPLING)
    assert len(points) == 73
    assert points["t"].iloc[-1] == row["t"] == DAY * days
    satellite = histories.satellite(row, epoch=EPOCH)
    for k in (0, 40, 72):
        (time,) = utc_texts(EPOCH, points["t"].to_numpy()[k : k + 1])
        expected = mean_elements.state(satellite, epoch=time)
        assert np.abs(points[STATE].to_numpy()[k] - expected).max() < 0.01


def test_fits_to_sets_are_at_their_epochs_and_as_close_as_sgp4_is(assumed_model, iss):
    taking = measured_sets.Taking(SAMPLING.step, SAMPLING.reach, (300.0, 1000.0, 300.0))
    found = measured_sets.measured(history([1.0, 2.5]), taking, epoch=EPOCH, duration=3 * DAY)
    table = fixes.of_sets(found.epochs, found.points, known=found.known)
    settings = BOUNDED_ESTIMATION.evolve(window_hours=0.0, cd_sigma=0.5)
    propagator, measured = Propagator(assumed_model, iss), fixes.Fixes(table)
    starts = first_orbit.starts(propagator, measured, known=None, settings=settings)
    estimates = estimation.estimate_all(propagator, starts, measured, settings=settings)
    assert estimates["converged"].all()
    pd.testing.assert_series_equal(estimates["t"], starts["t"])
    apart = np.linalg.norm((estimates[STATE[:3]] - starts[STATE[:3]]).to_numpy(), axis=1)
    assert ((apart > 10.0) & (apart < 3e3)).all()
    assert estimates["weighted_rms"].between(0.001, 3.0).all()


def taken(days, *, created=None, since=-np.inf):
    """The `fixes` table of sets of ten days, of those since a day."""
    sets = history(days, noise=100.0, created=created)
    taking = measured_sets.Taking(SAMPLING.step, SAMPLING.reach, since=since * DAY)
    found = measured_sets.measured(sets, taking, epoch=EPOCH, duration=10 * DAY)
    return fixes.of_sets(found.epochs, found.points, known=found.known)


@pytest.mark.parametrize(("since", "first"), [(6.5, 7), (6.0, 6), (30.0, 9)])
def test_earlier_sets_have_no_points_but_their_say_in_what_later_ones_are_worth(since, first):
    """One of the earlier ones was made late, and those after it were known no sooner."""
    days, created = np.arange(10.0), [*np.arange(3.0), 8.5, *np.arange(4.0, 10.0)]
    whole = taken(days, created=created)
    assert whole["track"].iloc[-1] == 8  # the first has no points within the run
    expected = whole[whole["t_estimate"] >= first * DAY].drop(columns="track").reset_index(drop=True)
    assert len(expected)
    found = taken(days, created=created, since=since)
    pd.testing.assert_frame_equal(found.drop(columns="track"), expected)


def test_a_set_that_sgp4_loses_counts_as_far_back_as_it_goes(caplog):
    taking = measured_sets.Taking(DAY, 2000.0 * DAY, (300.0, 1000.0, 300.0))
    with caplog.at_level(logging.WARNING):
        found = measured_sets.measured(history([1.0], bstar=0.1), taking, epoch=EPOCH, duration=3 * DAY)
    assert found.epochs.tolist() == [DAY]
    assert found.points["t"].tolist() == [0.0, DAY]
    assert np.isfinite(found.points[STATE].to_numpy()).all()
    assert "no farther back than SGP4 goes" in caplog.text
