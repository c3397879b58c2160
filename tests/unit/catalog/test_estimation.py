"""Batch least squares on measurements whose truth is known, and the fits that cannot succeed."""

from dataclasses import replace

import fits
import numpy as np
import pandas as pd
import pytest
from support import BOUNDED_ESTIMATION as SETTINGS, rsos

from opml.base.constants import DAY, HOUR
from opml.catalog.associate import quarantine
from opml.catalog.fit import estimation, neighbour_arcs, observations, start_states
from opml.catalog.fit.least_squares import UNDERDETERMINED
from opml.catalog.fit.starts import Solution, with_known_cd
from opml.catalog.propagator import Propagator
from opml.catalog.simulate import tracking, truth
from opml.tables import PARAMETER_COVARIANCES, PARAMETERS, STATE, symmetric_matrices

SIGMAS = [f"sigma_{name}" for name in tracking.QUANTITIES]


def estimates(model, orbit, rows, earth_orientation, stations, rso, *, threads=1, seed=42, **settings):
    propagator, settings = Propagator(model, rso, threads=threads), SETTINGS.evolve(**settings)
    return fits.fitted(propagator, orbit, rows, earth_orientation, stations, settings, seed=seed)


@pytest.fixture(scope="module")
def orbit(assumed_model, iss):
    """Two days of the paper's RSO under the assumed model itself."""
    return truth.simulate(Propagator(assumed_model, iss), duration=2 * DAY, step=20.0)


@pytest.fixture(scope="module")
def fitted(assumed_model, orbit, earth_orientation, three_stations, iss):
    """The table of estimates of rows of that orbit, with settings."""

    def fit(rows, *, stations=three_stations, rso=iss, **settings):
        return estimates(assumed_model, orbit, rows, earth_orientation, stations, rso, **settings)

    return fit


@pytest.fixture(scope="module")
def table(rows, fitted):
    return fitted(rows)


def test_perfect_measurements_give_the_truth(assumed_model, earth_orientation, three_stations, iss):
    """Without radiation pressure: the shadow's edge inside a step makes two grids differ by a decimetre."""
    smooth = replace(iss, cr=0.0)
    orbit = truth.simulate(Propagator(assumed_model, smooth), duration=DAY, step=20.0)
    rows = fits.without_noise(tracking.simulate(orbit, earth_orientation, three_stations, rso="iss", seed=1))
    found = estimates(assumed_model, orbit, rows, earth_orientation, three_stations, smooth, convergence=1e-6)
    many = found["tracks_used"] >= 3
    assert many.sum() > 10
    assert found["converged"].all()
    assert found["off"][many].max() < 1e-3
    assert np.abs(found["cd"][many] - iss.cd).max() < 1e-6
    assert found["weighted_rms"].max() < 1e-5


def test_one_row_a_track_with_its_window(table, rows):
    starts = rows.groupby("track")["t"].min()
    assert table["track"].tolist() == starts.index.tolist()
    np.testing.assert_array_equal(table["t"], starts)
    for row in table.itertuples():
        within = starts[(starts >= row.t - 12 * HOUR) & (starts <= row.t)]
        assert row.tracks_used == len(within)
        assert row.measurements_used == rows["track"].isin(within.index).sum()
    assert table["tracks_used"].iloc[0] == 1
    assert table["tracks_used"].max() > 3


def test_noisy_fits_err_as_their_covariances_say(table, orbit, rows):
    used = table[table["tracks_used"] >= 3]
    assert used["converged"].all()
    true = orbit.set_index("t").loc[used["t"], STATE].to_numpy()
    difference = used[PARAMETERS].to_numpy() - np.column_stack([true, np.full(len(used), 2.2)])
    chi2 = np.array(
        [
            d @ np.linalg.solve(p, d)
            for d, p in zip(difference, symmetric_matrices(used, PARAMETER_COVARIANCES), strict=True)
        ]
    )
    # Seven degrees of freedom; neighbouring windows share measurements, so the mean scatters.
    assert 3.5 < chi2.mean() < 14.0
    # Three numbers a measurement, less seven parameters.
    count = used["measurements_used"]
    expected = np.sqrt(1.0 - 7.0 / (3.0 * count))
    assert np.abs(used["weighted_rms"] - expected).max() < 5.0 / np.sqrt(6.0 * count.min())
    # Each covariance is one: symmetric by its layout, and positive.
    assert np.all(
        np.linalg.eigvalsh(
            symmetric_matrices(used, PARAMETER_COVARIANCES) / np.outer(*[[1e3] * 3 + [1.0] * 4] * 2)
        )
        > 0.0
    )


