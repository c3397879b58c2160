"""Ephemerides of several models from one estimate: any epoch, what is known when, and covariances."""

import numpy as np
import pandas as pd
import pytest
from fits import estimates_on, on_orbit
from support import force_model

from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.catalog.predict import other_windows, prediction
from opml.catalog.propagator import Propagator
from opml.ephemerides.fit_sizes import FORMAL, FitSizes
from opml.ephemerides.paths import paths
from opml.ephemerides.start_arcs import StartArcs, grid
from opml.interop import known_orbits, oem
from opml.learning.models import learners
from opml.orbits.elements import in_rsw
from opml.orbits.rsw_covariance import rates
from opml.tables import SPREAD, STATE, STATE_COVARIANCES, symmetric_matrices

EPOCH = "2016-09-28T12:09:45"
TIMES = np.array([0.0, 0.3, 0.61, 1.1, 1.5]) * DAY
CD = [2.25, 2.1, 2.4, 2.3, 2.2]
MODELS = {
    "none": learners.of_job({"kind": "none", "variables": []}),
    "fit24": learners.of_job({"kind": "refitted", "variables": ["l_arc_y"], "window_hours": 24.0}),
}
RUNNING = learners.of_job(
    {
        "kind": "running",
        "variables": ["l_arc_y", "v_arc_y", "cd_arc", "cd_past"],
        "window_hours": 24.0,
        "memory_days": 30.0,
    }
)
SIZES = FitSizes(pd.Series([2.0, 9.0, 4.0, 2.0, 50.0, 3.0, 0.6], FORMAL), np.ones((2, 3)))


def spreads(pairs):
    """A tenth more drag takes predictions 100 m a day, the weather nowhere."""
    days = (pairs["t_j"] - TIMES[1]) / DAY
    return pairs.assign(**dict.fromkeys(SPREAD, 0.0)).assign(drag_y=100.0 * days**2)


def estimates(gm, cd, ahead=0.0):
    """Estimates on one low orbit, `ahead` [m] of it, with a covariance that ties drag to the velocity."""
    covariance = np.diag([9.0, 9.0, 9.0, 1e-6, 1e-6, 1e-6, 0.01])
    covariance[6, 3] = covariance[3, 6] = 5e-5
    states = on_orbit(TIMES, gm, ahead=ahead / 6.77e6)
    return estimates_on(TIMES, states, covariance=covariance, cd=cd, track=np.arange(len(TIMES)))


@pytest.fixture(scope="module")
def fitted(assumed_model):
    """Estimates by the window of their fits [h]."""
    gm = assumed_model.gm
    return {12.0: estimates(gm, CD), 24.0: estimates(gm, 2.2, ahead=40.0)}


def arcs_of(propagator, fitted, *, start=1, step=60.0, end=2.0 * DAY, models=MODELS):
    row = fitted[12.0].iloc[start : start + 1]
    arrivals = grid(step, min(TIMES[start] + 0.8 * DAY, end))
    return StartArcs.propagate(propagator, row, arrivals, fits=fitted, models=[*models.values()])


@pytest.fixture(scope="module")
def path(propagator, fitted):
    made = paths(arcs_of(propagator, fitted), MODELS, now=TIMES[1])
    return made.with_spread(spreads, slice(None, None, 10))


@pytest.fixture(scope="module")
def table(path):
    return path.ephemeris("fit24", SIZES, at=path.table["t_j"].to_numpy())


def test_arcs_on_the_grid_are_those_at_tracks(propagator, fitted):
    dense = arcs_of(propagator, fitted, step=0.01 * DAY, models={}).pairs.set_index("j")
    arrivals = fitted[12.0].set_index("track")["t"]
    pairs = prediction.predict(propagator, fitted[12.0], arrivals=arrivals, max_days=0.8)
    for row in pairs[pairs["i"] == 1].to_dict("records"):
        there = dense.loc[round(row["t_j"] / DAY / 0.01)]
        assert there["t_j"] == pytest.approx(row["t_j"], abs=1e-6)
        assert there["x"] == pytest.approx(row["x"], abs=0.05)


@pytest.mark.parametrize("degree", [20, 28])
def test_arcs_propagated_together_are_those_propagated_alone(degree, fitted, iss):
    """In a large field they go beside the first, 40 m ahead of it and with another Cd, to a decimetre."""
    propagator = Propagator(force_model(degree), iss)
    arcs = arcs_of(propagator, fitted, step=300.0, models=MODELS | {"running24": RUNNING})
    for found, alone in (
        (arcs.pairs, fitted[12.0]),
        (arcs.others[24.0], fitted[24.0]),
        (arcs.perturbed[24.0], other_windows.perturbed(fitted[24.0])),
    ):
        arrivals = grid(300.0, TIMES[1] + 0.8 * DAY)
        expected = prediction.predict(propagator, alone.iloc[1:2], arrivals=arrivals, max_days=0.8)
        pd.testing.assert_frame_equal(found[["i", "j"]], expected[["i", "j"]])
        off = np.abs(found[STATE] - expected[STATE]).to_numpy().max(axis=0)
        assert ((off > 0.0) == (degree > 20 and found is not arcs.pairs)).all()
        assert off[:3].max() < 0.1
        assert off[3:].max() < 1e-4


