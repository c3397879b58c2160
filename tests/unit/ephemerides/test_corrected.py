"""Corrected ephemerides: tables at any epoch, what is known when, and covariances."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from fits import estimates_on, on_orbit
from support import force_model

from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.catalog.predict import mechanism, other_windows, prediction
from opml.catalog.predict.mechanism import FittedArcs
from opml.catalog.predict.resonance import Resonances
from opml.catalog.predict.sensitivity import sensitivities
from opml.catalog.propagator import Propagator
from opml.ephemerides import corrected
from opml.ephemerides.ephemeris_task import Task, departure
from opml.ephemerides.known_tables import KnownTables
from opml.ephemerides.task_part import Grid, TaskPart
from opml.figures import errors_at_later_tracks
from opml.interop import known_orbits, oem
from opml.learning.judge.error_sizes import Sizes
from opml.learning.models.linear_law import LinearLaw
from opml.orbits.elements import in_rsw
from opml.orbits.manoeuvres import Manoeuvre
from opml.orbits.rsw_covariance import rates
from opml.tables import (
    COMPONENTS,
    DOUBT,
    PARAMETER_COVARIANCES,
    SCHEMAS,
    SPREAD,
    STATE,
    STATE_COVARIANCES,
    read_table,
    symmetric_matrices,
    write_table,
)

EPOCH = "2016-09-28T12:09:45"
TIMES = np.array([0.0, 0.3, 0.61, 1.1, 1.5]) * DAY
CD = [2.25, 2.1, 2.4, 2.3, 2.2]
GRID = Grid(step=60.0, max_days=0.8, end=2.0 * DAY)
LAW = LinearLaw(("l_y", "v_y", "l_arc_y"), ("l_y", "v_y", "l_arc_y"), np.array([0.7, 0.02, 0.1]))


class Taught:
    """A daily learner with the same law each day."""

    variables = LAW.variables
    arc = (24.0, 30.0)

    def __call__(self, now):
        return LAW


def replay():
    """Replayed mornings of the day before the run: errors of about 20 m and 200 m a day, none known later."""
    rng = np.random.default_rng(3)
    count = 400
    duration = rng.uniform(0.05, 0.9, count) * DAY
    size = {"e_x": 9.0, "e_y": 20.0 + 200.0 * duration / DAY, "e_z": 4.0}
    errors = {name: size[name] * rng.normal(size=count) for name in size}
    rate = 1.13e-3
    velocities = {"e_vx": -rate * errors["e_y"], "e_vy": -rate * errors["e_x"], "e_vz": 0.0}
    free = {name: value + 9e-3 * rng.normal(size=count) for name, value in velocities.items()}
    times = {"t_i": -duration, "t_j": 0.0, "t_known": 0.0, "morning": -DAY, "duration": duration}
    return pd.DataFrame(times | errors | free | {"rate": rate} | dict.fromkeys([*DOUBT, *SPREAD], 0.0))


REPLAY = replay()


def spreads(pairs):
    """A tenth more drag takes predictions 100 m a day, the weather nowhere."""
    days = (pairs["t_j"] - pairs["t_i"]) / DAY
    return pairs[["i", "j"]].assign(**dict.fromkeys(SPREAD, 0.0)).assign(drag_y=100.0 * days**2)


OPTIONS = {"spreads": spreads, "now": 0.0}


def estimates(gm, cd, ahead=0.0):
    """Estimates on one low orbit, `ahead` [m] of it, with a covariance that ties drag to the velocity."""
    covariance = np.diag([9.0, 9.0, 9.0, 1e-6, 1e-6, 1e-6, 0.01])
    covariance[6, 3] = covariance[3, 6] = 5e-5
    states = on_orbit(TIMES, gm, ahead=ahead / 6.77e6)
    return estimates_on(TIMES, states, covariance=covariance, cd=cd, track=np.arange(len(TIMES)))


@pytest.fixture(scope="module")
def known(assumed_model):
    gm, own = assumed_model.gm, estimates(assumed_model.gm, CD)
    at_estimates = pd.DataFrame(
        {
            "converged": True,
            "cd_inside": True,
            "eps_y": [np.nan, 1.0, 1.0, np.nan, 1.0],
            "t_b": TIMES - 0.3 * DAY,
        }
    )
    others = {24.0: estimates(gm, 2.2, ahead=40.0)}
    return KnownTables(
        own, at_estimates, 12.0, gm, others=others, long_window_hours=24.0, resonances=[(1, 15)]
    )


def built(propagator, known, starts, *, grid=GRID, replay=REPLAY):
    """Ephemerides from the `starts` that are taught the law."""
    return corrected.build(Task(propagator, known, starts, grid), Taught(), replay, **OPTIONS)


@pytest.fixture(scope="module")
def table(propagator, known):
    return built(propagator, known, known.estimates.iloc[[1, 2]])


def test_columns_on_the_grid_are_those_at_tracks(propagator, known):
    """What the tables say of pairs of tracks, they say of the grid's epochs, too."""
    grid = Grid(step=0.01 * DAY, max_days=0.8, end=2.0 * DAY)
    part = TaskPart(propagator, known, known.estimates.iloc[1:3], grid)
    variables = part.variables(("v_y", "l_y"), arc=(24.0, 30.0))
    dense = part.pairs().assign(**variables).set_index(["i", "j"])
    at_tracks = {"arrivals": known.estimates.set_index("track")["t"], "max_days": 0.8}
    fits = known.estimates, known.other(24.0)
    pairs, long = (prediction.predict(propagator, fit, **at_tracks) for fit in fits)
    arcs = (
        FittedArcs(fit, predicted, sensitivities(propagator, fit, predicted, bounds=None))
        for fit, predicted in zip(fits, (pairs, long), strict=True)
    )
    own = mechanism.build(*arcs, bounds=None, resonances=Resonances(known.resonances, 24.0, known.gm))
    for row in np.flatnonzero(pairs["i"].isin([1, 2])):
        there = dense.loc[(pairs["i"][row], round(pairs["t_j"][row] / grid.step))]
        assert there["t_j"] == pytest.approx(pairs["t_j"][row], abs=1e-6)
        for column, at_track, close in (
            ("x", pairs, 0.05),
            ("v_y", own, 5.0),
            ("l_y", own, 0.1),
        ):
            assert there[column] == pytest.approx(at_track[column][row], abs=close, rel=1e-4)


