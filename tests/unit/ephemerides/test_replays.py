"""Mornings run again: what they know, what they are compared with, and where they start."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from support import EPOCH, ESTIMATION, refusal

from opml.base.constants import DAY, HOUR
from opml.base.errors import InputError
from opml.catalog.fit import estimation, observations, start_states
from opml.catalog.predict import prediction, weather_spread
from opml.catalog.predict.weather_spread import Weathers
from opml.catalog.propagator import Propagator
from opml.catalog.simulate import tracking, truth
from opml.ephemerides import corrected, replays
from opml.ephemerides.along_track_shift import through
from opml.ephemerides.ephemeris_task import Task
from opml.ephemerides.known_tables import KnownTables
from opml.ephemerides.task_part import Grid
from opml.interop import known_orbits, oem
from opml.learning.data import dataset
from opml.learning.data.cleaning import Cleaning
from opml.learning.data.splits import are_over
from opml.learning.models import learners
from opml.learning.models.daily_training import DailyLearner, first_day
from opml.orbits.elements import in_rsw
from opml.orbits.manoeuvres import Manoeuvre
from opml.tables import COMPONENTS, SCHEMAS, STATE, read_table, write_table

LAW = learners.of_job({"kind": "linear_law", "terms": ["duration*duration"], "variables": ["duration"]})
NONE = learners.of_job({"kind": "none", "variables": []})
ARC = {"window_hours": 12.0, "memory_days": 30.0}
RUNS = {"kind": "running", "variables": ["l_arc_y", "v_arc_y", "cd_arc", "cd_past"], **ARC}
RUNNING = learners.of_job(RUNS)
TRAIN = (0.0, 2.0)


@pytest.fixture(scope="module")
def tables(truth_model, assumed_model, iss, earth_orientation, three_stations):
    """Three days of the paper's RSO: estimates, predictions, tracks and labelled rows."""
    orbit = truth.simulate(Propagator(truth_model, iss), duration=3 * DAY, step=20.0)
    tracks = tracking.simulate(orbit, earth_orientation, three_stations, rso="iss", seed=1)
    propagator = Propagator(assumed_model, iss)
    estimates = estimation.estimate_all(
        propagator,
        start_states.perturbed(orbit, tracks, rso="iss", settings=ESTIMATION, seed=1),
        observations.Measured(tracks, earth_orientation, three_stations),
        settings=ESTIMATION,
    )
    predictions = prediction.predict_all(propagator, orbit, estimates, max_days=1.0)
    options = {"gm": assumed_model.gm, "cleaning": Cleaning()}
    rows = dataset.build(estimates, predictions, tracks, **options)
    at = dataset.of_estimates(estimates, predictions, tracks, **options)
    known = KnownTables(estimates, at, 12.0, assumed_model.gm)
    return {"known": known, "predictions": predictions, "rows": rows}


def series_of(propagator, tables, learner=LAW, rows=None):
    """What is to be replayed of a learner."""
    known, predictions = tables["known"], tables["predictions"]
    daily = DailyLearner(tables["rows"] if rows is None else rows, learner, seed=1)
    first = first_day(learner, window_hours=known.window_hours, train_days=TRAIN)
    starts = replays.morning_departures(known, every_hours=3.0, first_day=first)
    pairs = predictions[predictions["i"].isin(starts["track"])]
    spreads = weather_spread.build(
        propagator, known.estimates, pairs, weathers=Weathers.of(propagator.model, None)
    )
    judge = replays.at_starts(replays.judge(tables["rows"], predictions, None), starts, spreads)
    return replays.ReplaySeries(daily, starts, judge)


def replayed(propagator, tables, learner=LAW, rows=None):
    """The table of a learner that is replayed alone."""
    series = series_of(propagator, tables, learner, rows)
    (table,) = replays.build(propagator, tables["known"], [series], max_days=1.0)
    return table


@pytest.fixture(scope="module")
def table(propagator, tables):
    return replayed(propagator, tables)


def test_the_table_is_the_schemas_and_comes_back(table, tmp_path):
    write_table(tmp_path / "r.parquet", table, "replay", metadata={})
    pd.testing.assert_frame_equal(
        read_table(tmp_path / "r.parquet", "replay"), table[SCHEMAS["replay"].names], check_exact=True
    )


