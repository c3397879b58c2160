"""Tracks that are held back: of another object, and behind a burn until the new orbit stands."""

from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from fits import fitted
from support import BOUNDED_ESTIMATION as SETTINGS

from opml.base.constants import DAY, HOUR
from opml.catalog.associate import quarantine
from opml.catalog.associate.innovations import ReferenceOrbit
from opml.catalog.fit.least_squares import Method
from opml.catalog.simulate import tracking, truth
from opml.catalog.simulate.observing import QUANTITIES, sigmas, wrapped
from opml.orbits.elements import rsw_rotation
from opml.tables import BURN, SCHEMAS, STATE, read_table, write_table

WATCHING = SETTINGS.evolve(suspect_sigma=6.0)
BURN_AT = 0.8 * DAY
CHANGE = np.array([0.0, 0.2, 0.0])
LENGTH = 1.4 * DAY


@pytest.fixture(scope="module")
def orbit(propagator):
    return truth.simulate(propagator, duration=LENGTH, step=20.0)


@pytest.fixture(scope="module")
def burnt(propagator, orbit):
    """The orbit with a burn."""
    t = orbit["t"].to_numpy()
    first = int(np.searchsorted(t, BURN_AT))
    state = orbit[STATE].to_numpy()[first].copy()
    state[3:] += rsw_rotation(state[None])[0].T @ CHANGE
    arcs = propagator.propagate(
        t[first:], state[None], cd=propagator.rso.cd, first=[0], last=[len(t) - first - 1]
    )
    behind = orbit.copy()
    behind.loc[first + 1 :, STATE] = arcs.path(0)
    return behind


@pytest.fixture(scope="module")
def seen(earth_orientation, three_stations):
    """The table of tracking of an orbit."""

    def made(orbit):
        return tracking.simulate(orbit, earth_orientation, three_stations, rso="iss", seed=1)

    return made


@pytest.fixture(scope="module")
def estimates(propagator, earth_orientation, three_stations):
    """The table of estimates of rows, with settings, and how far they are off."""

    def made(orbit, rows, settings=WATCHING):
        return fitted(propagator, orbit, rows, earth_orientation, three_stations, settings)

    return made


@pytest.fixture(scope="module")
def clean(orbit, seen, estimates):
    return estimates(orbit, seen(orbit))


@pytest.fixture(scope="module")
def foreign(orbit, seen):
    """Tracks of which one is of an object that passes ten seconds later, and its number."""
    rows = seen(orbit)
    late = seen(orbit.assign(t=orbit["t"] + 20.0)).set_index(["t", "station"])[QUANTITIES]
    track = int(rows["track"].max()) - 4
    of_track = (rows["track"] == track).to_numpy()
    theirs = late.reindex(pd.MultiIndex.from_frame(rows[["t", "station"]])).to_numpy()
    spoilt = rows.copy()
    spoilt.loc[of_track, QUANTITIES] = theirs[of_track]
    return spoilt.dropna(subset=QUANTITIES), track


@pytest.fixture(scope="module")
def after_burn(burnt, seen, estimates):
    return estimates(burnt, seen(burnt))


def test_without_the_setting_all_tracks_count(orbit, seen, estimates, clean):
    plain = estimates(orbit, seen(orbit), SETTINGS)
    assert "held_back" not in plain
    assert not clean["held_back"].any()
    assert (clean["tracks_left_out"] == 0).all()
    assert clean[BURN].isna().all(axis=None)
    np.testing.assert_allclose(clean["off"], plain["off"], atol=0.5)


def test_a_track_of_another_object_is_held_back_and_left_out(orbit, estimates, foreign, clean, tmp_path):
    rows, track = foreign
    found = estimates(orbit, rows)
    assert found.loc[found["held_back"], "track"].tolist() == [track]
    assert found["reason"].tolist() == [quarantine.HELD_BACK * (k == track) for k in found["track"]]
    assert found["tracks_left_out"].tolist() == [0] * (track + 1) + [1] * (len(found) - track - 1)
    assert found[BURN].isna().all(axis=None)
    assert found["off"].iloc[track + 1 :].max() < 2.0 * clean["off"].iloc[5:].max()
    pd.testing.assert_frame_equal(found.iloc[:track], clean.iloc[:track])
    write_table(tmp_path / "estimates", found.drop(columns="off"), "estimates", metadata={})
    marks = ["held_back", "tracks_left_out", *BURN]
    assert list(read_table(tmp_path / "estimates", "estimates")) == [*SCHEMAS["estimates"].names, *marks]


def test_single_outliers_hold_no_track_back_where_they_are_rejected(orbit, seen, estimates, three_stations):
    rows, spread = seen(orbit), {station.name: sigmas(station, QUANTITIES) for station in three_stations}
    generator = np.random.default_rng(7)
    hit = generator.random((len(rows), 3)) < 0.03
    values = rows[QUANTITIES].to_numpy() + 100.0 * hit * np.array([spread[name] for name in rows["station"]])
    spoilt = rows.assign(**dict(zip(QUANTITIES, wrapped(values, QUANTITIES).T, strict=True)))
    found = estimates(orbit, spoilt, WATCHING.evolve(reject_sigma=5.0))
    assert not found["held_back"].any()
    assert found["rejected_of_track"].sum() == hit.sum()