@pytest.mark.parametrize("degree", [20, 28])
def test_arcs_that_fly_together_are_those_that_fly_alone(degree, known, iss):
    """In a large field they fly beside the first, 40 m ahead of it and with another Cd, to a decimetre."""
    propagator, start = Propagator(force_model(degree), iss), known.estimates.iloc[1:2]
    together, alone = (TaskPart(propagator, known, start, replace(GRID, step=300.0)) for _ in range(2))
    together.propagate_together([24.0], [24.0])
    np.testing.assert_array_equal(together.pairs()[STATE], alone.pairs()[STATE])
    for found, expected in (
        (together.predictions(24.0), alone.predictions(24.0)),
        (together.perturbed(24.0), alone.perturbed(24.0)),
    ):
        assert np.abs(expected[STATE[:3]] - alone.pairs()[STATE[:3]]).to_numpy().max() > 40.0
        pd.testing.assert_frame_equal(found[["i", "j"]], expected[["i", "j"]])
        off = np.abs(found[STATE] - expected[STATE]).to_numpy().max(axis=0)
        assert ((off > 0.0) == (degree > 20)).all()
        assert off[:3].max() < 0.1
        assert off[3:].max() < 1e-4


def test_what_parts_an_arc_is_told_without_further_arcs(propagator, known, monkeypatch):
    part = TaskPart(propagator, known, known.estimates.iloc[1:3], replace(GRID, step=300.0))
    whole, expected = part.arcs(24.0), part.variables(("l_arc_y", "v_arc_y"), arc=(24.0, 30.0))
    monkeypatch.setattr(other_windows, "perturbed", None)
    found = part.variables(("l_arc_y",), arc=(24.0, 30.0))
    assert found["l_arc_y"].tolist() == expected["l_arc_y"].tolist() == whole["l_arc_y"].tolist()
    assert np.ptp(found["l_arc_y"]) > 1.0


