"""The orbit that a set was fitted to is the orbit that is found inside it, whatever came later."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
import sinking_histories
from publisher import BALLISTIC, HALF, SUNLIT, begun, burned, published
from support import EPOCH
from weather_files import other_after

from opml.base import epochs
from opml.base.constants import DAY, HOUR
from opml.element_sets.improved_sizes import ExpectedErrors
from opml.element_sets.inside import inside_now, inside_sizes, orbit_inside, orbit_prediction, past_orbits
from opml.element_sets.inside.orbit_inside import NoOrbitError
from opml.element_sets.inside.past_orbits import PastOrbits, centred
from opml.interop.element_sets import element_set, mean_elements
from opml.interop.element_sets.burns_in_sets import KnownSet
from opml.orbits.elements import bent_rsw, positions_beside

DAYS = np.arange(0.0, 15.0, 1.5)  # epochs of the sets after EPOCH


@pytest.fixture(scope="module")
def sets(forces, truth):
    return [published(forces, truth, day) for day in DAYS]


@pytest.fixture(scope="module")
def past(forces, sets):
    """The orbits of the sets, from a wrong Cd A/m and a wrong Cr A/m."""
    begins = [
        begun(forces, satellite, day=day, reflection=0.02) for day, satellite in zip(DAYS, sets, strict=True)
    ]
    reach = np.full(len(sets), 96.0 * HOUR)
    orbits = orbit_inside.orbits_beside(
        forces, begins, back=reach, ahead=reach + past_orbits.REACH, is_lit=True
    )
    equations = [orbit.equations(satellite) for orbit, satellite in zip(orbits, sets, strict=True)]
    return PastOrbits(forces.time(EPOCH) + DAY * DAYS, orbits, equations)


def off(truth, orbit, numbers):
    """Return by how much an orbit is off the truth over its span (n, 3) [m]."""
    near = np.abs(orbit.t - orbit.beginning.t) <= HALF
    states = truth.states[np.searchsorted(truth.t, orbit.t[near])]
    return bent_rsw(orbit.positions(numbers, near), states)


def test_the_orbit_inside_is_the_one_that_the_set_was_made_of(forces, truth, sets):
    """SGP4 is hundreds of metres off all over the span; the orbit inside is not."""
    begin = begun(forces, sets[0], day=0.0)
    reach = np.array([HALF])
    for _ in range(2):
        [orbit] = orbit_inside.orbits_beside(forces, [begin], back=reach, ahead=reach)
        equations = orbit.equations(sets[0])
        numbers = orbit_inside.solve(orbit, [equations.over(begin.t - HALF, begin.t + HALF)])
        begin = orbit.begin_again(numbers)
    by_sgp4 = mean_elements.states(sets[0], epoch=forces.epoch, t=orbit.t)[:, :3]
    errors = bent_rsw(by_sgp4, truth.states[np.searchsorted(truth.t, orbit.t)])
    assert np.sqrt((errors**2).mean(axis=0)).min() > 50.0
    # Four days hardly tell a drag of half a metre a day: what is left lies along the track, at the ends.
    assert (np.abs(off(truth, orbit, numbers)).max(axis=0) < [6.0, 100.0, 1.0]).all()
    assert begin.ballistic == pytest.approx(BALLISTIC, abs=1e-2)


def test_sets_tell_the_span_over_which_they_were_fitted(past):
    spans = [centred(HOUR * hours) for hours in (24.0, 36.0, 48.0, 60.0, 72.0)]
    span, r, w = past_orbits.agreement(past, spans)
    assert span == centred(HALF)
    assert r < 20.0
    assert w < 3.0
    assert past_orbits.agreement(PastOrbits(past.t[:2], past.orbits[:2], past.equations[:2])) is None


def test_pairs_of_sets_tell_the_pressure_of_light(past):
    step = past.sunlight(centred(HALF))
    assert past.orbits[0].reflection(np.array([0.0] * 7 + [step])) == pytest.approx(SUNLIT, abs=2e-3)
    dark, lit = (past.errors(past.numbers(centred(HALF), light))["r"].median() for light in (0.0, step))
    assert lit < 0.5 * dark


def test_no_later_weather_counts(forces, sets, tmp_path, monkeypatch):
    """With other weather from the date on, the newest orbit and its prediction are the same to the bit."""
    sinking_histories.seek_coarsely(monkeypatch.setattr)
    date = "2016-10-10T12:00:00"
    t = DAY * DAYS + forces.time(EPOCH) - forces.time(date)
    public = [KnownSet(one, one, satellite) for one, satellite in zip(t, sets, strict=True) if one <= 0.0]
    assert 0 < len(public) < len(sets)
    today = epochs.mjd(date)
    other = other_after(tmp_path / "weather.csv", today)
    paths = [
        inside_now.find(public, date=date, forces=inside_now.forces_on(date, weather)).predict(3.0)[1]
        for weather in ("OBSERVED", other)
    ]
    assert np.isfinite(paths[0]).all()
    np.testing.assert_array_equal(*paths)
    late = other_after(tmp_path / "late.csv", today - 3.0)
    changed = inside_now.find(public, date=date, forces=inside_now.forces_on(date, late)).predict(3.0)[1]
    assert not np.array_equal(changed, paths[0])


def now_of(past, forces):
    """The orbit inside the ninth set on a date, as a span of HALF on both sides gives it."""
    numbers = past.numbers(centred(HALF))
    calibration = past_orbits.Calibration(centred(HALF), np.nan, np.nan, 0.0, past.errors(numbers))
    date = "2016-10-12T00:00:00"
    return inside_now.InsideNow(forces, date, 0.3, calibration, past.orbits[8], numbers[8])


def test_an_orbit_is_shifted_along_its_track_as_asked(past, forces):
    """Energy, phase and drag change: the distance outwards goes with them."""
    sizes = now_of(past, forces)
    shift = np.array([[0.0, 0.0, 10.0], [1.0, 500.0, 10.0], [3.0, 4500.0, 10.0]])
    (t, plain), (_, shifted) = (sizes.predict(3.0, one) for one in (None, shift))
    ahead = bent_rsw(shifted[:, :3], plain)
    assert ahead[t == DAY, 1] == pytest.approx(500.0, abs=60.0)
    assert ahead[t == 3.0 * DAY, 1] == pytest.approx(4500.0, abs=150.0)
    assert ahead[t == 3.0 * DAY, 0] < -5.0


def test_sizes_are_those_of_the_past_and_grow(past, forces):
    now = now_of(past, forces)
    sizes = inside_sizes.sizes(now, inside_sizes.rms(now))[["r", "s", "w"]]
    assert (sizes.diff().iloc[1:] >= 0.0).all(axis=None)
    errors = now.calibration.errors.assign(w=400.0)
    off = replace(now, calibration=now.calibration._replace(errors=errors))
    worse = inside_sizes.sizes(off, inside_sizes.rms(off))
    assert (worse["w"] > 200.0).all()
    assert (worse[["r", "s"]] == sizes[["r", "s"]]).all(axis=None)
    few = replace(now, calibration=now.calibration._replace(errors=errors[errors["days"] < 2.0]))
    by_sgp4 = inside_sizes.sizes(few, inside_sizes.rms(few))["sgp4"]
    assert by_sgp4.notna().tolist() == [True, True, False, False, False]
    # Behind these leads they grow as those of the improved set.
    growth = pd.Series([1.0, 2.0, 4.0, 8.0, 16.0], by_sgp4.index)
    improved = ExpectedErrors(pd.DataFrame({"s": growth, "sgp4": growth}), few.calibration.errors, "")
    orbit = orbit_prediction.OrbitInside(np.zeros_like, few, inside_sizes.rms(few), is_corrected=False)
    grown = orbit.errors(improved, 1.0).sizes["sgp4"]
    np.testing.assert_allclose(grown, [by_sgp4[0], *(by_sgp4[1] * growth[1:] / 2.0)])


def test_what_no_orbit_fits_says_so(forces, sets):
    begin = begun(forces, sets[0], day=0.0, ballistic=1e4)
    reach = np.array([HALF])
    [orbit] = orbit_inside.orbits_beside(forces, [begin], back=reach, ahead=reach)
    equations = orbit.equations(sets[0]).over(begin.t - HALF, begin.t + HALF)
    with pytest.raises(NoOrbitError, match="no orbit under full forces fits its sets"):
        orbit_inside.solve(orbit, [equations])


def test_bent_axes_go_both_ways():
    states = np.array([[7e6, 1e5, 2e5, 100.0, 5e3, 5e3], [-6e6, 3e6, 1e6, 1e3, 2e3, -7e3]])
    bent = np.array([[100.0, 2e5, -300.0], [-50.0, -4e5, 80.0]])
    np.testing.assert_allclose(bent_rsw(positions_beside(states, bent), states), bent, atol=1e-6)


def test_a_set_without_drag_does_not_sink():
    still, sinking = (
        element_set.satellite(EPOCH, [2.0 * np.pi / 94.0, 1e-3, 1.2, 0.5, 1.0, 0.3, bstar])
        for bstar in (0.0, 1e-3)
    )
    assert element_set.decay(still) == pytest.approx(0.0, abs=0.1)
    assert element_set.decay(sinking) > 50.0
    assert orbit_inside.usual_half_span(still) == 168.0 * HOUR
    assert orbit_inside.usual_half_span(sinking) < 72.0 * HOUR


def test_sets_of_before_a_burn_do_not_count(forces, truth, sets):
    """A burn of 3 mm/s, which makes the orbit 6 m larger, is not in the sets that the newest is of."""
    date = "2016-10-10T12:00:00"
    now = forces.time(date)
    t = DAY * DAYS + forces.time(EPOCH) - now
    after = burned(forces, truth, day=0.0, speed=3e-3)
    before = np.flatnonzero(t <= 0.0)
    newest = before[-1]
    public = [KnownSet(t[k], t[k], sets[k]) for k in before[:-1]]
    public.append(KnownSet(t[newest], t[newest], published(forces, after, DAYS[newest])))
    assert public[-1].t - public[-2].t < DAY * inside_now.BEFORE
    inside = inside_now.find(public, date=date, forces=forces)
    near = np.abs(inside.orbit.t - now) <= DAY
    flown = np.searchsorted(after.t, inside.orbit.t[near])
    off = bent_rsw(inside.orbit.positions(inside.numbers, near), after.states[flown])
    # One set hardly tells the drag. With those of before the burn it would be off by 2 km along the track.
    assert (np.abs(off).max(axis=0) < [10.0, 200.0, 5.0]).all()
