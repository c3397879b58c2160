"""Fits over another window and Cd held by its past: what of it is known when, and what it is worth."""

import numpy as np
import pandas as pd
import pytest
from fits import estimates_on, on_orbit

from opml.base.constants import DAY
from opml.catalog.predict import other_windows, prediction
from opml.catalog.propagator import Propagator
from opml.orbits.manoeuvres import Manoeuvre
from opml.tables import SCHEMAS, STATE

TIMES = np.array([0.0, 0.3, 1.1, 2.0, 2.9]) * DAY


def estimates(gm, cd, *, sigma=0.1, converged=True, shift=0.0):
    """Estimates on one low orbit, `shift` [m] ahead of it, with a covariance that knows of no correlation."""
    states = on_orbit(TIMES, gm, ahead=shift / 6.77e6)
    doubt = np.broadcast_to(np.square(sigma), len(TIMES))
    covariance = np.diag([1.0, 1.0, 1.0, 1e-6, 1e-6, 1e-6, 1.0])
    return estimates_on(TIMES, states, covariance=covariance, converged=converged, cd=cd, cov_cd_cd=doubt)


def predicted(model, table, iss):
    truth = estimates(model.gm, 2.2)[["t", *STATE]]
    return prediction.predict_all(Propagator(model, iss), truth, table, max_days=2.5)


def built(model, iss, short, arc, memory_days=30.0):
    """The tables of arcs beside each other."""
    propagator, pairs = Propagator(model, iss), predicted(model, short, iss)
    arcs = other_windows.build_arcs(
        propagator, pairs, arc_estimates=arc, arc_predictions=predicted(model, arc, iss)
    )
    past = other_windows.build_past(pairs, arc_estimates=arc, apriori=iss.cd, memory_days=memory_days)
    for kind, table in (("arcs", arcs), ("cd_past", past)):
        assert list(table.columns) == SCHEMAS[kind].names
        pd.testing.assert_frame_equal(table[["i", "j"]], pairs[["i", "j"]])
    return arcs.assign(cd_past=past["cd_past"])


@pytest.fixture(scope="module")
def found(assumed_model, iss):
    """Arcs that are 100 m behind the short fits, with a Cd of their own."""
    short = estimates(assumed_model.gm, 3.0, shift=100.0)
    arc = estimates(assumed_model.gm, [2.3, 2.1, 2.2, 2.25, 2.15])
    return predicted(assumed_model, short, iss), built(assumed_model, iss, short, arc)


def test_correcting_by_l_is_taking_the_arcs_prediction(found, assumed_model, iss):
    pairs, table = found
    own = predicted(assumed_model, estimates(assumed_model.gm, [2.3, 2.1, 2.2, 2.25, 2.15]), iss)
    left = pairs["e_y"] - table["l_arc_y"]
    # Their axes differ, as one error is in RSW of the true state and the other of the predicted one.
    assert left.to_numpy() == pytest.approx(own["e_y"].to_numpy(), rel=0.05, abs=0.01 * pairs["e_y"].max())


def test_v_is_how_the_arcs_prediction_answers(found, assumed_model, iss):
    _, table = found
    arc = estimates(assumed_model.gm, [2.3, 2.1, 2.2, 2.25, 2.15])
    nudged = arc.assign(cd=arc["cd"] + 0.01)
    change = predicted(assumed_model, nudged, iss)["e_y"] - predicted(assumed_model, arc, iss)["e_y"]
    assert table["v_arc_y"].to_numpy() == pytest.approx(change.to_numpy() / 0.01, rel=0.06)


def test_an_arc_that_did_not_converge_says_nothing(assumed_model, iss):
    converged = np.array([True, False, True, True, True])
    arc = estimates(assumed_model.gm, 2.5, converged=converged)
    table = built(assumed_model, iss, estimates(assumed_model.gm, 3.0), arc)
    lost = table["i"] == 11
    assert lost.any()
    families = [f"{name}_{axis}" for name in ("l_arc", "v_arc") for axis in STATE]
    assert (table.loc[lost, families] == 0.0).all(axis=None)
    assert (table.loc[lost, "cd_arc"] == iss.cd).all()
    assert (table.loc[~lost, "v_arc_y"] != 0.0).all()