def test_a_mean_of_cd_moves_the_arc_by_how_it_answers(propagator, fitted):
    """The mean of 2.2, as each of these fits has, leaves the fit over the other window as it is."""
    arcs = arcs_of(propagator, fitted, models={"running24": RUNNING})
    alike = arcs.expected(MODELS["fit24"]) - arcs.expected(RUNNING)
    assert np.abs(alike).max() < 1e-6
    other = {**fitted, 24.0: fitted[24.0].assign(cd=[2.3, 2.2, 2.2, 2.2, 2.2])}
    moved = arcs_of(propagator, other, models={"running24": RUNNING}).expected(RUNNING)
    assert np.abs(moved - arcs.expected(RUNNING)).max() > 10.0


def test_a_model_of_a_further_table_is_refused(propagator, fitted):
    law = learners.of_job({"kind": "linear_law", "terms": ["v_y"], "variables": ["v_y"]})
    with pytest.raises(InputError, match=r"expected a model of fits alone, got one of v_y"):
        arcs_of(propagator, fitted, models={}).expected(law)


def test_the_grid_is_regular_and_begins_after_the_estimate(table):
    assert (np.diff(table["t"]) == 60.0).all()
    assert (table["t"] % 60.0 == 0.0).all()
    assert 0.0 < table["t"].iloc[0] - table["t_i"].iloc[0] <= 60.0
    assert table["t"].iloc[-1] - table["t_i"].iloc[-1] == pytest.approx(0.8 * DAY, abs=60.0)


def test_the_orbit_is_moved_by_what_the_model_expects(path, table):
    expected, states = path.along("fit24"), table[STATE].to_numpy()
    moved = in_rsw(table[[f"{name}_predicted" for name in STATE]].to_numpy() - states, states)
    assert np.abs(expected).max() > 30.0
    np.testing.assert_allclose(moved[:, 1], expected, rtol=1e-4, atol=0.02)
    assert (path.along("none") == 0.0).all()


def test_it_ends_with_the_run(propagator, fitted):
    last = arcs_of(propagator, fitted, start=4, end=1.6 * DAY)
    assert paths(last, MODELS, now=TIMES[4]).table["t_j"].max() <= 1.6 * DAY
    short = arcs_of(propagator, fitted, start=4, end=1.5 * DAY + 600.0)
    with pytest.raises(InputError, match=r"expected at least 16 epochs ahead, got 10"):
        paths(short, MODELS, now=TIMES[4])


def test_what_comes_after_t_i_changes_nothing(path, propagator, fitted):
    """Every later estimate is moved by 10 km, with another Cd."""
    after = TIMES[1] < TIMES
    moved = {
        hours: table.assign(x=table["x"] + 1e4 * after, cd=table["cd"] + after)
        for hours, table in fitted.items()
    }
    again = paths(arcs_of(propagator, moved), MODELS, now=TIMES[1])
    pd.testing.assert_frame_equal(again.table, path.table.drop(columns=SPREAD), check_exact=True)


def test_covariances_have_the_sizes_of_the_past_and_no_shape_of_the_fits(table):
    """Axes know nothing of each other; a velocity follows its position."""
    covariance = symmetric_matrices(table, STATE_COVARIANCES)
    assert (np.linalg.eigvalsh(covariance / covariance.max(axis=(1, 2), keepdims=True)) > -1e-12).all()
    states = table[STATE].to_numpy()
    rows = table.assign(duration=table["t"] - table["t_i"], rate=rates(states), t_j=table["t"])
    # Between the epochs that arcs reach, ten minutes apart, the spread is linear.
    expected = SIZES.sigmas(spreads(rows))
    np.testing.assert_allclose(np.sqrt(covariance[:, range(3), range(3)]), expected[:, :3], rtol=2e-3)
    for a, b in ((0, 1), (0, 2), (1, 2)):
        assert (covariance[:, a, b] == 0.0).all()
    tied = covariance[:, 3, 1] / np.sqrt(covariance[:, 3, 3] * covariance[:, 1, 1])
    assert (tied < -0.9).all()


def test_an_oem_holds_the_table_to_its_digits(table, tmp_path):
    oem.write(tmp_path / "c.oem", oem.corrected_segments(table, rso="iss"), epoch=EPOCH, comment="of tests")
    text = (tmp_path / "c.oem").read_text(encoding="utf-8")
    assert "\nCOMMENT of tests\n" in text
    assert "COMMENT covariances in RSW: axes of the states only" in text
    (segment,) = known_orbits.segments(tmp_path / "c.oem", epoch=EPOCH)
    assert segment.covariance_frame == "RSW"
    np.testing.assert_array_equal(segment.t, table["t"])
    stated = table.iloc[[*range(0, len(table), 10), len(table) - 1]].drop_duplicates()
    np.testing.assert_array_equal(segment.covariance_t, stated["t"])
    np.testing.assert_array_equal(segment.states, table[STATE])
    lower = segment.covariances[:, *np.tril_indices(6)]
    np.testing.assert_array_equal(lower, stated[STATE_COVARIANCES])