def test_the_last_step_is_flown_only_where_that_could_change_it(fitted, rows, table):
    given = rows
    further = fitted(given, convergence=1e-7)
    # From close by, two flights are enough: the second says how fast the steps shrink.
    assert (table["iterations"].iloc[estimation.BATCH :] == 2).all()
    assert (table["iterations"] <= further["iterations"]).all()
    moved = (table[PARAMETERS] - further[PARAMETERS]).to_numpy()
    doubt = np.sqrt(np.diagonal(symmetric_matrices(further, PARAMETER_COVARIANCES), axis1=1, axis2=2))
    assert np.abs(moved / doubt).max() < SETTINGS.convergence
    # What was not flown is told as it would have been found.
    np.testing.assert_allclose(table["weighted_rms"], further["weighted_rms"], rtol=1e-6)
    np.testing.assert_allclose(table["cov_x_x"], further["cov_x_x"], rtol=1e-3)


def test_fewer_measurements_leave_more_doubt(table):
    doubt = table["cov_cd_cd"] ** 0.5
    single, many = table["tracks_used"] == 1, table["tracks_used"] >= 5
    assert doubt[many].max() < 0.5 < doubt[single].min()


@pytest.fixture
def measured(rows, earth_orientation, three_stations):
    return observations.Measured(rows, earth_orientation, three_stations)


@pytest.fixture
def evaluated(assumed_model, iss, measured):
    """The evaluation of a window at parameters (7,)."""
    propagator = Propagator(assumed_model, iss)

    def evaluate(window, parameters):
        (around,), (lost,) = neighbour_arcs.propagate_around(
            propagator, measured.epochs, [window], parameters[None]
        )
        assert not lost
        return measured.evaluation(window, around.states)

    return evaluate


def nominal(orbit, measured, window):
    """The true parameters (7,) at the end of a window."""
    return np.append(orbit.set_index("t").loc[measured.epochs[window.at], STATE].to_numpy(), 2.2)


def test_partial_derivatives_are_what_central_differences_give(orbit, measured, evaluated):
    window = measured.window(4, 12 * HOUR)
    assert window.tracks > 1
    true = nominal(orbit, measured, window)
    jacobian = evaluated(window, true).jacobian
    for k, nudge in enumerate([20.0, 20.0, 20.0, 2e-2, 2e-2, 2e-2, 0.1]):
        plus, minus = (
            evaluated(window, true + sign * nudge * np.eye(7)[k]).residuals for sign in (1.0, -1.0)
        )
        # Residuals are measured less predicted.
        central = (minus - plus) / (2.0 * nudge)
        assert np.abs(jacobian[:, k] - central).max() < 2e-3 * np.abs(central).max()


def test_partial_derivatives_are_whole_across_north(orbit, rows, measured, evaluated):
    """Counting azimuth from where the RSO stands, so that neighbouring arcs lie on both sides of 0."""
    window = measured.window(1, 12 * HOUR)
    true = nominal(orbit, measured, window)
    expected = evaluated(window, true).jacobian
    azimuth = rows["azimuth_true"].to_numpy()
    cosine, sine, zero = np.cos(azimuth), np.sin(azimuth), np.zeros(len(azimuth))
    turn = np.array([[cosine, -sine, zero], [sine, cosine, zero], [zero, zero, zero + 1.0]])
    turned = np.einsum("ijn,njk->nik", turn, measured.stands.to_horizon)
    measured.stands = replace(measured.stands, to_horizon=turned)
    jacobian = evaluated(window, true).jacobian
    np.testing.assert_allclose(jacobian, expected, rtol=1e-4, atol=1e-6 * np.abs(expected).max())


@pytest.mark.parametrize("threads", [1, 2])
def test_rows_depend_neither_on_threads_nor_on_later_tracks(fitted, rows, table, threads):
    first = rows[rows["track"] < 9]
    found = fitted(first, threads=threads)
    pd.testing.assert_frame_equal(found, table.iloc[:9], check_exact=True)


