"""Mornings of an object: each once, from nothing that came after it, the same in whatever pieces they run."""

import shutil
from dataclasses import replace
from datetime import date, timedelta

import numpy as np
import pandas as pd
import pytest
from support import EPOCH, ESTIMATION, refusal

from opml.base.constants import DAY, HOUR
from opml.base.errors import InputError
from opml.catalog.fit import fixes
from opml.catalog.predict.weather_spread import Weathers
from opml.catalog.propagator import Propagator
from opml.catalog.simulate import tracking, truth
from opml.dynamics.shared_blocks import SharedBlocks
from opml.element_sets import station_passes
from opml.ephemerides.along_track_shift import corrected
from opml.interop import ccsds, known_orbits
from opml.interop.object_ids import ObjectId
from opml.learning.models import learners
from opml.mornings import candidates, days, fits
from opml.mornings.calendar import Calendar
from opml.mornings.days import UnderWay
from opml.mornings.kept.store import Store
from opml.mornings.morning import tracked
from opml.mornings.outcomes import DO_NOT_USE, UNPROVEN
from opml.mornings.records import Records
from opml.mornings.watched_object import MorningPlan, ObjectPropagators, Watched
from opml.orbits.manoeuvres import Manoeuvre
from opml.tables import FIX_SIGMAS, SCHEMAS, STATE

ARC = {"window_hours": 18.0, "memory_days": 30.0}
MODELS = {
    "fit18": learners.of_job({"kind": "refitted", "window_hours": 18.0, "variables": ["l_arc_y"]}),
    "running18": learners.of_job(
        {"kind": "running", "variables": ["l_arc_y", "v_arc_y", "cd_arc", "cd_past"], **ARC}
    ),
}
CALENDAR = Calendar(EPOCH, hour=13.0)  # the epoch is at 12:10
FIRST = date.fromisoformat(EPOCH[:10])
LAST = FIRST + timedelta(days=4)
METADATA = {"epoch": EPOCH, "settings": "digest"}
BATCH = "batch_0"
SANTIAGO = station_passes.place("-33.4,-70.6,500")


@pytest.fixture(scope="module")
def orbit(truth_model, iss):
    """Five days of the paper's RSO."""
    return truth.simulate(Propagator(truth_model, iss), duration=5 * DAY, step=20.0)


@pytest.fixture(scope="module")
def watched(orbit, assumed_model, iss, earth_orientation, three_stations):
    """The orbit, watched by three stations."""
    measured = tracking.simulate(orbit, earth_orientation, three_stations, rso="iss", seed=1)
    propagator = Propagator(assumed_model, iss)
    first = (0.0, orbit[STATE].to_numpy()[0])
    plan = MorningPlan(MODELS, ESTIMATION, 2.0, 60.0, 7 * DAY, EPOCH, passes=[SANTIAGO])
    model = ObjectPropagators(
        propagator, propagator, propagator, Weathers.of(assumed_model, None), earth_orientation
    )
    identity = ObjectId("ISS", "1998-067A", 25544)
    return Watched(model, plan, measured, three_stations, given=first, identity=identity)


def begin(store, name, watched, until):
    """An object before the first of its mornings that are not over."""
    shared = name, tracked(watched), CALENDAR, store, "digest"
    return UnderWay.begin(*shared, done=store.done(until)[name], until=until)


def run(watched, folder, until=LAST):
    store = Store(folder, "0", ["iss"])
    days.catch_up(store, [begin(store, "iss", watched, until)], until, metadata=METADATA)
    return folder


def left(folder, day=LAST):
    """What a morning left."""
    return Store(folder, "0", ["iss"]).places(day)["iss"]


def told(folder, day=LAST):
    """What became of the object on a day."""
    return left(folder, day).outcomes["iss"]


def rows(folder, table, dates):
    """The rows of a table of some mornings."""
    return pd.concat([left(folder, day).rows(table, "iss") for day in dates], ignore_index=True)


