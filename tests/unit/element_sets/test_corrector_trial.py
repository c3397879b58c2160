"""A trial of a corrector: who is learned from, what was known when, and that nothing later counts."""

import catalogue_files
import numpy as np
import pandas as pd
import pytest
from support import refusal

from opml.base.errors import InputError
from opml.element_sets import catalogue, corrector, corrector_trial, density, training
from opml.element_sets.corrector_trial import Seasons
from opml.interop.element_sets import mean_elements
from opml.interop.element_sets.element_set import elements_epoch
from opml.tables import SCHEMAS, STATE

DATES = (["2016-01-15", "2016-01-25"], ["2016-02-01", "2016-02-05"])
LATER = (DATES[0], ["2016-02-20", "2016-02-24"])


@pytest.fixture(scope="module")
def weather(tmp_path_factory):
    path = tmp_path_factory.mktemp("weather") / "weather.csv"
    begin = catalogue_files.FIRST_DAY
    return catalogue_files.write_weather(path, first=begin - 600, last=begin + 70)


@pytest.fixture(scope="module")
def sets(tmp_path_factory):
    return catalogue_files.write_sets(tmp_path_factory.mktemp("sets") / "sets.tle", objects=6, days=70)


@pytest.fixture(scope="module")
def densities(weather):
    return corrector_trial.densities(weather)


def made(sets, densities, weather):
    seasons, orbits = Seasons.of_dates(*LATER), SCHEMAS["set_states"].empty()
    return corrector_trial.rows([sets], densities, seasons, orbits=orbits, weather=weather, latency=0.25)


@pytest.mark.slow
def test_rows_are_of_the_mornings_of_both_seasons(sets, densities, weather):
    rows = made(sets, densities, weather)
    assert list(rows) == corrector_trial.ROWS.names
    mornings = rows["morning"].unique()
    assert set(np.floor(mornings)) == {*range(57398, 57443)}  # forty before the season that judges
    assert sorted(rows["number"].unique()) == [1, 2, 3, 4, 5, 6]
    assert rows.pop("later").isna().all()
    assert np.isfinite(rows.to_numpy()).all()


@pytest.mark.slow
def test_weather_that_ends_too_early_is_told(sets, densities, tmp_path):
    early = catalogue_files.write_weather(tmp_path / "early.csv", first=56788, last=57410)
    expected = f"{early}: expected measured weather up to 2016-02-24, got it up to 2016-01-24"
    with pytest.raises(InputError, match=expected):
        made(sets, densities, early)


@pytest.mark.slow
def test_sets_of_other_years_are_told(densities, weather, tmp_path):
    early = catalogue_files.write_sets(tmp_path / "early.tle", objects=2, days=3)
    assert "element sets: expected sets of the seasons" in refusal(made, early, densities, weather)


class _Recorder:
    """Learns nothing, but keeps the rows; corrects what it is asked for by a metre, but for one object."""

    def __call__(self, rows, learner, *, seed):
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
    return found


def test_half_teaches_in_time_and_the_other_half_judges(recorder):
    numbers = np.arange(1, 41)
    rows = predicted(numbers, np.arange(57399.25, 57424.0))
    found = corrector_trial.residuals(rows, rows, Seasons.of_dates(*DATES), "trees", seed=42)
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
    seasons = Seasons.of_dates(*DATES)
    by_sets = corrector_trial.residuals(rows, rows, seasons, "trees", seed=42)
    known = rows["lead"] == 7
    by_orbits = rows.assign(later=rows["later"].mask(known, 100.0))
    judged = corrector_trial.residuals(by_orbits, by_orbits, seasons, "trees", seed=42)
    for name in ("error", "scaled", "learned", "improved"):
        shift = (judged[name] - by_sets[name]).to_numpy()
        assert shift == pytest.approx(np.where(judged["lead"] == 7, 100.0, 0.0))
    assert set(judged.loc[judged["lead"] == 7, "judge"]) == {"orbit"}
    assert set(judged.loc[judged["lead"] == 5, "judge"]) == {"set"}
    assert judged["applied"].equals(by_sets["applied"])