def test_the_seed_is_of_the_start_only(fitted, rows, table):
    first = rows[rows["track"] < 6]
    other = fitted(first, seed=7)
    many = other["tracks_used"] >= 3
    assert many.any()
    moved = np.linalg.norm((other[["x", "y", "z"]] - table[["x", "y", "z"]].iloc[:6])[many], axis=1)
    # Both have converged to a thousandth of their own uncertainty.
    assert 0.0 < moved.max() < 1.0


def test_a_hopeless_window_is_a_row(fitted, rows):
    few = rows[rows["track"] == 0].iloc[:4]
    found = fitted(few).iloc[0]
    assert (found["tracks_used"], found["measurements_used"]) == (1, 4)
    assert np.isfinite(found[[*PARAMETERS, *PARAMETER_COVARIANCES]].to_numpy(float)).all()
    # A minute of measurements says nothing of drag.
    assert found["cov_cd_cd"] ** 0.5 > 100.0
    assert found["converged"] == (found["reason"] == "")


def test_too_few_measurements_for_seven_parameters(fitted, rows):
    found = fitted(rows.iloc[:2]).iloc[0]
    assert not found["converged"]
    assert found["reason"] == UNDERDETERMINED
    assert np.isfinite(found[[*PARAMETERS, *PARAMETER_COVARIANCES]].to_numpy(float)).all()


def test_a_start_that_decays_is_a_row_and_spoils_no_other(fitted, rows):
    first = rows[rows["track"] < 5]
    found = fitted(first, start_velocity_sigma_mps=3000.0)
    lost = ~found["converged"]
    # Whether it is lost on the way to the oldest measurement or to the newest.
    assert lost.sum() > 1
    assert (found["reason"][lost] == "start arc decayed below 120 km").all()
    assert found.loc[lost, PARAMETER_COVARIANCES].isna().all(axis=None)
    assert np.isfinite(found.loc[lost, PARAMETERS].to_numpy(float)).all()
    assert found["track"].tolist() == [0, 1, 2, 3, 4]
    assert found["converged"].iloc[0]
    alone = fitted(first[first["track"] == 0], start_velocity_sigma_mps=3000.0)
    pd.testing.assert_frame_equal(found.iloc[:1], alone, check_exact=True)


def test_high_orbits_leave_cd_at_its_a_priori_value(assumed_model, earth_orientation, three_stations):
    lageos = rsos()["lageos1"]
    high = truth.simulate(Propagator(assumed_model, lageos), duration=0.6 * DAY, step=20.0)
    rows = tracking.simulate(high, earth_orientation, three_stations, rso="lageos1", seed=1)
    found = estimates(assumed_model, high, rows, earth_orientation, three_stations, lageos)
    assert found["converged"].all()
    assert (found["cd"] == lageos.cd).all()
    assert (found[[name for name in PARAMETER_COVARIANCES if "cd" in name]] == 0.0).all(axis=None)
    assert (found["cov_x_x"] > 0.0).all()
    assert found["off"].max() < 300.0


def test_a_batch_starts_from_the_newest_usable_estimate(fitted, rows, monkeypatch):
    """Later batches start close by and are done soon; a Cd out of bounds is nothing to start from."""
    monkeypatch.setattr(estimation, "BATCH", 4)
    given = rows[rows["track"] < 8]
    close, afresh = fitted(given), fitted(given, cd_bounds=(9.0, 9.1))
    pd.testing.assert_frame_equal(close.iloc[:4], afresh.iloc[:4], check_exact=True)
    assert close["iterations"].iloc[4:].max() <= 5
    assert afresh["iterations"].iloc[4:].max() >= 8
    # Where they started does not show in what they found.
    moved = np.linalg.norm((close[["x", "y", "z"]] - afresh[["x", "y", "z"]]).iloc[4:], axis=1)
    assert moved.max() < 0.1


def test_without_bounds_every_converged_estimate_is_one_to_start_from(fitted, rows, monkeypatch):
    monkeypatch.setattr(estimation, "BATCH", 4)
    given = rows[rows["track"] < 8]
    # The fourth is within the paper's bounds, so it is the start of the second batch in either case.
    pd.testing.assert_frame_equal(fitted(given, cd_bounds=None), fitted(given), check_exact=True)