def done(folder):
    """The dates of mornings that are over."""
    return Store(folder, "0", ["iss"]).done(LAST)["iss"]


@pytest.fixture(scope="module")
def whole(watched, tmp_path_factory):
    """The folder of all mornings, run at once."""
    return run(watched, tmp_path_factory.mktemp("whole"))


def carried_on(whole, watched, folder, after):
    """Mornings after a date, run in a folder that has those of `whole` up to then: tracks are the same."""
    for made in sorted(whole.iterdir()):
        if made.name <= after.isoformat():
            shutil.copytree(made, folder / made.name)
    return run(watched, folder)


def contents(folder, until=LAST):
    """The bytes of the mornings up to a date, by their files."""
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in files
        if path.relative_to(folder).parts[0] <= until.isoformat()
    }


def test_mornings_that_run_one_by_one_leave_the_same_bytes(watched, whole, tmp_path):
    for day in range(1, 5):
        run(watched, tmp_path, FIRST + timedelta(days=day))
    assert contents(tmp_path) == contents(whole)


def test_what_comes_after_a_morning_changes_nothing_of_it(watched, whole, tmp_path):
    until = FIRST + timedelta(days=3)
    now = CALENDAR.time(until)
    ends = watched.tracking.groupby("track")["t"].transform("max")
    noise = np.where(ends > now, 1.0, 0.0) * np.random.default_rng(1).normal(size=len(ends))
    other = watched.tracking.assign(range=watched.tracking["range"] + 1e3 * noise)
    assert (noise != 0.0).any()
    run(replace(watched, tracking=other), tmp_path, LAST)
    assert contents(tmp_path, until) == contents(whole, until)
    assert contents(tmp_path) != contents(whole)


def test_a_morning_that_was_cut_short_runs_again(watched, whole, tmp_path):
    """Whatever it left before it ended is written anew; what is over stays as it is."""
    carried_on(whole, watched, tmp_path, LAST)
    last, before = (tmp_path / day.isoformat() / BATCH for day in (LAST, LAST - timedelta(days=1)))
    (last / "done.json").unlink()
    (last / "judged.parquet").write_bytes(b"half")
    made = (before / "done.json").stat().st_mtime_ns
    run(watched, tmp_path)
    assert contents(tmp_path) == contents(whole)
    assert (before / "done.json").stat().st_mtime_ns == made


def test_every_track_is_estimated_once_and_judges_what_was_flown_before(watched, whole):
    dates = done(whole)
    assert dates[-1] == LAST
    made = rows(whole, "kept_estimates", dates)
    base = made[made["window_hours"] == ESTIMATION.window_hours]
    by_track = watched.tracking.groupby("track")["t"]
    over = by_track.max() <= CALENDAR.time(LAST)
    np.testing.assert_array_equal(np.sort(base["t"]), by_track.min()[over])
    for day in dates:
        judged = rows(whole, "judged", [day])
        now = CALENDAR.time(day)
        assert (judged["t_known"] <= now).all()
        assert (judged["morning"] < now).all()
        assert (judged["t_known"] > now - DAY).all()


def test_passes_are_those_of_the_message(whole):
    folder = whole / LAST.isoformat() / "iss"
    rows = pd.read_csv(folder / "passes.csv")
    (message,) = known_orbits.segments(folder / "iss.oem", epoch=EPOCH)
    (date,) = ccsds.utc_texts(EPOCH, message.t[:1])
    expected = station_passes.passes(message.shifted(-message.t[0]), date, SANTIAGO)
    assert len(rows) == len(expected) >= 5
    np.testing.assert_allclose(rows["elevation"], expected["elevation"], atol=1e-3)
    assert (rows["early_or_late"] > 0.0).all()