def test_the_table_is_the_schemas_and_comes_back(table, tmp_path):
    write_table(tmp_path / "c.parquet", table, "corrected", metadata={})
    pd.testing.assert_frame_equal(
        read_table(tmp_path / "c.parquet", "corrected"), table[SCHEMAS["corrected"].names], check_exact=True
    )


def test_the_grid_is_regular_and_begins_after_the_estimate(table):
    for _, own in table.groupby("i"):
        assert (np.diff(own["t"]) == 60.0).all()
        assert (own["t"] % 60.0 == 0.0).all()
        assert 0.0 < own["t"].iloc[0] - own["t_i"].iloc[0] <= 60.0
        assert own["t"].iloc[-1] - own["t_i"].iloc[-1] == pytest.approx(0.8 * DAY, abs=60.0)


def test_the_orbit_is_moved_by_what_the_model_says(table, propagator, known):
    part = TaskPart(propagator, known, known.estimates.iloc[[1, 2]], GRID)
    rows = part.variables(LAW.variables, arc=Taught.arc)
    said = LAW.predict(np.column_stack([rows[name] for name in LAW.variables]))
    states = table[STATE].to_numpy()
    moved = in_rsw(table[[f"{name}_predicted" for name in STATE]].to_numpy() - states, states)
    assert np.abs(said).max() > 30.0
    np.testing.assert_allclose(moved[:, 1], said, rtol=1e-4, atol=0.02)


def test_it_ends_with_the_run(propagator, known):
    last = known.estimates.iloc[[4]]
    cut = built(propagator, known, last, grid=replace(GRID, end=1.6 * DAY))
    assert cut["t"].max() <= 1.6 * DAY
    with pytest.raises(InputError, match=r"expected 16 epochs every 60 s .* before the run ends, got fewer"):
        built(propagator, known, last, grid=replace(GRID, end=1.5 * DAY + 600.0))


def test_what_comes_after_t_i_changes_nothing(table, propagator, known):
    """Every later estimate is moved by 10 km, with another Cd."""

    def later(one):
        after = one["t"].to_numpy() > TIMES[2]
        return one.assign(x=one["x"] + 1e4 * after, cd=one["cd"] + after)

    moved = replace(
        known,
        estimates=later(known.estimates),
        others={24.0: later(known.other(24.0))},
    )
    # Mornings that were over after t_i were off by ten times as much.
    unknown = REPLAY.assign(t_known=2.0 * DAY, **{name: 10.0 * REPLAY[name] for name in COMPONENTS})
    told = pd.concat([REPLAY, unknown], ignore_index=True)
    again = built(propagator, moved, moved.estimates.iloc[[1, 2]], replay=told)
    pd.testing.assert_frame_equal(again, table, check_exact=True)


def test_it_starts_from_the_newest_usable_estimate(known):
    newest = departure(known, known_until=1.2 * DAY)
    assert newest["track"].tolist() == [2]  # none has a previous one to be held against at 3
    burnt = replace(known, manoeuvres=[Manoeuvre(0.5 * DAY)])
    assert departure(burnt, known_until=1.2 * DAY)["track"].tolist() == [1]
    unknown = replace(known, manoeuvres=[Manoeuvre(0.5 * DAY, 1.3 * DAY)])
    assert departure(unknown, known_until=1.2 * DAY).equals(newest)
    with pytest.raises(
        InputError, match=r"expected a usable estimate up to day 0\.2, the last to learn from"
    ):
        departure(known, known_until=0.2 * DAY)


def test_a_learner_needs_the_fits_that_it_asks_for(propagator, known):
    with pytest.raises(InputError, match="expected fits over another window"):
        built(propagator, replace(known, others={}), known.estimates.iloc[[1]])


