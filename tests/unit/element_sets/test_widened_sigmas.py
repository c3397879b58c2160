"""Sigmas of a catalogue are wider where its last errors were outside them, as far as was known."""

import numpy as np
import pandas as pd
import pytest

from opml.element_sets import corrector

MORNINGS = 61000.25 + np.arange(60)
OBJECTS = 80


def rows_and_found(errors, lead=3):
    """Return normal errors of a size by morning, corrected by 5 m, with sigmas of 100 m."""
    morning = np.repeat(MORNINGS, OBJECTS)
    rng = np.random.default_rng(1)
    error = 5.0 + np.repeat(errors, OBJECTS) * rng.standard_normal(len(morning))
    rows = pd.DataFrame({"morning": morning, "lead": lead, "error": error, "judged": morning + lead + 0.5})
    return rows, pd.DataFrame({"correction": 5.0, "sigma": 100.0}, index=rows.index)


def sigmas(errors):
    rows, found = rows_and_found(np.broadcast_to(errors, len(MORNINGS)))
    return corrector.widen(rows, found).groupby(rows["morning"])["sigma"].agg(["min", "max"])


def test_errors_outside_widen_sigmas_once_enough_of_them_are_judged():
    found = sigmas(300.0)
    # 3.5 days on, three mornings have 240 errors that are judged.
    assert (found.iloc[:6] == 100.0).all(axis=None)
    np.testing.assert_allclose(found.iloc[6:], 300.0, rtol=0.2)
    np.testing.assert_array_equal(found["min"], found["max"])


def test_sigmas_are_never_made_smaller():
    assert (sigmas(20.0) == 100.0).all(axis=None)


def test_errors_long_ago_and_later_ones_do_not_count():
    storm = np.where(np.arange(len(MORNINGS)) < 10, 300.0, 20.0)
    found = sigmas(storm)["max"]
    assert found.iloc[13] == pytest.approx(300.0, rel=0.2)
    assert (found.iloc[56:] == 100.0).all()
    changed = np.where(np.arange(len(MORNINGS)) < 20, storm, 1e6)
    pd.testing.assert_series_equal(sigmas(changed)["max"].iloc[:20], found.iloc[:20])


def test_a_day_of_large_errors_widens_what_is_predicted_for_a_week():
    """On the morning after: predictions for a week that began with it are judged a week later."""
    size = np.where(np.arange(len(MORNINGS)) == 50, 400.0, 100.0)
    day, week = (rows_and_found(size, lead) for lead in (1, 7))
    rows, found = (pd.concat(parts, ignore_index=True) for parts in zip(day, week, strict=True))
    sigma = corrector.widen(rows, found)["sigma"][rows["lead"] == 7].groupby(rows["morning"]).max()
    assert (sigma.iloc[40:52] < 120.0).all()
    assert (sigma.iloc[52:55] > 140.0).all()
    assert (sigma.iloc[55:57] < 120.0).all()


def test_rows_that_cannot_be_corrected_stay_without():
    rows, found = rows_and_found(np.full(len(MORNINGS), 300.0))
    found.iloc[-1] = np.nan
    wide = corrector.widen(rows.assign(error=rows["error"].where(rows["morning"] < MORNINGS[-1])), found)
    assert np.isnan(wide["sigma"].iloc[-1])
    assert wide["sigma"].iloc[-2] > 200.0


def test_a_set_that_jumps_widens_and_the_morning_after_a_jump_is_usual_again():
    """An object whose sets miss those before by one scale, and by ten on one morning."""
    missed = np.ones(len(MORNINGS))
    missed[30] = 10.0
    rows = pd.DataFrame({"number": 7, "lead": 3, "morning": MORNINGS, "missed": missed})
    jump = corrector.jumps(rows)
    assert np.isnan(jump.iloc[:8]).all()
    np.testing.assert_allclose(jump.iloc[8:], missed[8:])
    wide = corrector.widen_jumps(pd.DataFrame({"correction": 5.0, "sigma": 100.0}, rows.index), jump)
    np.testing.assert_array_equal(wide["sigma"], np.where(missed > 5.0, 500.0, 100.0))


def test_jumps_are_of_the_object_and_the_lead():
    rows = pd.DataFrame(
        {
            "number": np.repeat([7, 8], 2 * len(MORNINGS)),
            "lead": np.tile([1, 3], 2 * len(MORNINGS)),
            "morning": np.tile(np.repeat(MORNINGS, 2), 2),
        }
    )
    rows["missed"] = 10.0 * rows["number"] + rows["lead"]
    assert np.nanmax(corrector.jumps(rows)) == np.nanmin(corrector.jumps(rows)) == 1.0
    assert corrector.jumps(rows[:0]).empty  # of sets that are all old