def test_what_leaves_is_the_path_of_the_model_that_the_past_chose(whole):
    found = told(whole)
    assert found["model"] in MODELS
    assert found["verdict"] == UNPROVEN  # after few mornings
    assert found["past"]["all"][0]["along_track_m"] < 200.0
    assert found["mornings"][-1] == {"date": LAST.isoformat(), "verdict": UNPROVEN}
    assert [one["day"] for one in found["expected"]] == [1, 2]
    (paths,) = (one.table for one in left(whole).paths("iss"))
    (segment,) = known_orbits.segments(whole / LAST.isoformat() / "iss" / "iss.oem", epoch=EPOCH)
    states = corrected(
        paths["t_j"].to_numpy(), np.ascontiguousarray(paths[STATE]), paths[f"e_y_{found['model']}"].to_numpy()
    )
    both = np.isin(segment.t, paths["t_j"])
    nodes = np.isin(paths["t_j"], segment.t)
    assert both.sum() > 100
    # Derivatives at nodes five minutes apart are less sharp at the ends.
    apart = np.linalg.norm(segment.states[both, :3] - states[nodes, :3], axis=1)
    assert np.median(apart) < 0.1
    assert apart.max() < 5.0
    assert len(segment.covariance_t) > 100
    sigmas = np.sqrt(segment.covariances[:, 1, 1])
    after = np.interp(paths["t_i"].iloc[0] + DAY, segment.covariance_t, sigmas)
    assert found["expected"][0]["along_track_sigma_m"] == pytest.approx(after, rel=0.02)


def test_a_morning_without_a_new_estimate_is_judged_once(watched, whole, tmp_path):
    """What leaves starts where that of the morning before did, and is the same but for its last hours."""
    ends = watched.tracking.groupby("track")["t"].transform("max")
    before = FIRST + timedelta(days=3)
    silent = watched.tracking[ends <= CALENDAR.time(before)]
    carried_on(whole, replace(watched, tracking=silent), tmp_path, before)
    assert rows(tmp_path, "issued", done(tmp_path)[-2:])["i"].nunique() == 1
    assert not left(tmp_path).paths("iss")
    assert (tmp_path / LAST.isoformat() / "iss" / "iss.oem").exists()
    judged = rows(tmp_path, "judged", done(tmp_path))
    assert not judged.duplicated(["model", "i", "j"]).any()


def test_an_ephemeris_without_a_message_is_told_all_the_same(watched, whole, tmp_path):
    carried_on(whole, watched, tmp_path, LAST)
    for name in (BATCH, "iss"):
        shutil.rmtree(tmp_path / LAST.isoformat() / name)
    store = Store(tmp_path, "0", ["iss"])
    silent = replace(watched, plan=replace(watched.plan, has_message=False))
    days.catch_up(store, [begin(store, "iss", silent, LAST)], LAST, metadata=METADATA)
    assert not (tmp_path / LAST.isoformat() / "iss").exists()
    assert told(tmp_path) == told(whole) | {"message": None}
    assert told(tmp_path)["expected"]


def test_an_object_that_is_seldom_seen_is_watched_on(watched, tmp_path):
    """One track a day: of the newest five estimates some are older than the windows reach."""
    begins = watched.tracking.groupby("track")["t"].min()
    seldom = begins.groupby(np.floor(begins / DAY)).idxmin().to_numpy()
    seen = watched.tracking[watched.tracking["track"].isin(seldom)]
    numbered = seen.assign(track=np.searchsorted(seldom, seen["track"]))
    run(replace(watched, tracking=numbered), tmp_path)
    assert begins[seldom[-1]] - begins[seldom[0]] > watched.plan.reach
    assert told(tmp_path)["verdict"] == DO_NOT_USE  # one track does not tell an orbit