def test_an_arc_across_a_manoeuvre_says_nothing(assumed_model, iss):
    short, arc = estimates(assumed_model.gm, 3.0), estimates(assumed_model.gm, 2.2)
    arcs = (
        other_windows.exclude_burns(arc, manoeuvres=burns, window=DAY)
        for burns in ([], [Manoeuvre(1.0 * DAY)])
    )
    quiet, disturbed = (built(assumed_model, iss, short, one) for one in arcs)
    across = quiet["i"] == 12  # a tenth of a day after it; the next is a whole day later
    assert (disturbed.loc[across, "l_arc_y"] == 0.0).all()
    assert (quiet.loc[across, "l_arc_y"] != 0.0).all()
    assert (disturbed.loc[~across, "l_arc_y"] == quiet.loc[~across, "l_arc_y"]).all()


def test_the_past_is_weighted_by_its_variance_and_fades(assumed_model):
    sigma = np.array([0.1, 0.1, 0.1, 1e4, 0.1])
    table = estimates(assumed_model.gm, [2.0, 2.4, 2.2, 5e4, 2.2], sigma=sigma)
    past = other_windows.past_cd(table, apriori=2.2, memory_days=1e6)
    assert 2.0 < past[0] < 2.02  # the a-priori value counts little beside a fit
    assert past[1:] == pytest.approx(2.2, abs=1e-3)
    short = other_windows.past_cd(table, apriori=2.2, memory_days=0.05)
    assert short[[0, 1, 2, 4]] == pytest.approx([2.01, 2.39, 2.2, 2.2], abs=0.02)


def test_a_fit_that_turns_out_to_hold_a_burn_leaves_the_past(assumed_model):
    """At 1.1 days nobody knows of the burn at 0.9, and Cd takes it in; the next set tells it."""
    cd = [2.2, 2.2, -180.0, 2.2, 2.2]
    table = estimates(assumed_model.gm, cd)
    burn = Manoeuvre(0.9 * DAY, 2.0 * DAY, restarts=True)
    found = other_windows.exclude_burns(table, manoeuvres=[burn], window=DAY)
    assert found["converged"].all()
    past = other_windows.past_cd(found, apriori=2.2, memory_days=30.0)
    assert past[2] < -10.0
    np.testing.assert_allclose(np.delete(past, 2), 2.2)
    # As it was known then, what was flown from the fit across the burn stays.
    before = other_windows.past_cd(table, apriori=2.2, memory_days=30.0)
    np.testing.assert_array_equal(past[:3], before[:3])


def test_the_spread_is_a_part_of_the_bodys_own_cd(assumed_model):
    """Not of the sheet's, which may be off by more than half."""
    sigma = np.array([0.01, 0.01, 0.01, 0.01, 0.2])
    cd = np.array([1.1, 1.1, 1.0, 1.0, 0.8])
    past = other_windows.past_cd(estimates(assumed_model.gm, cd, sigma=sigma), apriori=2.2, memory_days=1e6)
    weight = 1.0 / (sigma**2 + (0.1 * 1.055) ** 2)
    by_hand = (weight @ cd + 1.1**-2 * 2.2) / (weight.sum() + 1.1**-2)
    assert past[4] == pytest.approx(by_hand, abs=1e-4)


def test_what_comes_after_t_i_changes_nothing_at_t_i(assumed_model, iss):
    cd = np.array([2.3, 2.1, 2.2, 2.25, 2.15])
    short, arc = estimates(assumed_model.gm, 3.0), estimates(assumed_model.gm, cd)
    later = estimates(assumed_model.gm, np.where(TIMES > 1.5 * DAY, 9.0, cd))
    before, after = (built(assumed_model, iss, short, one) for one in (arc, later))
    known = before["i"] <= 12
    pd.testing.assert_frame_equal(before[known], after[known], check_exact=True)
    assert not before[~known].equals(after[~known])


def test_a_prediction_without_an_estimate_is_an_error(assumed_model, iss):
    table = estimates(assumed_model.gm, 2.2)
    pairs = predicted(assumed_model, table, iss)
    for known in (table.drop(index=0), table.iloc[:1]):
        with pytest.raises(KeyError, match="tracks without an estimate"):
            other_windows.build_past(pairs, arc_estimates=known, apriori=iss.cd, memory_days=30.0)
