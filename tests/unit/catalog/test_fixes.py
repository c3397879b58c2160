"""Fits to positions of an orbit that is known: fixes in stretches, points before epochs of elements."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from support import BOUNDED_ESTIMATION

from opml.base.constants import DAY, HOUR
from opml.base.errors import InputError
from opml.catalog.associate import quarantine
from opml.catalog.fit import fixes
from opml.catalog.fit.first import first_orbit
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
    return quarantine.estimate_all(propagator, starts, measured, settings=settings)


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


def test_windows_restart_after_a_burn_that_is_known(orbit):
    table = fixes.arcs(points(orbit, sigmas=TEN), length=6 * HOUR)
    burn = Manoeuvre(9.0 * HOUR, 18.0 * HOUR, restarts=True)
    measured = fixes.Fixes(table).restart_after_burns([burn])
    # Nobody knew at 12 h.
    assert [measured.window(track, 20 * HOUR).tracks for track in range(4)] == [1, 2, 3, 2]
    unmoved = fixes.Fixes(table).restart_after_burns([replace(burn, restarts=False)])
    assert unmoved.window(3, 20 * HOUR).tracks == 4


def test_stretches_are_cut_from_the_epoch_so_that_gaps_and_more_points_move_none(orbit):
    rows = points(orbit, sigmas=TEN)
    gappy = rows[(rows["t"] < 2 * HOUR) | (rows["t"] > 6.5 * HOUR)]
    table = fixes.arcs(gappy, length=HOUR)
    first = table.groupby("track").first()
    assert first["t"].iloc[:3].tolist() == [0.0, HOUR, 6.5 * HOUR + 120.0]
    assert fixes.Fixes(table).states is None


def test_wrong_points_are_told_in_one_line(orbit):
    rows = points(orbit, sigmas=TEN, velocities=True)
    half = rows.assign(sigma_vr=rows["sigma_vr"].where(rows["t"] > 600.0))
    with pytest.raises(InputError, match=r"expected sigmas of velocities in all rows or none.* at 0.000 s"):
        fixes.Fixes(fixes.arcs(half))
    for wrong in (rows.assign(sigma_s=0.0), rows.assign(vx=np.nan)):
        with pytest.raises(InputError, match="expected numbers, and sigmas above 0, of all that counts"):
            fixes.Fixes(fixes.arcs(wrong))
