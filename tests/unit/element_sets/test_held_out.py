"""A trial of a corrector: who is learned from, what was known when, and that nothing later counts."""

import catalogue_files
import numpy as np
import pandas as pd
import pytest

from opml.base.errors import InputError
from opml.element_sets import corrector, held_out
from opml.element_sets.held_out import Seasons

DATES = (["2016-01-15", "2016-01-25"], ["2016-02-01", "2016-02-05"])


@pytest.fixture(scope="module")
def weather(tmp_path_factory):
    path = tmp_path_factory.mktemp("weather") / "weather.csv"
    begin = catalogue_files.FIRST_DAY
    return catalogue_files.write_weather(path, first=begin - 600, last=begin + 50)


@pytest.fixture(scope="module")
def sets(tmp_path_factory):
    return catalogue_files.write_sets(tmp_path_factory.mktemp("sets") / "sets.tle", objects=6, days=50)


@pytest.fixture(scope="module")
def densities(weather):
    return held_out.densities(weather)


def made(sets, densities, weather):
    return held_out.rows([sets], densities, Seasons.of_dates(*DATES), weather=weather, latency=0.25)


@pytest.mark.slow
def test_rows_are_of_the_mornings_of_both_seasons(sets, densities, weather):
    rows = made(sets, densities, weather)
    assert list(rows) == held_out.ROWS.names
    mornings = rows["morning"].unique()
    assert set(np.floor(mornings)) == {*range(57402, 57413), *range(57419, 57424)}
    assert sorted(rows["number"].unique()) == [1, 2, 3, 4, 5, 6]
    assert np.isfinite(rows.to_numpy()).all()


@pytest.mark.slow
def test_weather_that_ends_too_early_is_told(sets, densities, tmp_path):
    early = catalogue_files.write_weather(tmp_path / "early.csv", first=56788, last=57410)
    expected = f"{early}: expected measured weather up to 2016-02-05, got it up to 2016-01-24"
    with pytest.raises(InputError, match=expected):
        made(sets, densities, early)


@pytest.mark.slow
def test_sets_of_other_years_are_told(densities, weather, tmp_path):
    early = catalogue_files.write_sets(tmp_path / "early.tle", objects=2, days=3)
    with pytest.raises(InputError, match="element sets: expected sets of the seasons"):
        made(early, densities, weather)


class _Recorder:
    """Learns nothing, but keeps the rows; corrects what it is asked for by a metre, but for one object."""

    def __call__(self, rows, learner, *, seed):
        self.rows = rows
        return self

    def apply(self, rows):
        known = np.where(rows["number"] == rows["number"].max(), np.nan, 1.0)
        return pd.DataFrame({"correction": known, "sigma": 2.0 * known}, index=rows.index)


def test_half_teaches_in_time_and_the_other_half_judges(monkeypatch):
    numbers, mornings = np.arange(1, 41), np.arange(57402.25, 57424.0)
    rows = pd.DataFrame(
        [(number, morning) for number in numbers for morning in mornings], columns=["number", "morning"]
    ).assign(lead=7, band=3, error=5.0, density=2.0)
    rows["judged"] = rows["morning"] + 7.5
    recorder = _Recorder()
    monkeypatch.setattr(corrector, "fit", recorder)
    found = held_out.residuals(rows, Seasons.of_dates(*DATES), "trees", seed=42)
    taught, judged = set(recorder.rows["number"]), set(found["number"])
    assert taught | judged == set(numbers)
    assert not taught & judged
    assert recorder.rows["morning"].max() == 57411.25  # of the 25th on, the judge came after 1 February
    assert (found["morning"].min(), found["morning"].max()) == (57419.25, 57423.25)
    last = found["number"] == max(judged)
    assert set(found["scaled"]) == {3.0}
    assert set(found.loc[~last, "learned"]) == {4.0}
    assert set(found.loc[last, "learned"]) == {3.0}
    assert found.loc[last, "sigma"].isna().all()


def test_the_half_of_an_object_does_not_depend_on_the_others():
    numbers = np.array([5, 25544, 5, 900])
    half = held_out.half_of(numbers, seed=42)
    assert half[0] == half[2]
    assert [int(held_out.half_of(np.array([one]), seed=42)[0]) for one in numbers] == half.tolist()
    many = held_out.half_of(np.arange(1000), seed=42)
    assert 450 < many.sum() < 550
