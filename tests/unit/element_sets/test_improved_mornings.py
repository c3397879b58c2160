"""Sets of mornings, improved: those of `opml improve` on the same date, whatever comes later."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import sinking_histories

from opml.base.errors import InputError
from opml.element_sets import catalogue, density, improve, trained_model, weighting
from opml.element_sets.density import Outlook
from opml.element_sets.improved_history import ImprovedHistory
from opml.element_sets.weighting import DENSITY, LEARNED
from opml.environment import known_weather
from opml.environment.weather import Weather

DATE = "2026-01-08T06:00:00"
MORNING = catalogue.modified_julian_day(DATE)
NUMBERS = range(101, 113)


@pytest.fixture(scope="module")
def history(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Sets of the days before the date, and of some after it."""
    path = tmp_path_factory.mktemp("history") / "sets.tle"
    sinking_histories.write(path, NUMBERS, 60)
    return path


def numbers(improved: ImprovedHistory, name: str) -> list[tuple[float, float]]:
    flown = [improved.newest(name, number, MORNING) for number in NUMBERS]
    return [(one.no_kozai, one.bstar) for one in flown if one]


def test_sets_are_those_that_the_command_writes(history: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    found = numbers(ImprovedHistory.read([history], "OBSERVED"), DENSITY)
    known = improve.read([history], date=DATE, weather="OBSERVED", latency=0.0)
    weights = weighting.weights
    monkeypatch.setattr(weighting, "weights", lambda rows, tried: weights(rows, {DENSITY: tried[DENSITY]}))
    table = improve.improve(known, trained_model.read()).table
    assert (table["applied"] == DENSITY).all()
    np.testing.assert_allclose(found, table[["motion", "bstar"]], rtol=1e-13)


@pytest.mark.parametrize("name", [DENSITY, LEARNED])
def test_no_later_set_and_no_later_weather_changes_one(history: Path, name: str) -> None:
    sets, weather = catalogue.read([history], latency=0.0), density.clean(known_weather.read("OBSERVED"))
    whole, cut = (
        ImprovedHistory(sets, weather, trained_model.read()),
        ImprovedHistory(sets.until(MORNING), weather.keep_known(MORNING), trained_model.read()),
    )
    found = numbers(whole, name)
    assert len(found) == len(NUMBERS)
    assert found == numbers(cut, name)
    published = [(one.no_kozai, one.bstar) for one in sets.satellites]
    assert not set(found) & set(published)


def test_the_numbers_of_a_morning_are_made_once_for_all_jobs(
    history: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """And again when a newer set has come, by that of the job that has it."""
    sets, weather = catalogue.read([history], latency=0.0), density.clean(known_weather.read("OBSERVED"))
    whole = ImprovedHistory(sets, weather, trained_model.read())
    fewer = ImprovedHistory(sets.until(MORNING - 1.0), weather, trained_model.read())
    ends = MORNING - 7.0, MORNING
    made: list[float] = []
    improve_sets = ImprovedHistory._improve
    monkeypatch.setattr(
        ImprovedHistory, "_improve", lambda *asked: made.append(asked[1]) or improve_sets(*asked)
    )
    early = numbers(fewer.within(*ends, kept=tmp_path), LEARNED)
    assert early == numbers(fewer.within(*ends, kept=tmp_path), LEARNED)
    assert made == [MORNING]
    late = [numbers(whole.within(*ends, kept=tmp_path), LEARNED) for _ in range(2)]
    assert made == [MORNING, MORNING]
    assert late[0] == late[1] == numbers(whole, LEARNED) != early


def revised(weather: Weather) -> Weather:
    """Weather whose fluxes of two weeks were corrected later."""
    flux = weather.flux.copy()
    flux[int(MORNING) - weather.first - 20 : int(MORNING) - weather.first - 6] *= 1.2
    return Weather(weather.first, flux, weather.kp)


@pytest.mark.parametrize("change", ["late", "revised", "model"])
def test_the_numbers_of_a_morning_are_made_again_of_other_weather_and_by_another_model(
    history: Path, tmp_path: Path, change: str
) -> None:
    sets, weather, trained = (
        catalogue.read([history], latency=0.0),
        density.clean(known_weather.read("OBSERVED")),
        trained_model.read(),
    )
    ends = MORNING - 7.0, MORNING
    other = replace(trained, outlook=Outlook(0.5 * trained.outlook.coefficients))
    trained_model.write(tmp_path / "other.parquet", other)
    old = {
        "late": ImprovedHistory(sets, weather.keep_known(MORNING - 10.0), trained),
        "revised": ImprovedHistory(sets, revised(weather), trained),
        "model": ImprovedHistory(sets, weather, trained_model.read(tmp_path / "other.parquet")),
    }[change]
    before = numbers(old.within(*ends, kept=tmp_path), LEARNED)
    whole = ImprovedHistory(sets, weather, trained)
    assert numbers(whole.within(*ends, kept=tmp_path), LEARNED) == numbers(whole, LEARNED) != before


def test_sets_are_as_published_where_the_weather_ends_too_early(history: Path) -> None:
    sets, weather = catalogue.read([history], latency=0.0), density.clean(known_weather.read("OBSERVED"))
    old = ImprovedHistory(sets, weather.keep_known(MORNING - 10.0), trained_model.read())
    published = {(one.no_kozai, one.bstar) for one in sets.satellites}
    assert {(round(n, 15), b) for n, b in numbers(old, LEARNED)} <= {(round(n, 15), b) for n, b in published}
    assert old.newest(LEARNED, 101, float(sets.table["t"].min()) - 1.0) is None


def test_damaged_sets_of_an_object_are_each_object_s_own_matter(history: Path, tmp_path: Path) -> None:
    damaged = tmp_path / "damaged.tle"
    lines = history.read_text().splitlines()
    damaged.write_text("\n".join([*lines[:20], *(line[:-1] + "x" for line in lines[20:40])]) + "\n")
    with pytest.raises(InputError, match="damaged"):
        catalogue.read([damaged])
    assert len(catalogue.read([damaged], leave_out_damaged=True).table) == 10