def test_rows_that_a_burn_spoils_tell_when_it_was_found(propagator, tables, tmp_path):
    """From a day and a half on nobody is to learn from what the burn at 1.2 days did."""
    series, burn = series_of(propagator, tables, NONE), Manoeuvre(1.2 * DAY, 1.5 * DAY, restarts=True)
    series = replace(series, starts=series.starts[:6])
    unaware, aware = (
        replays.build(propagator, replace(tables["known"], manoeuvres=burns), [series], max_days=0.6)[0]
        for burns in ([], [burn])
    )
    assert "burn_known" not in unaware
    pd.testing.assert_frame_equal(aware.drop(columns="burn_known"), unaware)
    write_table(tmp_path / "r.parquet", aware, "replay", metadata={})
    across = (aware["t_i"] < burn.t) & aware["t_j"].between(burn.t, burn.known, inclusive="left")
    across |= aware["t_i"].between(burn.t, burn.known, inclusive="left")
    assert 0 < across.sum() < len(aware)
    np.testing.assert_array_equal(aware["burn_known"], np.where(across, burn.known, np.inf))
    now = 3.0 * DAY
    assert are_over(unaware, now).all()
    np.testing.assert_array_equal(are_over(aware, now), ~across)
    np.testing.assert_array_equal(are_over(aware, 1.4 * DAY), are_over(unaware, 1.4 * DAY))


def test_a_law_learns_nothing_of_a_burn_once_it_is_known(tables):
    """Rows of the dataset that begin before the burn at 1.2 days and end before it is found."""
    burn = Manoeuvre(1.2 * DAY, 1.6 * DAY, restarts=True)
    known = replace(tables["known"], manoeuvres=[burn])
    rows = known.marked(tables["rows"])
    crossed = np.isfinite(rows["burn_known"].to_numpy())
    assert 0 < crossed.sum() < len(rows)
    wild = rows.assign(e_y=np.where(crossed, 1.5, 1.0) * rows["e_y"])
    probe = tables["rows"][["duration"]].head().to_numpy()
    for day, alike in ((1.59, False), (1.61, True)):
        calm, spoiled = (DailyLearner(table, LAW, seed=1)(day * DAY).predict(probe) for table in (rows, wild))
        assert np.array_equal(calm, spoiled) is alike


def test_without_a_correction_errors_are_those_of_the_predictions(propagator, tables):
    """The path through states two minutes apart is the arc itself."""
    table = replayed(propagator, tables, NONE)
    assert table["t_i"].min() >= 12.0 * HOUR  # a window of tracks is full
    at = tables["predictions"].set_index(["i", "j"]).loc[pd.MultiIndex.from_frame(table[["i", "j"]])]
    np.testing.assert_allclose(table[list(COMPONENTS[:3])], at[list(COMPONENTS[:3])], atol=0.5)
    np.testing.assert_allclose(table["before"], table["e_y"], atol=1e-6)


def test_a_law_waits_until_half_of_the_training_is_over(table):
    assert table["t_i"].min() >= 1.0 * DAY
    assert set(table["morning"]) == {1.0 * DAY, 2.0 * DAY}
    assert (table["morning"] <= table["t_i"]).all()


def test_learners_share_their_arcs_and_keep_their_tables(propagator, tables, table, monkeypatch):
    """Each has the table that it has alone; what several ask for is flown once a part."""
    settings = [NONE, LAW, RUNNING, learners.of_job(RUNS | {"memory_days": 3.0})]
    known = replace(tables["known"], others={12.0: tables["known"].estimates})
    beside = dict.fromkeys(RUNNING.variables, 0.0)
    tables = tables | {"known": known, "rows": tables["rows"].assign(**beside)}
    alone = [replayed(propagator, tables, learner) for learner in settings]
    flown = []

    def counted(propagator, pairs, *arguments, **options):
        flown.append(pairs["i"].nunique())
        return fly_pairs(propagator, pairs, *arguments, **options)

    fly_pairs = Propagator.propagate_pairs
    series = [series_of(propagator, tables, learner) for learner in settings]
    monkeypatch.setattr(Propagator, "propagate_pairs", counted)
    together = replays.build(propagator, known, series, max_days=1.0)
    for one, other in zip(together, alone, strict=True):
        pd.testing.assert_frame_equal(one, other, check_exact=True)
    pd.testing.assert_frame_equal(together[1], table, check_exact=True)
    # The law's own mornings; all other learners' predictions, theirs by the arcs, and arcs nudged.
    later, earlier = len(series[1].starts), len(series[0].starts)
    assert later < earlier
    assert sum(flown) == later + 3 * earlier