def test_covariances_have_the_sizes_of_the_past_and_no_shape_of_the_fits(table):
    """Axes know nothing of each other; a velocity follows its position."""
    covariance = symmetric_matrices(table, STATE_COVARIANCES)
    assert (np.linalg.eigvalsh(covariance / covariance.max(axis=(1, 2), keepdims=True)) > -1e-12).all()
    states = table[STATE].to_numpy()
    rows = table.assign(duration=table["t"] - table["t_i"], rate=rates(states), t_j=table["t"])
    rows = rows.join(spreads(rows.assign(j=0))[SPREAD])
    expected = Sizes.learned(REPLAY, now=0.0).sigmas(rows)
    # Between the epochs that arcs fly to, ten minutes apart, the spread is linear.
    np.testing.assert_allclose(np.sqrt(covariance[:, range(3), range(3)]), expected[:, :3], rtol=2e-3)
    for a, b in ((0, 1), (0, 2), (1, 2)):
        assert (covariance[:, a, b] == 0.0).all()
    tied = covariance[:, 3, 1] / np.sqrt(covariance[:, 3, 3] * covariance[:, 1, 1])
    assert (tied < -0.9).all()


def test_an_oem_holds_the_table_to_its_digits(table, tmp_path):
    told = corrected.basis(REPLAY, 0.0)
    assert told.startswith(
        "covariances from 400 predictions of 1 mornings that were over by day 0, up to 0.9"
    )
    oem.write(tmp_path / "c.oem", oem.corrected_segments(table, rso="iss"), epoch=EPOCH, comment=told)
    assert f"\nCOMMENT {told}\n" in (tmp_path / "c.oem").read_text(encoding="utf-8")
    back = known_orbits.segments(tmp_path / "c.oem", epoch=EPOCH)
    assert [segment.covariance_frame for segment in back] == ["RSW", "RSW"]
    for segment, (_, own) in zip(back, table.groupby("i"), strict=True):
        np.testing.assert_array_equal(segment.t, own["t"])
        told = own.iloc[[*range(0, len(own), 10), len(own) - 1]].drop_duplicates()
        np.testing.assert_array_equal(segment.covariance_t, told["t"])
        np.testing.assert_array_equal(segment.states, own[STATE])
        lower = segment.covariances[:, *np.tril_indices(6)]
        np.testing.assert_array_equal(lower, told[STATE_COVARIANCES])
    assert "COMMENT covariances in RSW: axes of the states only" in (tmp_path / "c.oem").read_text(
        encoding="utf-8"
    )


def test_it_is_held_against_later_estimates(table, known):
    own = table[table["i"] == 1]
    states = own[[f"{name}_predicted" for name in STATE]].to_numpy()[100:600:100]
    later = pd.DataFrame(states, columns=STATE).assign(t=own["t"].to_numpy()[100:600:100], converged=True)
    later.loc[2, "converged"] = False
    later = later.assign(**dict.fromkeys(PARAMETER_COVARIANCES, 0.0))
    later[["cov_x_x", "cov_y_y", "cov_z_z"]] = 9.0
    errors = corrected.errors_at_estimates(own, later)
    assert len(errors) == 4
    np.testing.assert_allclose(errors[["before_x", "before_y", "before_z"]], 0.0, atol=1e-6)
    assert (errors["after_y"].abs() > 1.0).all()
    np.testing.assert_allclose(errors["duration"], later["t"].drop(2) - TIMES[1])
    np.testing.assert_allclose(errors[["sigma_e_x", "sigma_e_y", "sigma_e_z"]], 3.0)
    panels = errors_at_later_tracks.later_errors(errors, level=0.9).axes
    assert [axes.get_ylabel() for axes in panels[::2]] == [
        "radial error",
        "along-track error",
        "cross-track error",
    ]
    assert panels[2].yaxis.get_major_formatter()(-2500.0) == "\N{MINUS SIGN}2.5 km"
    np.testing.assert_allclose(panels[2].lines[-1].get_ydata(), panels[3].lines[-1].get_ydata())
    with pytest.raises(InputError, match="expected an estimate of a later track"):
        errors_at_later_tracks.later_errors(errors[:0], level=0.9)