def test_a_fit_without_a_start_takes_the_newest_estimate_whatever_it_says_of_cd(
    assumed_model, orbit, rows, earth_orientation, three_stations, iss, monkeypatch
):
    """No orbit is given from the second batch on, and no Cd is within the bounds of the others' starts."""
    monkeypatch.setattr(estimation, "BATCH", 4)
    first = rows[rows["track"] < 12]
    starts = start_states.perturbed(orbit, first, rso="iss", settings=SETTINGS, seed=1)
    lost = starts.assign(**{name: starts[name].where(starts["track"] < 4) for name in STATE})
    measured = observations.Measured(first, earth_orientation, three_stations)
    settings = SETTINGS.evolve(cd_bounds=(9.0, 9.1))
    found, known, none = (
        quarantine.estimate_all(Propagator(assumed_model, iss), table, measured, settings=settings)
        for table in (lost, starts, lost.assign(x=np.nan))
    )
    assert found["converged"].all()
    moved = np.linalg.norm((found[["x", "y", "z"]] - known[["x", "y", "z"]]), axis=1)
    assert moved.max() < 0.1
    assert (none["reason"] == estimation.NO_START).all()


def test_an_absurd_estimate_is_nobodys_start():
    normal = np.linalg.inv(np.diag([1e4] * 3 + [1e-2] * 3 + [1.0]) + 0.9 * (_tied() + _tied().T))
    for cd, kept in ((4.2, True), (-424469.0, False)):
        best = np.append(np.full(6, 7e6), cd)
        known = with_known_cd(Solution(3, best, np.linalg.inv(normal), converged=True), 2.2)
        assert (known is not None) is kept
        if known:
            assert known[1][6] == pytest.approx(2.2)
            assert known[1][0] - 7e6 == pytest.approx(-2.0 * 90.0)  # along the covariance of x and Cd


def _tied():
    """Half of a covariance of 100 m of x by one of Cd."""
    half = np.zeros((7, 7))
    half[0, 6] = 100.0
    return half


def test_a_station_of_other_sigmas_weighs_otherwise(fitted, rows, three_stations, table):
    doubled = [
        replace(station, **{name: 2.0 * getattr(station, name) for name in SIGMAS})
        for station in three_stations
    ]
    first = rows[rows["track"] < 6]
    found = fitted(first, stations=doubled)
    many = (found["tracks_used"] >= 3).to_numpy()
    ratio = found.loc[many, "cov_x_x"] / table.iloc[:6].loc[many, "cov_x_x"]
    np.testing.assert_allclose(ratio, 4.0, rtol=0.02)
    np.testing.assert_allclose(
        found.loc[many, "weighted_rms"], 0.5 * table.iloc[:6].loc[many, "weighted_rms"], rtol=0.02
    )


def test_a_cd_that_is_believed_beforehand_stays_near_it(fitted, rows, iss, table):
    first = rows[rows["track"] < 16]
    heavier = replace(iss, cd=2.6)  # the orbit flew with 2.2
    held, weak = (fitted(first, rso=heavier, cd_sigma=sigma) for sigma in (1e-4, 1e4))
    assert np.abs(held["cd"] - 2.6).max() < 1e-2
    used = (weak["tracks_used"] >= 3).to_numpy()
    free = table["cd"].to_numpy()[:16][used]
    np.testing.assert_allclose(weak["cd"][used], free, atol=0.05)


def test_windows_of_several_lengths_side_by_side_have_the_bits_of_each_alone(
    assumed_model, orbit, rows, table, earth_orientation, three_stations, iss
):
    """One starts from an earlier fit, the other from the state that is given."""
    propagator, last = Propagator(assumed_model, iss), int(table["track"].iloc[-1])
    measured = observations.Measured(rows, earth_orientation, three_stations)
    starts = start_states.perturbed(orbit, rows, rso="iss", settings=SETTINGS, seed=1)
    earlier = {6.0: table.iloc[:0], 12.0: table.iloc[:-1]}
    found = estimation.estimate_over_windows(
        propagator, starts, measured, settings=SETTINGS, track=last, earlier=earlier
    )
    assert found["window_hours"].tolist() == [6.0, 12.0]
    for hours, known in earlier.items():
        alone = estimation.estimate_further(
            propagator,
            starts,
            measured,
            settings=SETTINGS.evolve(window_hours=hours),
            tracks=[last],
            earlier=known,
        )
        row = found[found["window_hours"] == hours].drop(columns="window_hours").reset_index(drop=True)
        assert row["converged"].all()
        pd.testing.assert_frame_equal(row, alone)