def test_sets_are_ahead_of_the_orbits_inside_them_by_what_a_table_says(sets):
    known = catalogue.read([sets]).take(np.arange(3))
    epochs = [elements_epoch(one) for one in known.satellites]
    states = np.array(
        [
            mean_elements.states(one, epoch=at, t=np.zeros(1))[0]
            for at, one in zip(epochs, known.satellites, strict=True)
        ]
    )
    states[:, :3] -= 50.0 * states[:, 3:] / np.linalg.norm(states[:, 3:], axis=1, keepdims=True)
    table = known.table[["number"]].assign(utc=epochs, **dict(zip(STATE, states.T, strict=True)))
    ahead = corrector_trial.ahead_of_orbits(known, table[1:])
    assert np.isnan(ahead[0])
    assert ahead[1:] == pytest.approx(50.0, abs=0.1)


def test_a_set_is_improved_by_each_way_as_likely_as_its_own_past_makes_it(recorder):
    rows = predicted(np.arange(1, 41), np.arange(57379.25, 57424.0))
    found = corrector_trial.residuals(rows, rows, Seasons.of_dates(*DATES), "trees", seed=42)
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
    found = corrector_trial.residuals(rows, rows, Seasons.of_dates(*DATES), "trees", seed=42)
    stays = found["morning"] == 57421.25
    assert set(found.loc[stays, "applied"]) == {"unchanged"}
    assert set(found.loc[~stays, "applied"]) == {"density"}
    assert found.loc[stays, "improved"].to_numpy() == pytest.approx(5.0)


def test_no_error_judged_later_chooses(recorder):
    rows = predicted(np.arange(1, 41), np.arange(57399.25, 57424.0))
    is_known = rows["judged"] <= 57419.25

    def first_morning(errors):
        table = rows.assign(error=errors)
        found = corrector_trial.residuals(table, table, Seasons.of_dates(*DATES), "trees", seed=42)
        return found[found["morning"] == 57419.25]["applied"].tolist()

    unlike = -90.0  # makes the published set the best
    assert set(first_morning(rows["error"].where(is_known, unlike))) == {"density"}
    assert set(first_morning(rows["error"].mask(is_known, unlike / 9.0))) == {"unchanged"}


def test_others_teach_in_a_later_season(recorder):
    """All objects judge but those that taught; what judges after the season that judges may teach."""
    seasons = Seasons.of_dates(*DATES[::-1])
    own, others = (predicted(numbers, seasons.mornings) for numbers in (np.arange(1, 9), np.arange(5, 45)))
    found = corrector_trial.residuals(own, others, seasons, "trees", seed=42)
    taught = set(recorder.rows["number"])
    assert set(found["number"]) == set(range(1, 9)) - taught
    assert {1, 2, 3, 4} < set(found["number"])
    assert taught <= set(range(5, 45))
    assert recorder.rows["morning"].min() == 57419.25


def test_the_half_of_an_object_does_not_depend_on_the_others():
    numbers = np.array([5, 25544, 5, 900])
    half = corrector_trial.half_of(numbers, seed=42)
    assert half[0] == half[2]
    assert [int(corrector_trial.half_of(np.array([one]), seed=42)[0]) for one in numbers] == half.tolist()
    many = corrector_trial.half_of(np.arange(1000), seed=42)
    assert 450 < many.sum() < 550


def test_a_path_that_is_missing_is_told_before_minutes_of_densities(tmp_path):
    told = []
    missing = tmp_path / "nothing.tle"
    said = refusal(training.train, {"all": [missing]}, weather="OBSERVED", progress=told.append)
    assert said == f"{missing}: no such file"
    assert told == []


def test_nothing_that_became_known_after_a_date_is_learned_from(sets, weather, monkeypatch):
    seen = {}

    def air(known, *, first, end):
        seen["weather"] = [end, density.end_of(known)]

    def stop(sets, air):
        seen["sets"] = sets.table["known"].max()
        raise InputError("enough was seen")

    monkeypatch.setattr(density, "learned_air", air)
    monkeypatch.setattr(training, "mornings_of", stop)
    refusal(training.train, {"all": [sets]}, weather=weather, date="2016-02-01T00:00:00")
    assert 57418.0 < seen["sets"] <= 57419.0
    assert seen["weather"] == pytest.approx([57419.0, 57419.0], abs=0.5)
    refusal(training.train, {"all": [sets]}, weather=weather)
    assert seen["sets"] > 57430.0