def test_a_burn_that_nobody_named_is_found_and_windows_begin_anew_behind_it(
    watched, whole, orbit, truth_model, iss, tmp_path
):
    propagator, burn = Propagator(truth_model, iss), 3.2 * DAY
    orbit = orbit.copy()
    later = orbit["t"].to_numpy() >= burn
    state = orbit.loc[later, STATE].to_numpy()[0].copy()
    state[3:] += 0.5 * state[3:] / np.linalg.norm(state[3:])
    path = propagator.propagate(
        orbit["t"][later], state[None], cd=iss.cd, first=[0], last=[later.sum() - 1]
    ).path(0)
    orbit.loc[later, STATE] = np.vstack([state, path])
    orientation, stations = watched.model.orientation, watched.stations
    measured = tracking.simulate(orbit, orientation, stations, rso="iss", seed=1)
    pd.testing.assert_frame_equal(*(rows[rows["t"] < burn] for rows in (measured, watched.tracking)))
    carried_on(whole, replace(watched, tracking=measured), tmp_path, FIRST + timedelta(days=3))
    issued = rows(tmp_path, "issued", done(tmp_path))
    assert issued["burn_t"].iloc[:-1].isna().all()
    assert issued["burn_t"].iloc[-1] == pytest.approx(burn, abs=600.0)
    assert told(tmp_path)["burn"][:13] == "2016-10-01T16"
    made = rows(tmp_path, "kept_estimates", [LAST])
    behind = made[made["t"] > burn].set_index("t")
    assert behind["converged"].sum() > 5
    off = behind[STATE[:3]].sub(orbit.set_index("t").loc[behind.index, STATE[:3]])
    assert np.linalg.norm(off, axis=1)[behind["converged"]].max() < 500.0


def test_what_went_across_a_burn_has_no_say_once_it_is_known():
    across = (
        SCHEMAS["judged"].empty().reindex(range(4)).assign(t_i=[1.0, 4.5, 5.5, 6.5], t_j=[6.0, 7.0, 7.0, 7.0])
    )
    issued = SCHEMAS["issued"].empty().reindex(range(2)).assign(morning=[6.0, 8.0], burn_t=[np.nan, 5.0])
    made = SCHEMAS["kept_estimates"].empty().reindex(range(3)).assign(t=[4.0, 5.5, 6.5], window_hours=1.0)
    hours = DAY / HOUR
    scaled = {
        "judged": across.assign(t_i=across["t_i"] * DAY, t_j=across["t_j"] * DAY),
        "issued": issued * DAY,
        "estimates": made.assign(t=made["t"] * DAY, window_hours=hours, converged=True),
    }
    records = Records(**scaled)
    # A burn that tracks showed on the morning after 6.0, and the same one found in mean elements by then.
    sets = replace(records, issued=SCHEMAS["issued"].empty())
    assert sets.rows_unaffected_by_burns(hours).index.tolist() == [0, 1, 2, 3]
    for known, burns in ((records, []), (sets, [Manoeuvre(5.0 * DAY, 6.0 * DAY, restarts=True)])):
        assert known.rows_unaffected_by_burns(hours, burns).index.tolist() == [
            3
        ]  # across, across, from a fit across, free
        assert known.of_window(hours, burns)["converged"].tolist() == [True, False, True]
        assert known.estimates_over(hours)["converged"].all()


def test_estimates_are_in_the_order_of_tracks_though_the_newest_was_fitted_before_another():
    made = SCHEMAS["kept_estimates"].empty().reindex(range(3))
    made = made.assign(
        track=[16, 18, 17], t=[16.0, 18.0, 17.0], window_hours=96.0, converged=[True, False, True]
    )
    known = replace(Records.empty(), estimates=made)
    for found in (known.estimates_over(96.0), known.of_window(96.0)):
        assert found["t"].tolist() == [16.0, 17.0, 18.0]
        assert found["converged"].tolist() == [True, True, False]


def test_a_first_morning_says_that_it_has_no_past(whole):
    found = told(whole, done(whole)[0])
    assert (found["verdict"], found["message"]) == (DO_NOT_USE, None)
    assert found["reason"] == "no estimate that an ephemeris may start from"


