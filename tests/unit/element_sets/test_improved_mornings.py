"""Sets of mornings, improved: those of `opml improve` on the same date, whatever comes later."""

from pathlib import Path

import numpy as np
import pytest
import sinking_histories

from opml.element_sets import catalogue, density, improve, model, ways
from opml.element_sets.on_mornings import ImprovedHistory
from opml.element_sets.ways import DENSITY, LEARNED
from opml.environment import knowledge

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
    whole = ways.choice
    monkeypatch.setattr(ways, "choice", lambda rows, tried: whole(rows, {DENSITY: tried[DENSITY]}))
    table = improve.improve(known, model.read()).table
    assert (table["applied"] == DENSITY).all()
    np.testing.assert_allclose(found, table[["motion", "bstar"]], rtol=1e-13)


@pytest.mark.parametrize("name", [DENSITY, LEARNED])
def test_no_later_set_and_no_later_weather_changes_one(history: Path, name: str) -> None:
    sets, weather = catalogue.read([history], latency=0.0), density.clean(knowledge.read("OBSERVED"))
    whole, cut = (
        ImprovedHistory(sets, weather, model.read()),
        ImprovedHistory(sets.until(MORNING), weather.keep_known(MORNING), model.read()),
    )
    found = numbers(whole, name)
    assert len(found) == len(NUMBERS)
    assert found == numbers(cut, name)
    published = [(one.no_kozai, one.bstar) for one in sets.satellites]
    assert not set(found) & set(published)


def test_sets_are_as_published_where_the_weather_ends_too_early(history: Path) -> None:
    sets, weather = catalogue.read([history], latency=0.0), density.clean(knowledge.read("OBSERVED"))
    old = ImprovedHistory(sets, weather.keep_known(MORNING - 10.0), model.read())
    published = {(one.no_kozai, one.bstar) for one in sets.satellites}
    assert {(round(n, 15), b) for n, b in numbers(old, LEARNED)} <= {(round(n, 15), b) for n, b in published}
    assert old.newest(LEARNED, 101, float(sets.table["t"].min()) - 1.0) is None
