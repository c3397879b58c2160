"""The seasons of docs/learning.md: who is learned from, what was known when, and shares by hand."""

import numpy as np
import pandas as pd
import pytest
from catalogue_files import FIRST_DAY, write_sets, write_weather

from opml.element_sets import catalogue, corrector, density
from opml.environment import known_weather
from opml.interop.element_sets import mean_elements
from opml.interop.element_sets.element_set import elements_epoch
from opml.tables import SCHEMAS, STATE
from validation import catalogue_seasons
from validation.catalogue_seasons import ALL, Season, residuals, scores

DATES = ("2016-01-15", "2016-01-25", "2016-02-01", "2016-02-05")
SEASON = Season.of("payloads", *DATES)


@pytest.fixture(scope="module")
def sets(tmp_path_factory):
    path = write_sets(tmp_path_factory.mktemp("sets") / "sets.tle", objects=6, days=70)
    return catalogue.read([path]).daily()


@pytest.mark.slow
def test_rows_are_of_the_mornings_of_both_spans(sets, tmp_path):
    weather = write_weather(tmp_path / "weather.csv", first=FIRST_DAY - 600, last=FIRST_DAY + 70)
    known = density.clean(known_weather.read(weather))
    season = Season.of("payloads", *DATES[:2], "2016-02-20", "2016-02-24")
    measured = catalogue_seasons.densities(known)
    rows = catalogue_seasons.rows(sets, season, known, measured, SCHEMAS["set_states"].empty())
    assert set(np.floor(rows["morning"])) == {*range(57398, 57443)}  # forty before those that judge
    assert sorted(rows["number"].unique()) == [1, 2, 3, 4, 5, 6]
    assert rows.pop("later").isna().all()
    assert np.isfinite(rows.to_numpy(float)).all()


class _Recorder:
    """Learns nothing, but keeps the rows; corrects what it is asked for by a metre, but for one object."""

    def __call__(self, rows, *, seed):
        self.rows = rows
        return self

    def apply(self, rows):
        known = np.where(rows["number"] == rows["number"].max(), np.nan, 1.0)
        return pd.DataFrame({"correction": known, "sigma": 2.0 * known}, index=rows.index)


def predicted(numbers, mornings):
    """Rows of objects on mornings: SGP4 errs by 5 m, the density takes 2 m off."""
    rows = pd.DataFrame([(number, morning) for number in numbers for morning in mornings])
    rows = rows.set_axis(["number", "morning"], axis=1).merge(pd.DataFrame({"lead": [5, 7]}), how="cross")
    rows["judged"], rows["tau"] = rows["morning"] + rows["lead"] + 0.5, rows["lead"] + 0.5
    columns = {
        "band": 3,
        "error": 5.0,
        "density": 2.0,
        "scale": 10.0,
        "missed": 1.0,
        "bstar": 1e-4,
        "later": np.nan,
    }
    return rows.assign(**columns, response=1e6 * rows["tau"] ** 2)


@pytest.fixture
def recorder(monkeypatch):
    found = _Recorder()
    monkeypatch.setattr(corrector, "fit", found)
    monkeypatch.setattr(corrector, "apply", lambda learned, rows: learned.apply(rows))
    return found


def test_half_teaches_in_time_and_the_other_half_judges(recorder):
    numbers = np.arange(1, 41)
    rows = predicted(numbers, np.arange(57399.25, 57424.0))
    found = residuals(rows, rows, SEASON, "trees")
    taught, judged = set(recorder.rows["number"]), set(found["number"])
    assert taught | judged == set(numbers)
    assert not taught & judged
    of_week = recorder.rows[recorder.rows["lead"] == 7]
    assert of_week["morning"].max() == 57411.25  # of the 25th on, the judge came after 1 February
    assert (found["morning"].min(), found["morning"].max()) == (57419.25, 57423.25)
    last = found["number"] == max(judged)
    assert set(found["scaled"]) == {3.0}
    assert set(found.loc[~last, "learned"]) == {4.0}
    assert set(found.loc[last, "learned"]) == {3.0}
    assert found.loc[last, "sigma"].isna().all()


