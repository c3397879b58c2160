"""The sequential filter on measurements whose truth is known, with a drag that keeps or changes its value."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from support import BOUNDED_ESTIMATION

from opml.base.constants import DAY, HOUR
from opml.catalog.fit import estimation, start_states
from opml.catalog.fit.sequential import Filtering, Leg, Noise, filter_all
from opml.catalog.flight import Flight
from opml.catalog.simulate import tracking, truth
from opml.tables import PARAMETER_COVARIANCES, PARAMETERS, STATE

CALM = Noise(walk=1e-3, gust=1e-4, kick=1e-6)
ROUGH = Noise(walk=1e-3, gust=0.1, kick=1e-6)
NUMBERS = [*PARAMETERS, *PARAMETER_COVARIANCES, "weighted_rms"]
STEP = 20.0


def blown(flight, *, gust, seed):
    """Truth of two days in which the drag changes every half hour; gust: scatter of its mean over a day."""
    t = np.arange(0.0, 2 * DAY + STEP, STEP)
    pieces = [truth.simulate(flight, duration=STEP, step=STEP)[STATE].to_numpy()[:1]]
    noise = np.random.default_rng(seed)
    for begin in np.arange(0.0, 2 * DAY, HOUR / 2):
        epochs = np.arange(begin, begin + HOUR / 2 + STEP, STEP)
        cd = flight.rso.cd * (1.0 + gust * np.sqrt(48.0) * noise.normal())
        pieces.append(flight.fly(epochs, pieces[-1][-1:], cd=cd, first=[0], last=[len(epochs) - 1]).path(0))
    states = np.concatenate(pieces)[: len(t)]
    return pd.DataFrame({"t": t, **dict(zip(STATE, states.T, strict=True))})


class Case:
    """A simulated orbit, its tracks and their batch fits over 12 h."""

    def __init__(self, flight, orbit, earth_orientation, stations, *, seed):
        self.flight, self.orbit = flight, orbit
        self.earth_orientation, self.stations = earth_orientation, stations
        self.rows = tracking.simulate(orbit, earth_orientation, stations, rso="iss", seed=seed)
        starts = start_states.perturbed(orbit, self.rows, rso="iss", settings=BOUNDED_ESTIMATION, seed=seed)
        self.batch = estimation.estimate_all(flight, starts, self.measured(), settings=BOUNDED_ESTIMATION)

    def measured(self, rows=None):
        rows = self.rows if rows is None else rows
        return estimation.Measured(rows, self.earth_orientation, self.stations)

    def filtered(self, bank, batch=None):
        return filter_all(self.flight, self.batch if batch is None else batch, self.measured(), bank=bank)

    def true(self, table):
        states = self.orbit.set_index("t").loc[table["t"], STATE].to_numpy()
        return np.column_stack([states, np.full(len(table), self.flight.rso.cd)])

    def chi2(self, table):
        """Squared Mahalanobis distances of the estimates from the truth."""
        low = np.tril_indices(7)
        covariances = np.zeros((len(table), 7, 7))
        covariances[:, low[0], low[1]] = covariances[:, low[1], low[0]] = table[PARAMETER_COVARIANCES]
        parted = table[PARAMETERS].to_numpy() - self.true(table)
        return np.einsum("ni,nij,nj->n", parted, np.linalg.inv(covariances), parted)


def errors(case, table):
    """Position errors [m]."""
    return np.linalg.norm((table[PARAMETERS].to_numpy() - case.true(table))[:, :3], axis=1)


@pytest.fixture(scope="module")
def flight(assumed_model, iss):
    return Flight(assumed_model, iss)


@pytest.fixture(scope="module")
def calm(flight, earth_orientation, three_stations):
    """The drag keeps its value."""
    orbit = truth.simulate(flight, duration=2 * DAY, step=STEP)
    return Case(flight, orbit, earth_orientation, three_stations, seed=1)


@pytest.fixture(scope="module")
def rough(flight, earth_orientation, three_stations):
    """Its mean over a day scatters by a tenth."""
    return Case(flight, blown(flight, gust=0.1, seed=3), earth_orientation, three_stations, seed=1)


@pytest.fixture(scope="module")
def table(calm):
    return calm.filtered([CALM])


def begun(table):
    """Rows of the filters, well after they began."""
    return table[table["tracks_used"] > 8]


def test_one_row_a_track_in_the_columns_of_the_batch_fits(table, calm):
    assert table.columns.tolist() == calm.batch.columns.tolist()
    pd.testing.assert_frame_equal(table[["track", "t"]], calm.batch[["track", "t"]])
    last = table.iloc[-1]
    assert last["tracks_used"] == len(table)
    assert last["measurements_used"] == len(calm.rows)
    assert last["converged"] and last["reason"] == ""


def test_all_measurements_of_the_past_beat_those_of_a_window(table, calm):
    late = begun(table)
    assert len(late) > 10
    fits = calm.batch.loc[late.index]
    assert np.median(errors(calm, late)) < np.median(errors(calm, fits))
    assert late["cov_cd_cd"].iloc[-1] < fits["cov_cd_cd"].iloc[-1]
    assert abs(late["cd"].iloc[-1] - 2.2) < 4.0 * np.sqrt(late["cov_cd_cd"].iloc[-1])


def test_calm_drag_is_met_as_the_covariances_say(table, calm):
    late = begun(table)
    assert late["weighted_rms"].mean() == pytest.approx(1.0, abs=0.1)
    assert 3.5 < calm.chi2(late).mean() < 14.0


def test_gusts_are_met_as_the_covariances_say(rough):
    late = begun(rough.filtered([ROUGH]))
    assert late["weighted_rms"].mean() == pytest.approx(1.0, abs=0.1)
    assert 3.5 < rough.chi2(late).mean() < 14.0
    # A filter that takes the drag to be calm is far off, and sure of it.
    calm_one = begun(rough.filtered([CALM]))
    assert calm_one["weighted_rms"].mean() > 1.2
    assert rough.chi2(calm_one).mean() > 50.0


@pytest.mark.parametrize(("name", "noise"), [("calm", CALM), ("rough", ROUGH)])
def test_the_likeliest_noise_speaks(request, name, noise):
    case = request.getfixturevalue(name)
    bank, alone = case.filtered([CALM, ROUGH]), case.filtered([noise])
    formal = np.sqrt(alone["cov_cd_cd"].iloc[-1])
    assert bank["cd"].iloc[-1] == pytest.approx(alone["cd"].iloc[-1], abs=0.01 * formal)
    assert np.sqrt(bank["cov_cd_cd"].iloc[-1]) == pytest.approx(formal, rel=0.01)


def test_later_tracks_change_no_earlier_row(rough):
    half = int(rough.batch["track"].max()) // 2 + 3
    rows = rough.rows.copy()
    rows.loc[rows["track"] > half, "range"] += 500.0
    whole = filter_all(rough.flight, rough.batch, rough.measured(rows), bank=[CALM, ROUGH])
    before = rough.filtered([CALM, ROUGH])
    same = whole["track"] <= half
    pd.testing.assert_frame_equal(whole[same], before[same], check_exact=True)
    assert not np.allclose(whole["x"].iloc[-1], before["x"].iloc[-1], atol=1.0)


def test_threads_change_no_bit(rough):
    one = rough.filtered([CALM, ROUGH])
    two = filter_all(replace(rough.flight, threads=2), rough.batch, rough.measured(), bank=[CALM, ROUGH])
    pd.testing.assert_frame_equal(one, two, check_exact=True)


def test_rows_up_to_a_known_drag_are_those_of_the_batch_fits(calm):
    batch = calm.batch.copy()
    batch.loc[:5, "converged"] = False
    batch.loc[6:8, "cov_cd_cd"] = 1.5
    table = calm.filtered([CALM], batch)
    pd.testing.assert_frame_equal(table[NUMBERS][:10], batch[NUMBERS][:10])
    assert table["tracks_used"][10] == batch["tracks_used"][9] + 1


def test_after_an_arc_that_comes_down_the_filters_begin_again(calm):
    batch = calm.batch.copy()
    first = batch.index[batch["converged"] & (batch["cov_cd_cd"] < 1.0)][0]
    batch.loc[first, ["vx", "vy", "vz"]] *= 0.9
    table = calm.filtered([CALM], batch)
    pd.testing.assert_frame_equal(table[NUMBERS][: first + 2], batch[NUMBERS][: first + 2])
    assert table["converged"].iloc[-1]
    assert errors(calm, table.tail(1)) < 50.0


def test_a_drag_that_fits_hold_is_no_obstacle(calm):
    batch = calm.batch.copy()
    batch[[name for name in PARAMETER_COVARIANCES if "cd" in name]] = 0.0
    batch["cd"] = 2.2
    table = begun(calm.filtered([CALM], batch))
    assert np.isfinite(table[NUMBERS]).all().all()
    assert table["weighted_rms"].mean() == pytest.approx(1.0, abs=0.1)


def test_a_leg_carries_neighbours_as_they_fly(flight, calm):
    """Also an arc whose Cd and state are others, which the leg has not flown."""
    [start] = calm.orbit[STATE].to_numpy()[:1]
    seen = 5.3 * HOUR + np.arange(3) * STEP
    leg = Leg.fly(flight, np.append(start, 2.2), 0.0, seen)
    moved = np.append(start + [30.0, -20.0, 10.0, 0.02, 0.03, -0.01], 2.5)
    still = Filtering(flight, calm.measured(), [Noise(0.0, 0.0, 0.0)], light_time=False)
    flown = flight.fly(np.append(0.0, seen), moved[None, :6], cd=2.5, first=[0], last=[3]).path(0)
    mean, root = (value[0] for value in still.propagated(moved[None], np.eye(7)[None], leg))
    np.testing.assert_allclose(mean[:3], flown[0, :3], rtol=0.0, atol=0.5)
    assert mean[6] == 2.5
    at_rows = leg.seen + leg.to_seen @ (mean[:6] - leg.path[-1])
    np.testing.assert_allclose(at_rows[:, :3], flown[:, :3], rtol=0.0, atol=0.5)
    assert np.linalg.norm(flown[0, :3] - leg.path[-1, :3]) > 1000.0
    # Volume in the space of the states is kept, but for the drag.
    assert np.linalg.slogdet(root)[1] == pytest.approx(0.0, abs=0.01)


def test_gusts_walks_and_kicks_add_up(flight, calm):
    """Over a leg: Cd walks by its part of a day, and gusts move the state as their means over the steps do."""
    [start] = calm.orbit[STATE].to_numpy()[:1]
    leg = Leg.fly(flight, np.append(start, 2.2), 0.0, np.array([6.0 * HOUR]))
    run = Filtering(flight, calm.measured(), [Noise(0.1, 0.0, 0.0), Noise(0.0, 0.1, 0.0)], light_time=False)
    _, roots = run.propagated(np.tile(np.append(start, 2.2), (2, 1)), np.zeros((2, 7, 7)), leg)
    walked, blown_off = roots @ roots.transpose(0, 2, 1)
    assert np.sqrt(walked[6, 6]) == pytest.approx(0.1 * 2.2 * 0.5)
    # White noise moves along-track as the mean square of the time left: T^2 / sqrt(3) against T^2 / 2.
    by_cd = flight.fly(
        np.array([0.0, 6 * HOUR]), np.tile(start, (2, 1)), cd=np.array([2.2, 2.21]), first=[0, 0], last=[1, 1]
    ).states
    whole = np.linalg.norm(by_cd[1, :3] - by_cd[0, :3]) / 0.01
    expected = 0.1 * 2.2 * 2.0 * whole * 2.0 / np.sqrt(3.0)
    assert np.sqrt(np.trace(blown_off[:3, :3])) == pytest.approx(expected, rel=0.1)
    assert blown_off[6, 6] == 0.0


def test_a_leg_flies_under_what_is_known_when_its_track_begins(assumed_model, flight):
    """Of two outlooks the one before the track's begin counts, not the one before the leg's."""
    dense = assumed_model.activity * [1.5, 1.5, 1.0, 1.0]
    issued = np.array([-HOUR, 2 * HOUR, 8 * HOUR])
    outlooks = np.stack([assumed_model.activity, dense, assumed_model.activity])
    orbit = truth.simulate(flight, duration=STEP, step=STEP)
    parameters = np.append(orbit[STATE].to_numpy()[0], 2.2)
    seen = np.array([6.0 * HOUR])
    known = Leg.fly(replace(flight, model=assumed_model._replace(issued=issued, outlooks=outlooks)), parameters, 0.0, seen)
    under = Leg.fly(replace(flight, model=assumed_model._replace(activity=dense)), parameters, 0.0, seen)
    np.testing.assert_array_equal(known.path, under.path)
    assert not np.array_equal(known.path, Leg.fly(flight, parameters, 0.0, seen).path)
