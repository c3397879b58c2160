"""The sequential filter on measurements whose truth is known, with a drag that keeps or changes its value."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from support import ESTIMATION

from opml.base.constants import DAY, HOUR
from opml.catalog.fit.estimation import Run
from opml.catalog.fit.observations import Measured
from opml.catalog.fit.sequential import Filtering, Leg, Noise, filter_all
from opml.catalog.simulate import tracking, truth
from opml.tables import PARAMETER_COVARIANCES, PARAMETERS, STATE, symmetric_matrices

CALM = Noise(walk=1e-6, gust=1e-6, impulse=1e-7)
GUSTY = Noise(walk=1e-6, gust=0.1, impulse=1e-7)
STEP = 20.0
PIECE = HOUR / 2
SIGMAS = np.array([20.0, 20.0, 20.0, 0.02, 0.02, 0.02, 0.2])
"""Of the estimates that filters begin from [m, m/s, -]."""

CD_COVARIANCES = [name for name in PARAMETER_COVARIANCES if "cd" in name]


class Case:
    """A simulated orbit, its tracks, and estimates of known errors in the place of batch fits."""

    def __init__(self, propagator, orbit, earth_orientation, stations, *, seed):
        self.propagator, self.orbit, self.seed = propagator, orbit, seed
        self.earth_orientation, self.stations = earth_orientation, stations
        self.rows = tracking.simulate(orbit, earth_orientation, stations, rso="iss", seed=seed)
        self.estimates = self._estimates()

    def _estimates(self):
        begins = self.rows.groupby("track")["t"].min()
        noise = np.random.default_rng(self.seed).normal(size=(len(begins), 7)) * SIGMAS
        covariance = np.diag(SIGMAS**2)[np.tril_indices(7)]
        table = pd.DataFrame({"track": begins.index, "t": begins.to_numpy()})
        table[PARAMETERS] = self.true(table) + noise
        table[PARAMETER_COVARIANCES] = np.tile(covariance, (len(table), 1))
        measurements = self.rows.groupby("track").size().to_numpy()
        fit = {"iterations": 3, "converged": True, "reason": "", "tracks_used": 1}
        return table.assign(**fit, measurements_used=measurements, weighted_rms=1.0)

    def measured(self, rows=None):
        return Measured(self.rows if rows is None else rows, self.earth_orientation, self.stations)

    def filtered(self, *bank, estimates=None):
        estimates = self.estimates if estimates is None else estimates
        return filter_all(self.propagator, estimates, self.measured(), bank=bank)

    def true(self, table):
        states = self.orbit.set_index("t").loc[table["t"], STATE].to_numpy()
        return np.column_stack([states, np.full(len(table), self.propagator.rso.cd)])

    def errors(self, table):
        return table[PARAMETERS].to_numpy() - self.true(table)

    def chi2(self, table):
        """Squared Mahalanobis distances of estimates from the truth."""
        parted = self.errors(table)
        return np.einsum(
            "ni,nij,nj->n", parted, np.linalg.inv(symmetric_matrices(table, PARAMETER_COVARIANCES)), parted
        )


def blown(propagator, *, gust, seed, duration):
    """Truth whose Cd is another in each half hour; gust: what its mean over a day is off by, as a part."""
    [state] = truth.simulate(propagator, duration=STEP, step=STEP)[STATE].to_numpy()[:1]
    noise, pieces = np.random.default_rng(seed), [state[None]]
    for begin in np.arange(0.0, duration, PIECE):
        epochs = np.arange(begin, begin + PIECE + STEP, STEP)
        cd = propagator.rso.cd * (1.0 + gust * np.sqrt(DAY / PIECE) * noise.normal())
        pieces.append(
            propagator.propagate(epochs, pieces[-1][-1:], cd=cd, first=[0], last=[len(epochs) - 1]).path(0)
        )
    states = np.concatenate(pieces)
    t = STEP * np.arange(len(states))
    return pd.DataFrame({"t": t, **dict(zip(STATE, states.T, strict=True))})


@pytest.fixture(scope="module")
def calm(propagator, earth_orientation, three_stations):
    """The drag keeps its value; several noises of the measurements."""
    orbit = truth.simulate(propagator, duration=1.5 * DAY, step=STEP)
    return [Case(propagator, orbit, earth_orientation, three_stations, seed=seed) for seed in range(6)]


@pytest.fixture(scope="module")
def gusty(propagator, earth_orientation, three_stations):
    """The mean of the drag over a day scatters by a tenth; several gusts and noises."""
    orbits = [blown(propagator, gust=0.1, seed=seed, duration=1.5 * DAY) for seed in range(3)]
    return [
        Case(propagator, orbit, earth_orientation, three_stations, seed=k) for k, orbit in enumerate(orbits)
    ]


@pytest.fixture(scope="module")
def start(calm):
    """State and Cd at the epoch."""
    return np.append(calm[0].orbit[STATE].to_numpy()[0], 2.2)


def test_one_row_a_track_in_the_columns_of_batch_fits(calm):
    table = calm[0].filtered(CALM)
    assert table.columns.tolist() == calm[0].estimates.columns.tolist()
    pd.testing.assert_frame_equal(table[["track", "t"]], calm[0].estimates[["track", "t"]])
    np.testing.assert_array_equal(table["tracks_used"], np.arange(len(table)) + 1)
    assert table["measurements_used"].iloc[-1] == len(calm[0].rows)
    assert table["converged"].all()
    assert (table["reason"] == "").all()


def test_without_noise_the_last_row_is_the_batch_fit_of_all_tracks(calm):
    """But for the first one, which is in the estimate to begin with, of which next to nothing is believed."""
    case = calm[0]
    loose = case.estimates.copy()
    loose[PARAMETER_COVARIANCES] *= 1e6
    loose["cov_cd_cd"] = 1.0
    table = case.filtered(CALM, estimates=loose)
    filtered = table.iloc[-1]
    states, t = case.estimates[STATE].to_numpy(), case.estimates["t"].to_numpy()
    settings = ESTIMATION.evolve(window_hours=(t[-1] - t[1]) / HOUR + 0.1)
    run = Run.of_states(case.propagator, states, case.measured(), settings, ages=np.zeros(len(states)))
    window = run.window(len(states) - 1)
    starts = run.starts.in_turn([window], None, None)
    [estimate] = run.fit_windows([window], starts, [run.method(np.ones(7, dtype=bool))])
    fitted = run.row(estimate)
    parted = np.array([filtered[name] - fitted[name] for name in PARAMETERS])
    formal = estimate.fit.covariance
    # The first legs are flown from what little is known by then, and bend.
    assert np.abs(parted / np.sqrt(np.diag(formal))).max() < 0.5
    [covariance] = symmetric_matrices(table.tail(1), PARAMETER_COVARIANCES)
    unit = np.sqrt(np.outer(np.diag(formal), np.diag(formal)))
    np.testing.assert_allclose(covariance / unit, formal / unit, rtol=0.0, atol=0.1)
    np.testing.assert_allclose(np.diag(covariance / unit), 1.0, atol=0.02)
    first = case.estimates["measurements_used"][0]
    assert filtered["measurements_used"] == fitted["measurements_used"] + first


@pytest.mark.parametrize(("name", "noise"), [("calm", CALM), ("gusty", GUSTY)])
def test_estimates_err_as_their_covariances_say(request, name, noise):
    cases = request.getfixturevalue(name)
    late = [case.filtered(noise)[5:] for case in cases]
    rms = np.concatenate([table["weighted_rms"] for table in late])
    assert rms.mean() == pytest.approx(1.0, abs=0.05)
    # Seven degrees of freedom; rows of one case share their past, so the mean scatters.
    chi2 = np.concatenate([case.chi2(table) for case, table in zip(cases, late, strict=True)])
    assert 4.0 < chi2.mean() < 11.0


def test_a_filter_without_gusts_is_sure_of_what_is_wrong(gusty):
    late = gusty[0].filtered(CALM)[5:]
    assert late["weighted_rms"].mean() > 1.2
    assert gusty[0].chi2(late).mean() > 100.0


@pytest.mark.parametrize(("name", "noise"), [("calm", CALM), ("gusty", GUSTY)])
def test_the_likeliest_noise_speaks(request, name, noise):
    case = request.getfixturevalue(name)[0]
    bank, alone = (case.filtered(*noises).iloc[-1] for noises in ([CALM, GUSTY], [noise]))
    formal = np.sqrt(alone["cov_cd_cd"])
    assert bank["cd"] == pytest.approx(alone["cd"], abs=0.01 * formal)
    assert np.sqrt(bank["cov_cd_cd"]) == pytest.approx(formal, rel=0.01)


def test_later_tracks_change_no_earlier_row(gusty):
    case, half = gusty[0], gusty[0].estimates["track"].max() // 2
    rows = case.rows.copy()
    rows.loc[rows["track"] > half, "range"] += 500.0
    moved = filter_all(case.propagator, case.estimates, case.measured(rows), bank=[CALM, GUSTY])
    table = case.filtered(CALM, GUSTY)
    pd.testing.assert_frame_equal(moved[: half + 1], table[: half + 1], check_exact=True)
    assert abs(moved["x"].iloc[-1] - table["x"].iloc[-1]) > 1.0


def test_threads_change_no_bit(gusty):
    case = gusty[0]
    two = filter_all(replace(case.propagator, threads=2), case.estimates, case.measured(), bank=[CALM, GUSTY])
    pd.testing.assert_frame_equal(two, case.filtered(CALM, GUSTY), check_exact=True)


def test_rows_before_a_fit_that_filters_can_begin_at_are_those_of_the_batch_fits(calm):
    estimates = calm[0].estimates.copy()
    estimates.loc[:1, "converged"] = False
    table = calm[0].filtered(CALM, estimates=estimates)
    pd.testing.assert_frame_equal(table[:3], estimates[:3])
    assert table["tracks_used"][3] == estimates["tracks_used"][2] + 1


def test_a_fit_that_tells_nothing_of_the_drag_is_no_obstacle(calm):
    """Its Cd is wild, and its state where that Cd would have it."""
    estimates = calm[0].estimates.copy()
    shift = np.array([3.0, 50.0, 2.0, 0.05, 0.003, 0.002])
    names = [f"cov_cd_{name}" for name in STATE]
    estimates.loc[0, [*STATE, "cd"]] += np.append(shift, 50.0)
    estimates.loc[0, names] += 50.0 * shift
    estimates.loc[0, "cov_cd_cd"] += 50.0**2
    for k, axis in enumerate(STATE):
        for m in range(k + 1):
            estimates.loc[0, f"cov_{axis}_{STATE[m]}"] += shift[k] * shift[m]
    table = calm[0].filtered(CALM, estimates=estimates)
    assert np.abs(table["cd"][5:] - 2.2).max() < 0.5
    assert np.linalg.norm(calm[0].errors(table)[-1, :3]) < 50.0


def test_filters_begin_again_after_an_arc_that_comes_down(calm):
    estimates = calm[0].estimates.copy()
    estimates.loc[0, ["vx", "vy", "vz"]] *= 0.9
    table = calm[0].filtered(CALM, estimates=estimates)
    pd.testing.assert_frame_equal(table[:2], estimates[:2])
    assert np.linalg.norm(calm[0].errors(table)[-1, :3]) < 50.0


def test_a_drag_that_fits_hold_is_no_obstacle(calm):
    estimates = calm[0].estimates.assign(cd=2.2, **dict.fromkeys(CD_COVARIANCES, 0.0))
    table = calm[0].filtered(CALM, estimates=estimates)[5:]
    assert table["weighted_rms"].mean() == pytest.approx(1.0, abs=0.1)
    assert table["cd"].to_numpy() == pytest.approx(2.2, abs=1e-3)


def test_progress_is_told_to_the_end(calm):
    shares = []
    propagator = replace(calm[0].propagator, progress=shares.append)
    table = filter_all(propagator, calm[0].estimates, calm[0].measured(), bank=[CALM])
    assert shares == [(k + 1) / len(table) for k in range(len(table))]


def propagated(case, leg, noise, mean, root):
    """Mean and root of a single filter at the end of a leg."""
    run = Filtering(case.propagator, case.measured(), [noise], light_time=False)
    means, roots = run.propagated(mean[None], root[None], leg)
    return means[0], roots[0]


def test_a_leg_carries_its_neighbours_as_they_fly(propagator, calm, start):
    seen = 5.3 * HOUR + np.arange(3) * STEP
    leg = Leg.propagate(propagator, start, 0.0, seen)
    beside = start + [30.0, -20.0, 10.0, 0.02, 0.03, -0.01, 0.3]
    flown = propagator.propagate(np.append(0.0, seen), beside[None, :6], cd=2.5, first=[0], last=[3]).path(0)
    assert np.linalg.norm(flown[0, :3] - leg.path[-1, :3]) > 500.0
    mean, root = propagated(calm[0], leg, Noise(0.0, 0.0, 0.0), beside, np.eye(7))
    assert mean[6] == 2.5
    shown = leg.seen + leg.to_seen @ (mean[:6] - leg.path[-1])
    np.testing.assert_allclose(shown[:, :3], flown[:, :3], rtol=0.0, atol=0.5)
    # The volume of a covariance is kept, but for the drag.
    assert np.linalg.slogdet(root)[1] == pytest.approx(0.0, abs=0.01)


def test_gusts_move_the_state_as_arcs_with_gusts_are_moved(propagator, calm, start):
    leg = Leg.propagate(propagator, start, 0.0, np.array([6.0 * HOUR]))
    root = propagated(calm[0], leg, Noise(0.0, 0.1, 0.0), start, np.zeros((7, 7)))[1]
    pieces = 12
    states = np.tile(start[:6], (pieces + 1, 1))
    for k in range(pieces):
        cd = np.full(pieces + 1, 2.2)
        cd[k] += 0.01
        epochs = np.array([k, k + 1]) * PIECE
        states = propagator.propagate(
            epochs, states, cd=cd, first=[0] * (pieces + 1), last=[1] * (pieces + 1)
        ).states
    moved = (states[:-1] - states[-1]) / 0.01 * 0.1 * 2.2 * np.sqrt(DAY / PIECE)
    expected = np.sqrt(np.diag(moved.T @ moved))
    np.testing.assert_allclose(np.linalg.norm(root, axis=1)[:6], expected, rtol=0.02)
    assert np.linalg.norm(root[6]) == 0.0


def test_walks_and_kicks_add_up_to_those_of_a_day(propagator, calm, start):
    leg = Leg.propagate(propagator, start, 0.0, np.array([6.0 * HOUR]))
    root = propagated(calm[0], leg, Noise(0.1, 0.0, 0.0), start, np.zeros((7, 7)))[1]
    assert np.linalg.norm(root[6]) == pytest.approx(0.1 * 2.2 * np.sqrt(0.25))
    short = Leg.propagate(propagator, start, 0.0, np.array([1.0]))
    root = propagated(calm[0], short, Noise(0.0, 0.0, 1e-3), start, np.zeros((7, 7)))[1]
    covariance = root[3:6] @ root[3:6].T
    assert np.trace(covariance) == pytest.approx(2.0 * 1e-6 / DAY, rel=1e-3)
    along = start[3:6] / np.linalg.norm(start[3:6])
    assert along @ covariance @ along < 1e-3 * np.trace(covariance)


def test_a_leg_flies_under_what_is_known_when_its_track_begins(assumed_model, propagator, start):
    """Of three outlooks the newest before the track counts, not that before the leg, nor a later one."""
    quiet = assumed_model.activity
    active = quiet * [1.5, 1.5, 1.0, 1.0]
    outlooks = np.concatenate([activity.reshape(1, -1, 4) for activity in (quiet, active, quiet)])
    issued, known = np.array([-1.0, 2.0, 8.0]) * HOUR, np.zeros(3, int)
    model = assumed_model._replace(issued=issued, known=known, outlooks=outlooks)
    paths = [
        Leg.propagate(replace(propagator, model=model), start, 0.0, np.array([6.0 * HOUR])).path
        for model in (model, assumed_model._replace(activity=active), assumed_model)
    ]
    np.testing.assert_array_equal(paths[0], paths[1])
    assert not np.array_equal(paths[0], paths[2])