@pytest.fixture(scope="module")
def by_points(watched, truth_model, iss):
    """Two objects whose positions are known every ten minutes, the second higher up."""
    objects = {}
    for name, raised in (("low", 0.0), ("high", 30e3)):
        rso = replace(iss, name=name, a=iss.a + raised)
        orbit = truth.simulate(Propagator(truth_model, rso), duration=4 * DAY, step=600.0)
        noise = np.random.default_rng(len(objects)).normal(scale=10.0, size=(len(orbit), 3))
        points = orbit[["t", *STATE]].copy()
        points[STATE[:3]] += noise
        sigmas = dict.fromkeys(FIX_SIGMAS[:3], 10.0) | dict.fromkeys(FIX_SIGMAS[3:], np.nan)
        table = fixes.arcs(points.assign(**sigmas), length=6 * HOUR)
        first = (0.0, orbit[STATE].to_numpy()[0])
        objects[name] = replace(watched, tracking=table, stations=[], given=first), rso
    return objects


def beside(objects, folder, until):
    """Run the mornings of objects in one job, and return what each left."""
    blocks, store = SharedBlocks(), Store(folder, "0", objects)
    under_way = []
    for name, (one, rso) in objects.items():
        propagator = replace(one.model.fits, rso=rso, propagate_arcs=blocks.propagate)
        model = replace(one.model, fits=propagator, predictions=propagator, flattened=propagator)
        under_way.append(begin(store, name, replace(one, model=model), until))

    def together(calls):
        return dict(zip(calls, blocks.run(list(calls.values())), strict=True))

    days.catch_up(store, under_way, until, together=together, metadata=METADATA)
    return {name: everything(store, name, until) for name in objects}


def everything(store, name, until):
    """All that the mornings of an object left, in tables and texts."""
    found = {}
    for day, place in ((day, store.places(day)[name]) for day in store.done(until)[name]):
        found |= {(day, table): place.rows(table, name).to_csv(index=False) for table in Records.TABLES}
        found |= {(day, "paths"): [one.table.to_csv() for one in place.paths(name)]}
        found |= {(day, "outcome"): place.outcomes[name]}
        message = store.message(day, name)
        found |= {(day, "message"): message.read_bytes() if message.exists() else b""}
    return found


def test_an_object_leaves_the_same_whoever_shares_its_job(by_points, tmp_path):
    until = FIRST + timedelta(days=2)
    together = beside(by_points, tmp_path / "together", until)
    assert all(len(one[until, "judged"].splitlines()) > 1 for one in together.values())
    for name, one in by_points.items():
        assert beside({name: one}, tmp_path / name, until)[name] == together[name]


def test_records_of_other_settings_are_refused(watched, whole):
    told = refusal(Store(whole, "0", ["iss"]).check_made, LAST, "iss", "another", {})
    assert "made with these settings" in told


def test_a_morning_that_is_gone_from_between_others_is_told(watched, whole, tmp_path):
    folder = tmp_path / "days"
    shutil.copytree(whole, folder)
    gone, *behind = (folder / (LAST - timedelta(days=day)).isoformat() for day in (2, 1, 0))
    shutil.rmtree(gone)
    with pytest.raises(
        InputError, match=f"^{gone}: expected the morning of iss that later ones build on, got"
    ):
        run(watched, folder, LAST + timedelta(days=1))
    for day in behind:
        shutil.rmtree(day)
    assert contents(run(watched, folder)) == contents(whole)


def test_a_station_that_moved_is_told(watched, whole):
    first, *others = watched.stations
    moved = replace(watched, stations=[replace(first, latitude=first.latitude + 1e-4), *others])
    with pytest.raises(InputError, match=f": expected the station {first.name} as it measured iss then, got"):
        run(moved, whole, LAST + timedelta(days=1))
    assert not (whole / (LAST + timedelta(days=1)).isoformat()).exists()


def track(number, begin, length=300.0):
    t = np.arange(begin, begin + length, 60.0)
    return pd.DataFrame({"track": number, "t": t})