def test_the_orbit_inside_a_later_set_judges_where_it_is_known_and_chooses_nothing(recorder):
    """It is 100 m behind the set: all errors grow by that, and no weight changes."""
    rows = predicted(np.arange(1, 41), np.arange(57399.25, 57424.0))
    by_sets = residuals(rows, rows, SEASON, "trees")
    known = rows["lead"] == 7
    by_orbits = rows.assign(later=rows["later"].mask(known, 100.0))
    judged = residuals(by_orbits, by_orbits, SEASON, "trees")
    for name in ("error", "scaled", "learned", "improved"):
        shift = (judged[name] - by_sets[name]).to_numpy()
        assert shift == pytest.approx(np.where(judged["lead"] == 7, 100.0, 0.0))
    assert set(judged.loc[judged["lead"] == 7, "judge"]) == {"orbit"}
    assert set(judged.loc[judged["lead"] == 5, "judge"]) == {"set"}
    assert judged["applied"].equals(by_sets["applied"])


def test_sets_are_ahead_of_the_orbits_inside_them_by_what_a_table_says(sets):
    known = sets.take(np.arange(3))
    epochs = [elements_epoch(one) for one in known.satellites]
    states = np.array(
        [
            mean_elements.states(one, epoch=at, t=np.zeros(1))[0]
            for at, one in zip(epochs, known.satellites, strict=True)
        ]
    )
    states[:, :3] -= 50.0 * states[:, 3:] / np.linalg.norm(states[:, 3:], axis=1, keepdims=True)
    table = known.table[["number"]].assign(utc=epochs, **dict(zip(STATE, states.T, strict=True)))
    ahead = catalogue_seasons.ahead_of_orbits(known, table[1:])
    assert np.isnan(ahead[0])
    assert ahead[1:] == pytest.approx(50.0, abs=0.1)


def test_a_set_is_improved_by_each_way_as_likely_as_its_own_past_makes_it(recorder):
    rows = predicted(np.arange(1, 41), np.arange(57379.25, 57424.0))
    found = residuals(rows, rows, SEASON, "trees")
    assert set(found["applied"]) == {"density"}  # 3 m are left by it, 4 m by what was learned
    known, objects = found["number"] != found["number"].max(), found["number"].nunique()
    own, borrowed, gross = 68, 30, 4.0  # predictions; one object has none that learned, which is a gross miss
    learned = (own * 0.4 + borrowed * (gross + 0.4 * (objects - 1)) / objects) / (own + borrowed)
    losses = np.array([0.5, 0.3, learned])
    likely = np.exp(-(own + borrowed) / 4 * (losses - 0.3) / 0.3)
    weights = likely / likely.sum()
    # Two numbers meet two corrections, of a row of five days and one of seven.
    assert found.loc[known, "improved"].to_numpy() == pytest.approx(weights @ [5.0, 3.0, 4.0])
    sigma = 4.0 / corrector.NORMAL  # sigmas were 2 m, and too small
    sigmas = np.hypot(sigma, [1.0, 1.0, 0.0])  # ways a metre apart from the learned one
    assert found.loc[known, "improved_sigma"].to_numpy() == pytest.approx(weights @ sigmas)
    without = likely[:2] / likely[:2].sum() @ [5.0, 3.0]
    assert found.loc[~known, "improved"].to_numpy() == pytest.approx(without, abs=0.01)


def test_a_set_that_shows_a_burn_stays(recorder):
    rows = predicted(np.arange(1, 41), np.arange(57399.25, 57424.0))
    rows.loc[rows["morning"].eq(57421.25) & rows["lead"].eq(5), "missed"] = 30.0
    found = residuals(rows, rows, SEASON, "trees")
    stays = found["morning"] == 57421.25
    assert set(found.loc[stays, "applied"]) == {"unchanged"}
    assert set(found.loc[~stays, "applied"]) == {"density"}
    assert found.loc[stays, "improved"].to_numpy() == pytest.approx(5.0)


def test_no_error_judged_later_chooses(recorder):
    rows = predicted(np.arange(1, 41), np.arange(57399.25, 57424.0))
    is_known = rows["judged"] <= 57419.25

    def first_morning(errors):
        table = rows.assign(error=errors)
        found = residuals(table, table, SEASON, "trees")
        return found[found["morning"] == 57419.25]["applied"].tolist()

    unlike = -90.0  # makes the published set the best
    assert set(first_morning(rows["error"].where(is_known, unlike))) == {"density"}
    assert set(first_morning(rows["error"].mask(is_known, unlike / 9.0))) == {"unchanged"}