def test_a_burn_is_found_with_its_time_and_size(after_burn):
    shown = after_burn[after_burn["burn_t"].notna()]
    assert len(shown) == 1
    row = shown.iloc[0]
    assert row["t"] - BURN_AT < 6.0 * HOUR
    assert abs(row["burn_t"] - BURN_AT) < 0.5 * HOUR
    assert row["burn_y"] == pytest.approx(CHANGE[1], abs=0.02)
    between = after_burn["t"].between(BURN_AT, row["t"], inclusive="left")
    assert between.any()
    assert after_burn["held_back"].tolist() == between.tolist()


def test_fits_begin_anew_behind_a_burn(after_burn, clean):
    since = after_burn[after_burn["t"] > BURN_AT]
    told = since[~since["held_back"]]
    assert told["converged"].all()
    assert told["tracks_used"].tolist() == list(range(2, 2 + len(told)))
    assert told["off"].iloc[1:].max() < 3.0 * clean["off"].iloc[5:].max()


def test_what_is_told_at_a_track_rests_on_tracks_up_to_it(burnt, seen, estimates, after_burn):
    rows = seen(burnt)
    last = int(after_burn.loc[after_burn["held_back"], "track"].iloc[0])
    until = estimates(burnt, rows[rows["track"] <= last])
    pd.testing.assert_frame_equal(until, after_burn.iloc[: last + 1])


def test_what_nothing_explains_for_longer_than_a_window_counts_again(orbit, seen, estimates, monkeypatch):
    """No fit takes a track in that is far, none agree: after six hours they count all the same."""
    monkeypatch.setattr(quarantine.Watch, "_takes_in", lambda *_: False)
    monkeypatch.setattr(quarantine, "farthest", lambda *_: 1.0 + 1e3 * (len(reached) > 6))
    reached, accepted = [], quarantine.Watch._accepted
    monkeypatch.setattr(
        quarantine.Watch, "_accepted", lambda *call: reached.extend(call[2]) or accepted(*call)
    )
    found = estimates(orbit, seen(orbit), WATCHING.evolve(window_hours=6.0))
    times, held = found["t"].to_numpy(), found["held_back"].to_numpy()
    first = int(np.argmax(held))
    again = first + int(np.argmin(held[first:]))
    assert held[first:again].all()
    assert again == int(np.searchsorted(times, times[first] + 6.0 * HOUR))


def estimate_of(cd, covariance):
    """An estimate that converged."""
    fit = SimpleNamespace(converged=True, best=np.append(np.zeros(6), cd), covariance=covariance)
    return SimpleNamespace(window=SimpleNamespace(track=3, at=7), fit=fit)


@pytest.mark.parametrize(("cd", "goes"), [(2.0, True), (2.9, True), (3.2, False), (0.8, False)])
def test_a_fit_that_needs_another_drag_takes_no_far_track_in(monkeypatch, cd, goes):
    monkeypatch.setattr(quarantine.Watch, "_takes_in", lambda *_: True)
    watch = quarantine.Watch(SimpleNamespace(settings=WATCHING), Method(np.ones(7), np.ones(7, bool), 1e-3))
    watch._before = [ReferenceOrbit(0, 0, np.append(np.zeros(6), 2.0), np.zeros((7, 7)))]
    assert watch._goes_across(estimate_of(cd, np.zeros((7, 7)))) == goes


@pytest.mark.parametrize(("cd", "away", "used"), [(2.1, 9.0, 0), (2.1, 2.0, 1), (6.0, 9.0, 1)])
def test_a_burn_begins_at_the_newest_orbit_that_it_did_not_bend(monkeypatch, cd, away, used):
    """The newest was predicted from if it is far, and has the drag of the one a window older."""
    asked = []
    monkeypatch.setattr(quarantine.Watch, "_orbit", lambda watch, tracks, before: asked.append(before))
    watch = quarantine.Watch(SimpleNamespace(settings=WATCHING), Method(np.ones(7), np.ones(7, bool), 1e-3))
    watch._waiting = [8, 9]
    watch._before = [
        ReferenceOrbit(k, 0, np.append(np.zeros(6), one), np.zeros((7, 7))) for k, one in ((1, cd), (0, 2.0))
    ]
    for past in watch._past:
        past.extend([1.0] * 5)
    assert watch._burn([away, 9.0]) is None
    assert [one.track for one in asked] == [1 - used]


def test_an_orbit_whose_fit_tells_no_cd_is_moved_to_where_it_would_be():
    covariance = np.eye(7)
    covariance[6, 6], covariance[0, 6], covariance[6, 0] = 1e6, 1e4, 1e4
    covariance[0, 0] = 101.0
    orbit = ReferenceOrbit.of_estimate(estimate_of(52.2, covariance), 2.2)
    assert orbit.parameters[6] == pytest.approx(2.2, abs=1e-3)
    assert orbit.parameters[0] == pytest.approx(-0.5, abs=1e-3)
    assert orbit.covariance[6, 6] == pytest.approx(1.1**2, rel=1e-3)
    assert orbit.covariance[0, 0] == pytest.approx(1.0, rel=1e-3)
    held = np.diag([1.0] * 6 + [0.0])
    assert ReferenceOrbit.of_estimate(estimate_of(0.0, held), 0.0).parameters.tolist() == [0.0] * 7
    far = covariance * 1.0
    far[0, 6] = far[6, 0] = 1e9
    assert ReferenceOrbit.of_estimate(estimate_of(52.2, far), 2.2) is None
