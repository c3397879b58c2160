"""Predictions of many objects, judged by orbits inside later sets: who judges, and what tables count."""

from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from catalogue_files import FIRST_DAY, write_sets
from publisher import small_forces
from support import refusal

from opml.base.constants import HOUR
from opml.base.errors import InputError
from opml.element_sets import catalogue
from opml.element_sets.inside import inside_forces, set_orbits
from opml.element_sets.inside.orbit_prediction import OrbitInside
from opml.element_sets.inside.past_orbits import FitSpan
from opml.interop.element_sets import mean_elements
from opml.interop.element_sets.element_set import elements_epoch
from opml.orbits.elements import bent_rsw
from opml.tables import STATE
from validation import public_catalogue, true_errors

DATE = "2016-01-05T06:00:00"
AHEAD = 300.0  # of the orbits inside along the track [m]
ORBIT = SimpleNamespace(reflection=lambda numbers: 0.03)
CALIBRATION = SimpleNamespace(span=FitSpan(HOUR, 0.0))
INSIDE = OrbitInside(None, SimpleNamespace(calibration=CALIBRATION, orbit=ORBIT, numbers=None), None, False)


@pytest.fixture(scope="module")
def sets(tmp_path_factory):
    return catalogue.read([write_sets(tmp_path_factory.mktemp("sets") / "sets.tle", objects=3, days=14)])


@pytest.fixture(scope="module")
def inside(sets):
    """Orbits AHEAD of all sets at their epochs."""
    states = (
        mean_elements.states(one, epoch=elements_epoch(one), t=np.zeros(1))[0] for one in sets.satellites
    )
    return np.array([[*(x[:3] + AHEAD * x[3:] / np.linalg.norm(x[3:])), *x[3:]] for x in states])


class Morning:
    """Predicts each object by SGP4 of its newest set: the first is told an orbit inside, the second none."""

    better, weather = SimpleNamespace(date=DATE), "OBSERVED"

    def predict_side_by_side(self, histories):
        return [self.predict(*history) for history in histories]

    def predict(self, number, newest):
        if number == 3:
            return InputError("sets of two objects")
        return SimpleNamespace(
            date=DATE,
            how={"height": 500e3, "motion": newest.no_kozai, "bstar": newest.bstar},
            inside=INSIDE if number == 1 else "its sets disagree",
            published=newest,
            states=lambda t: mean_elements.states(newest, epoch=DATE, t=t),
            sigmas=lambda t: np.full((len(t), 3), 100.0),
        )


def test_orbits_inside_judge_objects_that_have_one_and_sets_the_others(sets, inside, monkeypatch, capsys):
    def states(own, forces, ballistic, spans, reflection):
        is_first = own.table["number"].to_numpy() == 1
        assert (spans == np.where(is_first[:, None], [HOUR, 0.0], set_orbits.usual_spans(own))).all()
        assert (reflection == np.where(is_first, 0.03, 0.02)).all()
        rows = [sets.satellites.index(one) for one in own.satellites]
        return pd.DataFrame(inside[rows], columns=[*STATE])

    monkeypatch.setattr(inside_forces, "read", lambda *_, **__: None)
    monkeypatch.setattr(set_orbits, "states", states)
    newest = sets.until(FIRST_DAY + 4.25).newest().satellites
    histories = {number: (number, newest[number - 1]) for number in (1, 2, 3)}
    rows = public_catalogue.errors(sets, histories, Morning(), np.array([1, 2, 3]))
    assert "3: sets of two objects" in capsys.readouterr().err
    assert rows["number"].unique().tolist() == [1, 2]
    assert (rows["days"] - rows["lead"]).abs().max() <= 0.5
    by_number = rows.set_index("number")
    assert (by_number.loc[1, "judge"] == "orbit").all()
    assert by_number.loc[1, "later_s"].to_numpy() == pytest.approx(-AHEAD, abs=0.1)
    assert (by_number.loc[2, "judge"] == "set").all()
    assert by_number.loc[2, "later_s"].to_numpy() == pytest.approx(0.0, abs=1e-6)
    assert by_number["s"].equals(by_number["sgp4_s"])
    early = sets.until(FIRST_DAY + 4.25)
    said = refusal(public_catalogue.errors, early, histories, Morning(), np.array([1, 2]))
    assert said == f"element sets: expected objects with sets of the week after {DATE}, got none"