def test_what_is_known_later_changes_no_morning(propagator, tables, table):
    """Errors that were known after the second morning are moved; only what is stated later knows of it."""
    rows = tables["rows"]
    later = rows["t_j"] > 1.0 * DAY
    moved = rows.assign(e_y=rows["e_y"].where(~later, rows["e_y"] + 1e5))
    again = replayed(propagator, tables, rows=moved)
    first = table["morning"] == 1.0 * DAY
    pd.testing.assert_frame_equal(again[first], table[first], check_exact=True)
    assert not np.allclose(again.loc[~first, "e_y"], table.loc[~first, "e_y"])


@pytest.mark.parametrize(
    ("learner", "day"),
    [
        (NONE, 0.5),
        (LAW, 1.0),
        (learners.of_job(RUNS | {"window_hours": 48.0}), 2.0),
    ],
)
def test_the_first_morning_has_a_full_window_of_all_fits(learner, day):
    assert first_day(learner, window_hours=12.0, train_days=TRAIN) == day


def test_starts_are_the_first_usable_ones_of_their_hours(tables):
    starts = replays.morning_departures(tables["known"], every_hours=6.0, first_day=1.0)
    slots = np.floor(starts["t"] / (6.0 * HOUR))
    assert slots.is_unique
    assert slots.min() >= 4
    burnt = replace(tables["known"], manoeuvres=[Manoeuvre(1.5 * DAY)])
    assert len(replays.morning_departures(burnt, every_hours=6.0, first_day=1.0)) < len(starts)


def test_it_is_held_against_later_estimates_where_errors_are_labels(tables):
    rows, estimates = tables["rows"], tables["known"].estimates
    judge = replays.judge(rows.assign(t_known=rows["t_j"] + 60.0), tables["predictions"], estimates)
    later = estimates.set_index("track")[STATE].loc[judge["j"]]
    np.testing.assert_array_equal(judge[STATE], later)
    np.testing.assert_array_equal(judge["t_known"], judge["t_j"] + 60.0)


def test_the_message_of_a_morning_has_the_errors_and_the_covariance_that_were_replayed(
    propagator, tables, table, tmp_path
):
    """What is tested is what is written: the file, read back, gives the same errors and the same matrices."""
    known, now = tables["known"], 2.0 * DAY
    daily = DailyLearner(tables["rows"], LAW, seed=1)
    starts = replays.morning_departures(known, every_hours=3.0, first_day=2.0)[:1]
    made = corrected.build(
        Task(propagator, known, starts, Grid(replays.STEP, 1.0, 3.0 * DAY)),
        daily,
        table,
        spreads=lambda pairs: weather_spread.build(
            propagator, known.estimates, pairs, weathers=Weathers.of(propagator.model, None)
        ),
        now=now,
    )
    oem.write(tmp_path / "m.oem", oem.corrected_segments(made, rso="iss"), epoch=EPOCH)
    (segment,) = known_orbits.segments(tmp_path / "m.oem", epoch=EPOCH)
    told = table[table["i"] == starts["track"].iloc[0]]
    true = tables["predictions"].set_index(["i", "j"]).loc[pd.MultiIndex.from_frame(told[["i", "j"]])]
    states = true[[f"{name}_true" for name in STATE]].to_numpy()
    at = told["t_j"].to_numpy()
    flown = through(segment.t, segment.states)(at)
    np.testing.assert_allclose(in_rsw(flown - states, states)[:, :3], told[list(COMPONENTS[:3])], atol=0.5)
    for k, name in enumerate("xyz"):
        written = np.interp(at, segment.covariance_t, np.sqrt(segment.covariances[:, k, k]))
        # The message has a covariance every ten minutes; a replay has that of the minute.
        np.testing.assert_allclose(written, told[f"sigma_{name}"], rtol=0.04)


def test_nothing_to_hold_against_is_told(tables):
    known, daily = tables["known"], DailyLearner(tables["rows"], LAW, seed=1)
    starts = replays.morning_departures(known, every_hours=3.0, first_day=1.0)
    judge = replays.judge(tables["rows"], tables["predictions"], None)[:0]
    empty = pd.DataFrame(columns=SCHEMAS["spread"].names, dtype=float)
    with pytest.raises(InputError, match="replay: expected later tracks to hold ephemerides against"):
        replays.at_starts(judge, starts, empty)
    assert "training: expected errors that were known by day 0, got none" in refusal(daily, 0.0)