def test_others_teach_in_a_later_season(recorder):
    """All objects judge but those that taught; what judges after the season that judges may teach."""
    season = Season.of("payloads", *DATES[2:], *DATES[:2])
    own, others = (predicted(numbers, season.mornings) for numbers in (np.arange(1, 9), np.arange(5, 45)))
    found = residuals(own, others, season, "trees")
    taught = set(recorder.rows["number"])
    assert set(found["number"]) == set(range(1, 9)) - taught
    assert {1, 2, 3, 4} < set(found["number"])
    assert taught <= set(range(5, 45))
    assert recorder.rows["morning"].min() == 57419.25


def test_the_half_of_an_object_does_not_depend_on_the_others():
    numbers = np.array([5, 25544, 5, 900])
    half = catalogue_seasons.half_of(numbers, seed=42)
    assert half[0] == half[2]
    assert [int(catalogue_seasons.half_of(np.array([one]), seed=42)[0]) for one in numbers] == half.tolist()
    many = catalogue_seasons.half_of(np.arange(1000), seed=42)
    assert 450 < many.sum() < 550


def left(error, scaled, learned, **columns):
    """Residuals of one band and lead: each prediction of an object and a week of its own."""
    count = len(error)
    own = {"number": np.arange(count), "morning": 7.0 * np.arange(count), "lead": 1, "band": 2}
    errors = {"error": error, "scaled": scaled, "learned": learned, "improved": learned}
    others = {"sigma": np.nan, "improved_sigma": np.nan, "applied": "learned", "judge": "set"}
    return pd.DataFrame(own | errors | others | columns)


def test_numbers_of_a_band_are_shares_of_sgp4():
    applied, judge = ["unchanged", "learned", "density"], ["orbit", "set", "set"]
    table = left([-10.0, 20.0, 40.0], [5.0, -10.0, 30.0], [4.0, 5.0, -16.0], applied=applied, judge=judge)
    every, band = scores(table).to_dict("records")
    assert (every["band"], band["band"]) == (ALL, 2)
    assert every["learned_p95"] == band["learned_p95"] == pytest.approx(100.0 * 14.9 / 38.0)
    assert (band["predictions"], band["objects"], band["weeks"]) == (3, 3, 3)
    assert (band["by_orbits"], band["unchanged"]) == pytest.approx((100.0 / 3.0, 100.0 / 3.0))
    assert (band["sgp4_median"], band["sgp4_p95"]) == pytest.approx((20.0, 38.0))
    assert (band["scaled_median"], band["learned_median"]) == (50.0, 25.0)
    assert (band["scaled_p_ml"], band["learned_p_ml"]) == pytest.approx((4500.0 / 70.0, 2500.0 / 70.0))


def test_the_worst_week_has_the_least_inside():
    off, sigma = [1.0, 1.0, 9.0, 1.0, 9.0, 9.0], np.ones(6)
    table = left(off, off, off, improved_sigma=sigma, morning=[0.0, 1.0, 2.0, 7.0, 8.0, 9.0])
    _, band = scores(table).to_dict("records")
    assert (band["improved_coverage"], band["worst_week"]) == pytest.approx((50.0, 100.0 / 3.0))
    assert np.isnan(band["coverage"])


def test_predictions_of_an_object_do_not_narrow_an_interval():
    rng = np.random.default_rng(3)
    error = rng.normal(size=40) * 100.0
    table = left(error, error * rng.uniform(0.2, 1.0, 40), error * rng.uniform(0.1, 0.9, 40))
    many = pd.concat([table] * 5)
    one, five = (catalogue_seasons.intervals(part, np.random.default_rng(5)) for part in (table, many))
    assert five == pytest.approx(one, rel=0.2)
    median = scores(many, seed=5)["learned_median"].iloc[0]
    assert five["learned_low"] < median < five["learned_high"]
    pd.testing.assert_frame_equal(scores(table), scores(table.iloc[::-1]))
    assert not scores(table).equals(scores(table, seed=10))
