"""Fits to positions of an orbit that is known: fixes in stretches, points before epochs of elements."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from support import BOUNDED_ESTIMATION

from opml.base.constants import DAY, HOUR
from opml.base.errors import InputError
from opml.catalog.fit import estimation, fixes, sequential
from opml.catalog.fit.first import first_orbit
from opml.catalog.predict import labels, prediction
from opml.catalog.propagator import Propagator
from opml.catalog.simulate import truth
from opml.orbits.elements import in_rsw, rsw_rotation
from opml.orbits.manoeuvres import Manoeuvre
from opml.tables import FIX_SIGMAS, PARAMETER_COVARIANCES, STATE, symmetric_matrices

SETTINGS = BOUNDED_ESTIMATION.evolve(window_hours=9.0, convergence=1e-5)


@pytest.fixture(scope="module")
def propagator(assumed_model, iss):
    """Without radiation pressure, whose edge of the shadow makes two grids differ by a decimetre."""
    return Propagator(assumed_model, replace(iss, cr=0.0))


@pytest.fixture(scope="module")
def orbit(propagator):
    return truth.simulate(propagator, duration=DAY, step=120.0)


def points(orbit, *, sigmas, velocities=False, seed=None):
    """Points of an orbit with noise of the sigmas (6,) in RSW, or without noise."""
    states = orbit[STATE].to_numpy()
    if seed is not None:
        noise = np.random.default_rng(seed).normal(size=states.shape) * sigmas
        parts = noise.reshape(-1, 2, 3)
        states = states + np.einsum("nji,nkj->nki", rsw_rotation(states), parts).reshape(-1, 6)
    table = pd.DataFrame(states, columns=STATE).assign(t=orbit["t"].to_numpy())
    table[FIX_SIGMAS] = np.asarray(sigmas, float)
    if not velocities:
        table[[*STATE[3:], *FIX_SIGMAS[3:]]] = np.nan
    return table


def stretched(orbit, *, length=3 * HOUR, **given):
    return fixes.arcs(points(orbit, **given), length=length)


def estimates(propagator, table, **settings):
    settings = SETTINGS.evolve(**settings)
    measured = fixes.Fixes(table)
    starts = first_orbit.starts(propagator, measured, known=None, settings=settings)
    return estimation.estimate_all(propagator, starts, measured, settings=settings)


def off(found, orbit):
    """Errors (n, 3) of the estimates' positions in RSW [m]."""
    true = orbit.set_index("t").loc[found["t"], STATE].to_numpy()
    return in_rsw(found[STATE].to_numpy() - true, true)[:, :3]


def full(found):
    return found[found["tracks_used"] == 4]


TEN = np.array([10.0] * 3 + [0.01] * 3)


@pytest.mark.parametrize("velocities", [False, True])
def test_a_clean_orbit_is_recovered_to_a_millimetre(propagator, orbit, velocities):
    found = estimates(propagator, stretched(orbit, sigmas=TEN, velocities=velocities))
    assert found["converged"].all()
    assert found["tracks_used"].tolist() == [1, 2, 3, *[4] * 6]
    assert np.abs(off(full(found), orbit)).max() < 1e-3
    assert np.abs(full(found)["cd"] - propagator.rso.cd).max() < 1e-5


@pytest.mark.parametrize("velocities", [False, True])
def test_noise_of_ten_metres_leaves_residuals_of_one_sigma(propagator, orbit, velocities):
    found = full(estimates(propagator, stretched(orbit, sigmas=TEN, velocities=velocities, seed=3)))
    numbers = (6 if velocities else 3) * found["measurements_used"].to_numpy()
    expected = np.sqrt(1.0 - 7.0 / numbers)
    assert np.abs(found["weighted_rms"] - expected).max() < 5.0 / np.sqrt(2.0 * numbers.min())
    # Errors are as large as the covariances say.
    covariance = symmetric_matrices(found, PARAMETER_COVARIANCES)
    true = orbit.set_index("t").loc[found["t"], STATE].to_numpy()
    error = found[[*STATE, "cd"]].to_numpy() - np.column_stack([true, np.full(len(true), propagator.rso.cd)])
    chi2 = [d @ np.linalg.solve(p, d) for d, p in zip(error, covariance, strict=True)]
    assert 2.0 < np.mean(chi2) < 20.0