def test_tables_have_shares_of_sgp4_and_who_is_told_as_published():
    dates = [f"2026-06-{day:02d}T06:00:00" for day in (2, 9, 16, 23)]
    rows = pd.DataFrame([(date, number) for date in dates for number in range(4)], columns=["date", "number"])
    rows = rows.assign(height=500e3, lead=1, why="", judge="orbit")
    for name, size in {"": 10.0, "sgp4_": 100.0, "improved_": 80.0, "sigma_": 5.0, "later_": 90.0}.items():
        rows = rows.assign(**{f"{name}{axis}": size for axis in "rsw"})
    rows.loc[rows["number"] == 1, ["r", "w"]] = 150.0
    rows.loc[rows["number"] == 3, ["why", "judge"]] = ["its sets disagree", "set"]
    [line] = public_catalogue.table(rows).to_dict("records")
    assert (line["height [km]"], line["n"], line["objects"]) == ("450-600", 12, 3)
    assert line["along-track [%]"] == "10 (10-10)"
    assert line["along-track, `improve` [%]"] == "80 (80-80)"
    assert line["inside 90 % [%]"] == "0 / 0 / 0"
    [line] = public_catalogue.verdicts(rows).to_dict("records")
    assert (line["predictions"], line["as published"], line["objects inside"]) == (16, 4, 3)
    assert (line["worse in R"], line["worse in W"], line["worse in distance"]) == (1, 1, 1)


def test_true_errors_are_those_by_the_orbits(sets, inside):
    orbits = np.column_stack([inside, np.full(len(inside), 0.01)])
    orbits[4] = np.nan
    rows = pd.DataFrame({"newest": [3, 0, 5], "judge": [6, 4, 9]})
    known = true_errors.with_true_errors(rows, sets, orbits)
    assert known["newest"].tolist() == [3, 5]
    flown = mean_elements.states(sets.satellites[3], epoch=elements_epoch(sets.satellites[6]), t=np.zeros(1))
    off = bent_rsw(flown[:, :3], inside[6:7])[0]
    assert known.loc[0, ["r", "s", "w"]].to_numpy(float) == pytest.approx(off, abs=0.01)
    assert np.hypot(known["sin_1_latitude"], known["cos_1_latitude"]).to_numpy() == pytest.approx(1.0)


def test_the_orbit_inside_a_set_is_propagated_to_the_set_that_judges(sets, inside):
    """Nodes of these sets stand still: it comes to the height and the longitude of the next ones alone."""
    orbits = np.column_stack([inside, np.full(len(inside), 0.01)])
    rows = pd.DataFrame({"newest": [3, 3, 17], "judge": [4, 5, 18], "morning": [FIRST_DAY + 4.25] * 3})
    true = true_errors.with_true_errors(rows, sets, orbits)
    off = true_errors.by_orbits(true, sets, orbits, small_forces(first=FIRST_DAY, last=FIRST_DAY + 14))
    assert (np.abs(off) < [10e3, 1e6, 1e6]).all()


def test_what_is_a_mean_or_a_wave_is_learned_from_half_of_the_objects(monkeypatch):
    monkeypatch.setattr(true_errors, "VARIABLES", ("wave",))
    monkeypatch.setattr(true_errors, "_COMPONENTS", ("r",))
    numbers, mornings = map(np.ravel, np.meshgrid(np.arange(20), np.arange(60.0)))
    rows = pd.DataFrame({"number": numbers, "morning": mornings, "judged": mornings + 1.0})
    wave = np.sin(0.7 * mornings + numbers)
    rows = rows.assign(band=0, lead=1, wave=wave, r=50.0 + 20.0 * wave)
    by_orbits = np.where(mornings[:, None] > 40.0, 5.0, np.nan)
    *lines, counts = true_errors.scores(rows, by_orbits, 40.0)
    shares = {line["learner"]: float(line["other objects, later"].split()[0]) for line in lines}
    assert shares["orbit inside"] == pytest.approx(10.0, abs=1.0)
    assert shares["trees"] < 5.0
    assert shares["SVR"] < 10.0
    assert 15.0 < shares["median"] < 40.0
    assert lines[0]["random split"] == "n/a"
    assert sum(int(counts[name]) for name in ("later weeks", "other objects, later")) == 19 * 20