@pytest.mark.parametrize("number", [1, 2])
def test_late_tracks_are_in_the_fits_of_later_ones_and_told(watched, whole, tmp_path, number):
    """The mornings before they came stay as they are."""
    before = LAST - timedelta(days=1)
    begins = watched.tracking.groupby("track")["t"].min()
    late = begins.index[begins < CALENDAR.time(before)][-1 - number : -1]
    without = watched.tracking[~watched.tracking["track"].isin(late)]
    lacking = without.assign(track=np.searchsorted(without["track"].unique(), without["track"]))
    never, came = tmp_path / "never", tmp_path / "came"
    carried_on(whole, replace(watched, tracking=lacking), never, after=before - timedelta(days=1))
    carried_on(never, watched, came, after=before)
    assert contents(came, before) == contents(never, before)
    found, absent = told(came), told(never)
    assert (found["late"], absent["late"]) == (number, 0)
    assert found["tracks"] == absent["tracks"]
    made, lesser = (
        rows(folder, "kept_estimates", [LAST]).query("window_hours == 12.0") for folder in (came, never)
    )
    assert not np.isin(begins[late], made["t"]).any()
    np.testing.assert_array_equal(made["t"], lesser["t"])
    ages = made["t"].to_numpy()[:, None] - begins[late].to_numpy()
    reached = (ages <= ESTIMATION.window_hours * HOUR).sum(axis=1)
    assert reached.any()
    np.testing.assert_array_equal(made["tracks_used"].to_numpy(), lesser["tracks_used"] + reached)


def test_a_track_keeps_its_number_and_one_that_comes_late_gets_none():
    measured = pd.concat([track(0, 0.0), track(1, 4 * HOUR), track(2, 8 * HOUR), track(3, 30 * HOUR)])
    kept = pd.DataFrame({"track": [7, 8], "t": [0.0, 8 * HOUR]})
    recent = fits.recent_tracks(measured, kept, now=31 * HOUR, reach=2 * DAY)
    assert recent.late == 1
    np.testing.assert_array_equal(recent.numbers, [7, fits.NO_NUMBER, 8, 9])
    np.testing.assert_array_equal(recent.tracking["track"].unique(), [0, 1, 2, 3])
    recent = fits.recent_tracks(measured, kept, now=30 * HOUR + 100.0, reach=DAY)
    np.testing.assert_array_equal(recent.numbers, [8])  # one is too old, one is not over


def test_messages_tell_the_object_by_what_its_files_tell(watched, whole):
    (segment,) = known_orbits.segments(whole / LAST.isoformat() / "iss" / "iss.oem", epoch=EPOCH)
    assert (segment.name, segment.identity.designator) == ("iss", "1998-067A")


def test_an_estimate_long_after_the_one_before_is_not_flown_to():
    """Arcs of predictions end after `max_days`, and no ephemeris starts from what they do not reach."""
    t = DAY * np.array([0.0, 1.0, 9.0])
    columns = {"t_b": [np.nan, *t[:2]], "b": [-1, 4, 5], "converged": True, "cd_inside": True}
    at_estimates = pd.DataFrame(columns, index=pd.Index([4, 5, 6], name="track"))
    estimates = pd.DataFrame({"track": [4, 5, 6], "t": t})
    short, long = (
        candidates._from_previous(estimates, at_estimates, longest=days * DAY) for days in (7.0, 8.0)
    )
    assert short[["i", "j"]].to_numpy().tolist() == [[4, 5]]
    assert long["j"].tolist() == [5, 6]


def test_a_day_of_which_nothing_is_known_stays_open():
    known = CALENDAR.time(date(2016, 10, 1))
    days.check_reached(CALENDAR, date(2016, 10, 2), known)
    with pytest.raises(InputError, match=r"^expected tracks or weather until 2016-10-03 or the day before"):
        days.check_reached(CALENDAR, date(2016, 10, 3), known)