def test_weights_are_those_of_radial_along_and_cross_track(propagator, orbit):
    """Noise of a kilometre along the track harms nothing where the sigmas say so, and much where not."""
    sigmas = np.array([5.0, 1000.0, 5.0, 1.0, 1.0, 1.0])
    noisy = points(orbit, sigmas=sigmas, seed=5)
    told = full(estimates(propagator, fixes.arcs(noisy, length=3 * HOUR)))
    alike = noisy.assign(**dict.fromkeys(FIX_SIGMAS[:3], 10.0))
    untold = full(estimates(propagator, fixes.arcs(alike, length=3 * HOUR)))
    assert np.abs(off(told, orbit)[:, [0, 2]]).max() < 5.0
    assert np.median(np.abs(off(untold, orbit)[:, 0])) > 5.0 * np.median(np.abs(off(told, orbit)[:, 0]))


def test_windows_begin_anew_behind_a_burn_that_is_known(orbit):
    epochs = np.array([6.0, 12.0, 18.0, 23.0]) * HOUR
    table = sets(orbit, epochs, reach=5 * HOUR, known=np.full(4, np.nan), sigmas=TEN)
    burn = Manoeuvre(9.0 * HOUR, 18.0 * HOUR, restarts=True)
    measured = fixes.Fixes(table).restart_after_burns([burn])
    windows = [measured.window(track, 20 * HOUR) for track in range(4)]
    # Nobody knew at 12 h; the points of that set begin before the burn.
    assert [window.tracks for window in windows] == [1, 2, 1, 2]
    assert [measured.epochs[window.first] / HOUR for window in windows] == [1.0, 1.0, 13.0, 13.0]
    unmoved = fixes.Fixes(table).restart_after_burns([replace(burn, restarts=False)])
    assert unmoved.window(3, 20 * HOUR).tracks == 4


def test_windows_of_long_sets_are_no_longer_in_time():
    """Of 96 hours and sets of a day no point is older than 120 hours, nor of 96 and sets of three days."""
    orbit = pd.DataFrame(np.ones((25, 6)), columns=STATE).assign(t=np.arange(25) * 12 * HOUR)
    epochs = np.arange(3.0, 13.0) * DAY
    for reach, oldest in ((DAY, 8.0), (3 * DAY, 10.0), (8 * DAY, 12.0)):
        measured = fixes.Fixes(sets(orbit, epochs, reach=reach, known=np.full(10, np.nan), sigmas=TEN))
        window = measured.window(9, 4 * DAY)
        assert window.tracks == 13 - oldest
        assert measured.epochs[window.first] == oldest * DAY - reach


def test_fits_to_sets_start_from_their_own_states(propagator, orbit):
    """An earlier estimate, whose Cd is wild, is days of flight away."""
    table = sets(orbit, np.array([6.0, 18.0]) * HOUR, reach=5 * HOUR, known=(np.nan,) * 2, sigmas=TEN)
    measured = fixes.Fixes(table)
    starts = first_orbit.starts(propagator, measured, known=None, settings=SETTINGS)
    run = estimation.Run.of_starts(propagator, starts, measured, SETTINGS)
    usable = int(measured.at[0]), np.append(starts[STATE].to_numpy()[0], -7.0)
    first, second, *_ = run.starts.in_turn([measured.window(1, DAY)], usable, None)
    np.testing.assert_array_equal(first[0], [*measured.states[1], propagator.rso.cd])
    assert second[0, 6] == -7.0
    # A velocity that was measured may be a metre a second off.
    assert not fixes.Fixes(stretched(orbit, sigmas=TEN, velocities=True)).of_theory


def test_estimates_depend_neither_on_threads_nor_on_later_fixes(propagator, orbit):
    table = stretched(orbit, sigmas=TEN, velocities=True, seed=3)
    found = estimates(propagator, table)
    other = estimates(replace(propagator, threads=2), table[table["track"] < 5])
    pd.testing.assert_frame_equal(other, found.iloc[:5], check_exact=True)


def test_a_filter_takes_fixes_too(propagator, orbit):
    table = stretched(orbit, sigmas=TEN, seed=3)
    found = sequential.filter_all(propagator, estimates(propagator, table), fixes.Fixes(table))
    assert np.linalg.norm(off(found.iloc[-2:], orbit), axis=1).max() < 10.0
    assert found["measurements_used"].iloc[-1] == len(table)


