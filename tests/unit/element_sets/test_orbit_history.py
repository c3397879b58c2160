"""Where an object was is where the orbit of its sets was, between their epochs, too."""

import numpy as np
import pandas as pd
import pytest
from publisher import HALF, burned, published
from support import EPOCH

from opml import cli
from opml.base import epochs
from opml.base.constants import DAY
from opml.element_sets import catalogue
from opml.element_sets.inside import inside_forces, orbit_history, set_orbits, set_states
from opml.interop import ephemeris, known_orbits
from opml.interop.element_sets import element_set, tle
from opml.orbits.elements import bent_rsw
from opml.orbits.state_polynomials import StatePolynomials
from opml.tables import STATE
from validation import judges

DAYS = (0.0, 1.5, 3.0, 4.5, 6.0, 7.5, 13.0, 14.5)  # a gap of five and a half days


@pytest.fixture(scope="module")
def path(forces, truth, tmp_path_factory):
    """The sets as TLEs, whose last digit is metres."""
    file = tmp_path_factory.mktemp("sets") / "sets.tle"
    sets = [published(forces, truth, day) for day in DAYS]
    file.write_text("".join(f"{line}\n" for one in sets for line in tle.lines(one, 41335, "")))
    return file


@pytest.fixture(autouse=True)
def _forces_of_the_truth(monkeypatch, forces):
    monkeypatch.setattr(inside_forces, "read", lambda *_, **__: forces)


def off(states, times, truth):
    """By how much states at UTC texts are off the truth, on points that it has (n, 3) [m]."""
    since = np.array([epochs.seconds_between(truth.epoch, text) for text in times])
    places = np.searchsorted(truth.t, since - 1e-3)
    own = np.abs(truth.t[places] - since) < 1e-3
    assert own.sum() > 3
    return bent_rsw(states[own, :3], truth.states[places[own]])


def test_the_past_is_a_smooth_orbit_from_set_to_set(path, truth, tmp_path, capsys):
    written = tmp_path / "past.oem"
    assert cli.main(["orbit", str(path), "-o", str(written), "--weather", "OBSERVED"]) == 0
    printed = capsys.readouterr().out.splitlines()
    assert [line.startswith("2016-") for line in printed] == [True, True, False]  # two stretches
    assert "one sigma outwards, along, across [m]: " in printed[0]
    orbit = known_orbits.read([written])
    table = orbit.to_pandas()
    errors = off(table[STATE].to_numpy(), table["utc"], truth)
    assert (np.sqrt((errors**2).mean(axis=0)) < [10.0, 60.0, 15.0]).all()
    assert (np.median(np.abs(errors), axis=0) < 2.0 * table[["sigma_r", "sigma_s", "sigma_w"]].median()).all()
    segment = orbit_history.find(path).segments[0]
    between = StatePolynomials(segment.t[::2], segment.states[::2]).at(segment.t[1:-1:2])
    assert np.abs(between - segment.states[1:-1:2])[:, :3].max() < 0.01  # velocities go with positions


def test_a_burn_of_millimetres_a_second_is_told_and_parts_the_past(forces, truth, tmp_path):
    after = burned(forces, truth, day=8.2, speed=3e-3)
    sets = [published(forces, after if day > 8.2 else truth, day) for day in np.arange(0.0, 16.0, 1.5)]
    file = tmp_path / "sets.tle"
    file.write_text("".join(f"{line}\n" for one in sets for line in tle.lines(one, 41335, "")))
    history = orbit_history.find(file)
    [burn] = history.changes
    began = epochs.seconds_between(history.epoch, EPOCH)
    assert burn.begin < began + 8.2 * DAY < burn.end
    assert burn.larger == pytest.approx(5.6, abs=2.0)  # 2 dv / n; sets of four days hardly tell the drag
    assert burn.turned < 20.0
    assert len(history.segments) == 2
    assert "m larger, its plane turned by" in history.summary()


def test_dates_cut_the_past(path):
    begin, end = (str(np.datetime64(EPOCH) + np.timedelta64(hours, "h")) for hours in (30, 60))
    [segment] = orbit_history.find(path, begin=begin, end=end).segments
    assert segment.t[-1] - segment.t[0] == pytest.approx(1.25 * DAY, abs=2 * orbit_history.STEP)


def test_a_table_has_a_state_a_set_and_begins_from_that_of_the_day_before(
    path, forces, truth, tmp_path, monkeypatch
):
    for module in (set_orbits, set_states):
        monkeypatch.setattr(module, "usual_half_span", lambda satellite: HALF)
    first, second = (tmp_path / f"{name}.parquet" for name in ("first", "second"))
    asked = [str(path), "--weather", "OBSERVED", "-o"]
    assert cli.main(["orbit", *asked, str(first)]) == 0
    assert cli.main(["orbit", *asked, str(second), "--before", str(first)]) == 0
    whole, again = pd.read_parquet(first), pd.read_parquet(second)
    assert len(whole) == len(DAYS)
    np.testing.assert_allclose(again[STATE[:3]], whole[STATE[:3]], atol=30.0)  # drag along the track
    assert (whole["why"] == "").all()
    errors = off(whole[STATE].to_numpy(), whole["utc"], truth)
    assert (np.abs(errors).max(axis=0) < [20.0, 150.0, 20.0]).all()
    assert len(off(again[STATE].to_numpy(), again["utc"], truth)) == len(errors)


def test_sets_without_an_orbit_inside_are_told_and_counted(path, caplog):
    sets = catalogue.read([path])
    deep = catalogue.ElementCatalogue(sets.table, [geostationary() for _ in sets.satellites])
    table = set_states.build(deep, weather="OBSERVED")
    assert set(table["why"]) == {"deep space"}
    assert table[STATE].isna().all(axis=None)
    assert f"sets as published: {len(DAYS)}: deep space" in caplog.text


def geostationary():
    return element_set.satellite(EPOCH, [2.0 * np.pi / 1436.0, 1e-3, 0.1, 0.5, 1.0, 0.3, 0.0])


def test_a_precise_orbit_tells_the_errors_of_later_sets_and_of_the_orbits_inside(path, truth, monkeypatch):
    class Precise:
        at = staticmethod(
            StatePolynomials(truth.t - epochs.seconds_between(truth.epoch, ephemeris.EPOCH), truth.states).at
        )

    monkeypatch.setattr(set_orbits, "usual_half_span", lambda satellite: HALF)
    errors = judges.errors(Precise, catalogue.read([path]).daily(), "OBSERVED")
    by_set, by_orbit, sigma = (np.sqrt((one**2).mean(axis=0)) for one in errors.values())
    assert (by_orbit < [10.0, 60.0, 15.0]).all()
    assert (by_orbit < 0.5 * by_set).all()
    assert (by_orbit < 2.0 * sigma).all()