def sets(orbit, epochs, *, reach=12 * HOUR, known=(np.nan,) * 3, **given):
    """The table of sets at epochs, each with the points of so long before it."""
    rows = points(orbit, velocities=True, **given)
    before = [
        rows[(rows["t"] <= epoch) & (rows["t"] >= epoch - reach)].assign(track=track)
        for track, epoch in enumerate(epochs)
    ]
    return fixes.of_sets(np.asarray(epochs), pd.concat(before), known=np.asarray(known))


def test_sets_are_told_from_points_along_an_orbit(orbit):
    assert fixes.are_of_sets(sets(orbit, [DAY], known=[np.nan], sigmas=TEN))
    assert not fixes.are_of_sets(fixes.arcs(points(orbit, sigmas=TEN)))
    assert not fixes.are_of_sets(pd.DataFrame({"track": [0], "t": [5.0]}))


def test_a_set_is_fitted_at_its_epoch_to_the_points_before_it(propagator, orbit):
    epochs = np.array([12.0, 17.0, 23.0]) * HOUR
    table = sets(orbit, epochs, sigmas=TEN)
    alone = estimates(propagator, table, window_hours=0.0)
    assert alone["t"].tolist() == epochs.tolist()
    assert (alone["tracks_used"] == 1).all()
    assert alone["measurements_used"].tolist() == [361] * 3
    assert np.abs(off(alone, orbit)).max() < 1e-3
    # A state that is known elsewhere is carried to the epochs, too, and one is determined from positions.
    measured = fixes.Fixes(table)
    start = orbit[STATE].to_numpy()[0]
    carried = first_orbit.starts_from_state(propagator, measured, (0.0, start))
    assert carried["t"].tolist() == epochs.tolist()
    assert np.abs(off(carried, orbit)).max() < 1.0
    determined = first_orbit.determined(propagator, measured, settings=SETTINGS)
    assert np.abs(off(determined, orbit)).max() < 1.0
    # Sets within the window join; the points of the older ones are the window's oldest.
    window = measured.window(2, 8 * HOUR)
    assert (window.tracks, window.measurements) == (2, 722)
    assert measured.epochs[[window.first, window.at, window.last]].tolist() == [5 * HOUR, *[23 * HOUR] * 2]


def test_a_set_is_known_at_its_epoch_and_no_filter_goes_back_to_its_points(propagator, orbit):
    epochs = np.array([12.0, 17.0, 23.0]) * HOUR
    table = sets(orbit, epochs, sigmas=TEN)
    found = estimates(propagator, table)
    pairs = prediction.predict_all(propagator, None, found, max_days=1.0)
    known = labels.build(pairs, found, table)
    assert known.groupby("j")["t_known"].first().tolist() == epochs[1:].tolist()
    # Where files tell when sets were made, an estimate waits for all that it is made of.
    late = sets(orbit, epochs, sigmas=TEN, known=np.array([13.0, 25.0, 24.0]) * HOUR)
    known = labels.build(pairs, found, late)
    assert known.groupby("j")["t_known"].first().tolist() == [25 * HOUR] * 2
    with pytest.raises(InputError, match="filter: expected tracks that begin with their estimates"):
        sequential.filter_all(propagator, found, fixes.Fixes(table))


def test_stretches_are_cut_from_the_epoch_so_that_gaps_and_more_points_move_none(orbit):
    rows = points(orbit, sigmas=TEN)
    gappy = rows[(rows["t"] < 2 * HOUR) | (rows["t"] > 6.5 * HOUR)]
    table = fixes.arcs(gappy, length=HOUR)
    first = table.groupby("track").first()
    assert first["t"].iloc[:3].tolist() == [0.0, HOUR, 6.5 * HOUR + 120.0]
    assert (first["t"] == first["t_estimate"]).all()
    assert fixes.Fixes(table).states is None


def test_wrong_points_are_told_in_one_line(orbit):
    rows = points(orbit, sigmas=TEN, velocities=True)
    half = rows.assign(sigma_vr=rows["sigma_vr"].where(rows["t"] > 600.0))
    with pytest.raises(InputError, match=r"expected sigmas of velocities in all rows or none.* at 0.000 s"):
        fixes.Fixes(fixes.arcs(half))
    for wrong in (rows.assign(sigma_s=0.0), rows.assign(vx=np.nan)):
        with pytest.raises(InputError, match="expected numbers, and sigmas above 0, of all that counts"):
            fixes.Fixes(fixes.arcs(wrong))
    with pytest.raises(InputError, match=r"expected ascending epochs, got 7200.000 s twice"):
        fixes.of_sets(np.array([7200.0, 7200.0]), rows.assign(track=0), known=np.full(2, np.nan))
