"""A prediction from element sets: nothing later counts, its covariance is its past's, all files agree."""

import copy
import json
import pickle
import re
from datetime import UTC, date, datetime
from functools import partial

import numpy as np
import pandas as pd
import pytest
import sinking_histories
from browser import laid_out
from element_histories import history, tle_text
from support import EPOCH, REPOSITORY, refusal

import opml
from opml import cli
from opml.base import epochs
from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.element_sets import (
    catalogue,
    corrector,
    improved_sizes,
    prediction,
    set_errors,
    station_passes,
    trained_model,
    weighting,
)
from opml.element_sets.inside import inside_forces, orbit_prediction
from opml.element_sets.inside.orbit_prediction import OrbitInside
from opml.interop import known_orbits, predicted_orbit
from opml.interop.element_sets import burns_in_sets, element_set, known_sets, mean_elements, sgp4_errors, tle
from opml.interop.predicted_orbit import LEADS
from opml.report.results import with_unit
from opml.workflow import prediction_files

DATE = "2026-01-08T06:00:00"
NUMBER = 101


@pytest.fixture(scope="module", autouse=True)
def coarse_field():
    """Orbits inside sets under a field of degree 8, in less than half of the time."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(inside_forces, "read", partial(inside_forces.read, degree=8))
        yield


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    path = tmp_path_factory.mktemp("sets") / "sets.tle"
    sinking_histories.write(path, range(NUMBER, NUMBER + 1), 49)
    return path


@pytest.fixture(scope="module")
def made(file):
    return prediction.predict(file, date=DATE)


def test_it_is_the_better_set_flown_by_sgp4(file, tmp_path, monkeypatch):
    weights = weighting.sole(pd.Series(weighting.DENSITY, index=[NUMBER]))
    monkeypatch.setattr(weighting, "weights", lambda rows, tried: weights)
    made = prediction.predict(file, date=DATE)
    assert made.way == "set improved by forecast density"
    prediction_files.write(tmp_path / "better.tle", made, {})
    t = DAY * np.array([0.0, 3.0, 7.0])
    flown = mean_elements.states(mean_elements.read(tmp_path / "better.tle"), epoch=DATE, t=t)
    # A TLE rounds the mean motion to 1e-8 revolutions a day.
    assert np.linalg.norm(made.states(t) - flown, axis=1).max() < 30.0
    published = mean_elements.states(made.published, epoch=DATE, t=t)
    assert np.linalg.norm((made.states(t) - published)[-1, :3]) > 100.0


def test_later_sets_change_nothing(made, tmp_path):
    sinking_histories.write(tmp_path / "more.tle", range(NUMBER, NUMBER + 1), 56)
    again = prediction.predict(tmp_path / "more.tle", date=DATE)
    pd.testing.assert_frame_equal(again.sizes, made.sizes, check_exact=True)
    np.testing.assert_array_equal(again.state(DATE), made.state(DATE))


def test_without_a_date_it_begins_with_the_newest_set(file):
    assert prediction.predict(file, days=1.0).date == "2026-01-07T02:00:00"


def test_its_date_given_back_without_latency_gives_the_same(file, capsys):
    assert cli.main(["predict", str(file)]) == 0
    told = capsys.readouterr().out
    begin = told.partition(" from ")[2].partition(" UTC")[0]
    assert cli.main(["predict", str(file), "--date", begin, "--latency", "0"]) == 0
    assert capsys.readouterr().out == told
    assert cli.main(["predict", str(file), "--latency", "-1"]) == 1
    assert "--latency: expected 0 hours or more, got -1" in capsys.readouterr().err


def test_times_are_text_or_clocks_and_lie_within(made):
    clock = datetime(2026, 1, 10, 6, tzinfo=UTC)
    np.testing.assert_array_equal(made.state(clock), made.states(np.array([2 * DAY]))[0])
    np.testing.assert_array_equal(made.state("2026-01-10T06:00:00Z"), made.state(clock))
    with pytest.raises(InputError, match=r"expected a time from 2026-01-08T06.* to 2026-01-15T06"):
        made.state("2026-01-15T06:00:01")


def test_what_is_handed_out_cannot_change_the_prediction(made, tmp_path):
    hours = made.t
    with pytest.raises(ValueError, match="read-only"):
        hours /= 3600.0
    made.to_oem(tmp_path / "made.oem")
    orbit = opml.read_orbit(tmp_path / "made.oem")
    for t in (orbit.t, opml.read_orbit(tmp_path / "made.oem").t):
        with pytest.raises(ValueError, match="read-only"):
            t -= t[0]


def test_copies_and_pickles_propagate_alike(made):
    for again in (copy.deepcopy(made), pickle.loads(pickle.dumps(made))):
        np.testing.assert_allclose(again.states(made.t), made.states(made.t), rtol=0, atol=1e-3)


def test_a_prediction_is_compared_as_it_is(made, tmp_path):
    made.to_oem(tmp_path / "made.oem")
    apart = opml.compare(made, opml.read_orbit(tmp_path / "made.oem"))
    assert apart["distance"].max() < 1e-3
    assert "expected orbits or predictions, got int" in refusal(opml.compare, made, 7)


def test_times_of_every_kind_are_taken(made):
    expected = made.state("2026-01-10T00:00:00")
    times = (
        np.datetime64("2026-01-10"),
        date(2026, 1, 10),
        "2026-01-10",
        "2026-01-10 00:00Z",
        datetime(2026, 1, 10),
    )
    for time in times:
        np.testing.assert_array_equal(made.state(time), expected)


@pytest.mark.parametrize("time", [3600.0, None, ["2026-01-10"], np.datetime64("NaT")], ids=str)
def test_what_is_no_time_is_refused(made, time):
    assert "time: expected UTC text, a datetime or numpy.datetime64, got" in refusal(made.state, time)


def test_what_is_no_file_or_number_is_refused(file):
    assert refusal(opml.predict, []) == "predict: expected files, got none"
    assert refusal(opml.read_orbit) == "read_orbit: expected files, got none"
    assert refusal(opml.read_orbit, [file, None]) == "read_orbit: expected files, got None"
    assert refusal(opml.predict, 3) == "predict: expected files, got 3"
    assert refusal(opml.read_orbit, "") == "read_orbit: expected files, got ''"
    assert refusal(opml.predict, file, days="2") == "predict: days: expected a number, got '2'"
    assert "nowhere.tle: no such file" in refusal(opml.predict, file, catalogue="/nowhere.tle")
    assert opml.read_orbit([file]).identity.number == NUMBER


@pytest.mark.parametrize(("days", "minutes"), [(2.3, 3312), (0.0101, 14)])
def test_an_ephemeris_has_the_whole_minutes_of_its_days(made, days, minutes):
    errors = sgp4_errors.usual(made.published, 0.0)
    short = predicted_orbit.sampled(made.identity, days, made.states, errors, remark="mine")
    assert short.span == (0.0, 60.0 * minutes)
    assert np.isfinite(short.states).all()


def test_an_ephemeris_tells_what_other_objects_share(made, tmp_path):
    made.to_oem(tmp_path / "made.oem")
    (found,) = known_orbits.segments(tmp_path / "made.oem", epoch=DATE)
    shifts = [found.density.at(DAY * day).effect[1] for day in (1.0, 7.0)]
    held = np.sqrt(sgp4_errors.COMMON) * made.sizes.loc[[1, 7], "s"]
    assert 0.0 < shifts[0] < shifts[1]
    assert (np.array(shifts) <= held + 1e-6).all()


def test_covariances_have_the_sizes_and_grow(made):
    times = ["2026-01-08T06:00:00", "2026-01-09T06:00:00", "2026-01-11T06:00:00", "2026-01-15T06:00:00"]
    sizes = [np.sqrt(np.diag(made.covariance(time))[:3]) for time in times]
    np.testing.assert_allclose(sizes, made.sizes.loc[[0, 1, 3, 7], [*"rsw"]])
    assert np.all(np.diff(np.array(sizes), axis=0) >= 0.0)
    assert np.linalg.eigvalsh(made.covariance(times[-1])).min() > 0.0


def test_a_past_that_errs_more_widens(made):
    """Errors of twice their sigmas tell twice the sigmas, the more of them there are; burns count little."""
    leads, sigma = np.tile([1, 3, 5, 7], 500), np.full(2000, 10.0)
    past = pd.DataFrame({"lead": leads, "left": 20.0, "sigma": sigma})
    assert improved_sizes._factor(past) == pytest.approx(2.0, abs=0.05)
    assert improved_sizes._factor(past.iloc[:0]) == 1.0
    assert 1.0 < improved_sizes._factor(past.iloc[:8]) < 1.5
    assert improved_sizes._factor(past.assign(left=1e6)) < 4.0


def test_own_errors_outweigh_the_usual_size():
    """Planes that drift err by a kilometre after a week, six mornings one after the other."""
    errors = pd.DataFrame({"lead": [7] * 6, "w": 1000.0})
    usual = pd.DataFrame({"w": 200.0}, index=prediction.LEADS)
    found = improved_sizes._measured(errors, usual)["w"]
    assert found[7] == pytest.approx(np.sqrt((6 * 1000.0**2 + 2 * 200.0**2) / 8))
    assert found[1] == pytest.approx(200.0)


def test_storms_of_the_last_days_widen_along_the_track(made, file, monkeypatch):
    kp = np.r_[np.full(40, 2.0), np.full(8, 7.0)]  # a daily ap of 132 at the end
    assert improved_sizes.after_storm(kp, 500e3) == np.hypot(1.0, 132.0 / improved_sizes.STORM)
    assert improved_sizes.after_storm(np.r_[kp, np.zeros(24)], 500e3) == 1.0
    assert improved_sizes.after_storm(kp, 1.3e6) == 1.0
    monkeypatch.setattr(improved_sizes, "STORM", 1.0)
    stormy = prediction.predict(file, date=DATE).sizes
    assert (stormy.loc[1:, ["s", "sgp4"]] > 2.0 * made.sizes.loc[1:, ["s", "sgp4"]]).all(axis=None)
    pd.testing.assert_series_equal(stormy["w"], made.sizes["w"])


def test_errors_of_sets_are_those_of_later_ones(tmp_path):
    """Of sets that are a kilometre ahead from the last day on, those before err by this."""
    (tmp_path / "sets.tle").write_text(tle_text(history(np.arange(15.0), ahead={14.0: 1000.0})))
    mornings = epochs.mjd(EPOCH) + 0.25 + np.arange(2.0, 14.0)
    found = set_errors.in_rsw(catalogue.read([tmp_path / "sets.tle"]), mornings, LEADS)
    last = found[found["morning"] + found["lead"] > found["morning"].max() + 0.9]
    assert len(last) > 3
    np.testing.assert_allclose(last["s"], -1000.0, atol=30.0)
    rest = found.drop(last.index)
    assert rest[["s", "w"]].abs().max().max() < 30.0


def test_where_nothing_improves_the_own_past_tells(tmp_path):
    """Sets without drag fly as published."""
    (tmp_path / "sets.tle").write_text(tle_text(history(np.arange(30.0), noise=2000.0)))
    made = prediction.predict(tmp_path / "sets.tle")
    assert made.way == "set as published"
    assert made.reason.endswith("; no B* above 0")
    assert made.sizes.loc[7, "s"] > 1500.0


ALONE = {  # revolutions a day, eccentricity, inclination [rad], B*; whether errors of such were learned
    "geostationary": (1.0027, 2e-4, 0.001, 0.0, False),
    "GPS": (2.0056, 0.01, 0.96, 0.0, False),
    "Molniya": (2.006, 0.72, 1.107, 1e-4, False),
    "very low": (16.0, 1e-3, 0.9, 2e-4, False),
    "negative B*": (15.05, 1e-3, 0.9, -1e-5, True),
}


@pytest.mark.parametrize("kind", ALONE)
def test_one_set_of_any_orbit_is_flown_by_sgp4(kind, tmp_path, capsys, monkeypatch):
    """It has the usual sigma where errors of such sets were learned, else no covariance, and says so."""
    monkeypatch.setattr(orbit_prediction, "predict", lambda *_, **__: "no orbit inside it")
    motion, eccentricity, inclination, bstar, is_learned = ALONE[kind]
    elements = [motion * 2.0 * np.pi / 1440.0, eccentricity, inclination, 1.0, 1.0, 1.0, bstar]
    one = element_set.satellite("2026-01-05T02:00:00", elements)
    (tmp_path / "one.tle").write_text("\n".join(tle.lines(one, 777)))
    outputs = [part for name in ("oem", "html", "json") for part in ("-o", str(tmp_path / f"one.{name}"))]
    assert cli.main(["predict", str(tmp_path / "one.tle"), "--days", "1", *outputs]) == 0
    told = capsys.readouterr().out
    assert ("along_track" in told) == ("typical errors of sets at its height" in told) == is_learned
    assert ("no covariance: errors of such orbits were not learned" in told) == (not is_learned)
    flown = opml.read_orbit(tmp_path / "one.oem")
    one = mean_elements.read(tmp_path / "one.tle")
    states = mean_elements.states(one, epoch="2026-01-05T02:00:00", t=np.array([3600.0]))[0]
    np.testing.assert_allclose(flown.state("2026-01-05T03:00:00"), states, rtol=1e-6)
    assert np.isfinite(flown.covariance("2026-01-05T03:00:00")).all() == is_learned
    made = prediction.predict(tmp_path / "one.tle", days=1.0)
    usual = sgp4_errors.expected(one, np.array([1.0]))[0]
    expected = [usual[1], usual[2]] if is_learned else [np.nan] * 2
    np.testing.assert_allclose(made.sizes.loc[1, ["s", "w"]].astype(float), expected, rtol=0.05)


def test_passes_rise_and_set_at_five_degrees(made):
    place = station_passes.place("52.2,21.0,110")
    found = station_passes.passes(made.ephemeris, made.date, place)
    assert len(found) > 20
    for row in found.head(5).to_dict("records"):
        t = tuple(epochs.seconds_to(made.date, row[name]) for name in ("rise", "highest", "set"))
        seen = np.degrees([station_passes._seen(made.ephemeris, made.date, place, one)[0, :2] for one in t])
        low, high, end = seen[:, 1]
        names = ("rise_azimuth", "highest_azimuth", "set_azimuth")
        assert [row[name] for name in names] == pytest.approx(seen[:, 0], abs=1e-3)
        assert (low, end) == pytest.approx((5.0, 5.0), abs=0.2)
        assert high == pytest.approx(row["elevation"], abs=1e-3)
        around = station_passes._seen(made.ephemeris, made.date, place, t[1] + np.array([-60.0, 60.0]))[:, 1]
        assert np.degrees(around).max() < high
    late = found["early_or_late"].to_numpy()
    assert late[-1] > late[0]
    assert late[0] == pytest.approx(
        1.645 * made.sigmas(epochs.seconds_to(made.date, found["highest"][0]))[0, 1] / 7600, rel=0.02
    )


def test_passes_of_southern_stations_above_a_mask_are_a_table(file, tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(orbit_prediction, "predict", lambda *_, **__: "no orbit inside it")
    path = tmp_path / "passes.csv"
    call = ["predict", str(file), "--date", f"{DATE}Z", "--days", "2", "--mask", "30", "--passes", str(path)]
    assert cli.main([*call, "--station", "-33.4,-70.6,500", "--station", "52.2,21.0,110"]) == 0
    rows = pd.read_csv(path)
    # A cell of CSV begins with no sign that a spreadsheet would compute.
    assert {*rows["station"]} == {"-33.4,-70.6,500", "52.2,21.0,110"}
    assert rows["rise"].is_monotonic_increasing
    assert (rows["elevation"] > 30.0).all()
    assert f" of {len(rows)}: UTC" in capsys.readouterr().out
    assert cli.main(call) == 1
    assert "--passes: expected a --station, got none" in capsys.readouterr().err


def test_the_sun_shines_on_what_is_not_behind_the_earth(made):
    """On 2026-01-08 the Sun stands 22.3 degrees south, and seven minutes late of noon."""
    place = station_passes.place("52.2,0.0,0")
    noon = epochs.seconds_to(DATE, "2026-01-08T12:07:00")[0]
    _, elevation = station_passes._light(made.ephemeris, made.date, noon, np.array([7e6, 0.0, 0.0]), place)
    assert elevation == pytest.approx(90.0 - 52.2 - 22.3, abs=0.3)
    _, midnight = station_passes._light(
        made.ephemeris, made.date, noon + DAY / 2, np.array([7e6, 0.0, 0.0]), place
    )
    assert midnight == pytest.approx(52.2 - 90.0 - 22.3, abs=0.3)
    # The Sun is at a right ascension of some 289 degrees.
    sun = np.array([np.cos(np.radians(289.4)), np.sin(np.radians(289.4)), -np.tan(np.radians(22.3))])
    for position, is_sunlit in ((sun, True), (-sun, False), (np.cross(sun, [0.0, 0.0, 1.0]), True)):
        at = 7e6 * position / np.linalg.norm(position)
        assert station_passes._light(made.ephemeris, made.date, noon, at, place)[0] == is_sunlit


def test_a_prediction_is_shown_in_two_lines(made):
    assert repr(made) == f"<101, 7 days from {DATE} UTC\n {made.way}>"
    past = (
        r"median error along the track after 7 d, in its last 20 mornings \(n = \d+\): SGP4 .* km, improved"
    )
    assert re.fullmatch(past + " set .* km", made.past_in_words)


@pytest.mark.parametrize("text", ["52.2", "91,0,0", "a,b,c", "1,2,3,4"])
def test_a_place_is_latitude_longitude_altitude(text):
    with pytest.raises(InputError, match=f"--station: expected .* got {text}"):
        station_passes.place(text)


SUFFIXES = ("oem", "tle", "kvn", "xml", "csv", "json", "czml", "html")


def test_the_command_writes_every_format(file, made, tmp_path, capsys):
    outputs = [part for suffix in SUFFIXES for part in ("-o", str(tmp_path / f"mine.{suffix}"))]
    place = ["--station", "52.2,21.0,110"]
    assert cli.main(["predict", str(file), "--date", DATE, *place, *outputs]) == 0
    out = capsys.readouterr().out
    assert made.way in out
    assert made.reason in out
    (segment,) = known_orbits.segments(tmp_path / "mine.oem", epoch=DATE)
    assert (segment.name, segment.identity.number, segment.covariance_frame) == ("101", 101, "RSW")
    np.testing.assert_allclose(segment.states[60], made.states(made.t[60:61])[0], rtol=1e-12)
    np.testing.assert_allclose(segment.covariances[-1], made.covariance("2026-01-15T06:00:00"), rtol=1e-9)
    expected = made.expected()
    pd.testing.assert_frame_equal(pd.read_csv(tmp_path / "mine.csv"), expected)
    rows = json.loads((tmp_path / "mine.json").read_text())["rows"]
    np.testing.assert_allclose([row["along_track"] for row in rows], expected["along_track"])
    sets = [mean_elements.read(tmp_path / f"mine.{suffix}") for suffix in ("tle", "kvn", "xml")]
    assert [one.no_kozai for one in sets] == pytest.approx([made.how["motion"]] * 3, rel=1e-9)
    document, orbit = json.loads((tmp_path / "mine.czml").read_text())
    assert document["clock"]["interval"] == "2026-01-08T06:00:00Z/2026-01-15T06:00:00Z"
    samples = np.array(orbit["position"]["cartesian"]).reshape(-1, 4)
    np.testing.assert_allclose(samples[10], [600.0, *made.states(np.array([600.0]))[0, :3]], atol=1e-3)
    page = (tmp_path / "mine.html").read_text()
    assert page.count("data:image/png;base64,") == 2
    assert "Passes over 52.2,21.0,110" in page
    assert f"{made.sizes.loc[7, 's']:.0f}" in page
    assert "http" not in page.replace("http-equiv", "")


def test_the_lines_of_the_readme_run(file, made, tmp_path, monkeypatch, capsys):
    readme = (REPOSITORY / "README.md").read_text(encoding="utf-8")
    lines = re.search("```python\n(.*?)```", readme, re.DOTALL)[1]
    monkeypatch.chdir(tmp_path)
    days = (("2023-02-09", "2026-01-09"), ("2023-02-10", "2026-01-10"))
    for told, asked in (("sets.tle", str(file)), ("SW-All.csv", "OBSERVED"), *days):
        assert told in lines
        lines = lines.replace(told, asked)
    exec(lines, {"opml": opml})
    assert capsys.readouterr().out.startswith("set ")
    assert known_orbits.segments(tmp_path / "mine.oem", epoch=DATE)


def test_a_phone_shows_all_of_the_page(made, tmp_path):
    place = station_passes.place("52.2,21.0,110")
    prediction_files.write(
        tmp_path / "mine.html", made, {place: station_passes.passes(made.ephemeris, made.date, place)}
    )
    page = laid_out((tmp_path / "mine.html").read_text(), tmp_path, width=390)
    assert page["across"] <= 390
    assert len(page["pictures"]) == 2
    assert all(drawn and right <= 390 for drawn, right in page["pictures"])
    assert all(drawn < 4 * right for drawn, right in page["pictures"]), "words in pictures are too small"
    assert page["tables"] == [0, 0]


def test_the_page_begins_with_the_errors_to_expect(made, tmp_path):
    prediction_files.write(tmp_path / "mine.html", made, {})
    _, _, page = (tmp_path / "mine.html").read_text().partition("</h1>")
    error = made.expected().set_index("lead")["along_track"].loc[1]
    assert page.lstrip().startswith("<p>Expected error along the track, one sigma: ")
    assert f"<strong>{with_unit(error)}</strong> after 1 d" in page.partition("</p>")[0]


def test_a_day_alone_begins_at_midnight(file, capsys):
    assert cli.main(["predict", str(file), "--date", DATE[:10]]) == 0
    assert f" from {DATE[:10]}T00:00:00 UTC: " in capsys.readouterr().out


def test_one_set_has_the_usual_errors(file, tmp_path):
    (tmp_path / "one.tle").write_text("".join(file.read_text().splitlines(keepends=True)[-2:]))
    made = prediction.predict(tmp_path / "one.tle", days=1.0)
    usual = "fits over 120 h on both sides of its sets, as is usual; too few sets to compare spans"
    assert (
        made.reason
        == f"{usual}; fewer than 3 sets; {trained_model.hindsight(trained_model.packaged_card(), made.date)}"
    )
    assert np.isfinite(made.sizes.to_numpy(float)).all()


def test_the_past_of_an_orbit_inside_is_that_of_orbits_inside():
    """Pairs of sets count for the lead that they are near to, by what theirs and SGP4's orbits were off."""
    columns = {"days": [1.2, 2.0, 6.5], "ahead": [10.0, 20.0, -70.0], "sgp4_ahead": [500.0, 1e3, 2e3]}
    past = orbit_prediction.past_errors(pd.DataFrame(columns))
    assert past.to_numpy().tolist() == [[1.0, 500.0, 10.0], [7.0, 2e3, -70.0]]


def test_what_no_drag_tells_is_as_wide_as_sgp4_is_usually(file, tmp_path):
    """Low down, a set alone with a B* that is none shows no drag: forces cannot know better."""
    [*_, last] = mean_elements.read_sets(file)
    published = element_set.changed(last.satellite, last.satellite.no_kozai, 0.0)
    (tmp_path / "one.tle").write_text("\n".join(tle.lines(published, NUMBER)) + "\n")
    made = prediction.predict(tmp_path / "one.tle", days=3.0)
    assert isinstance(made.inside, OrbitInside)
    assert made.sizes.loc[3, "s"] > 1000.0


def test_of_an_object_that_decays_the_days_that_it_has_are_told(file, tmp_path):
    low = [16.2 / element_set.PER_DAY, 1e-3, 1.0, 1.0, 1.0, 1.0, 0.02]
    lines = tle.lines(element_set.satellite("2026-01-08T02:00:00", low), NUMBER)
    (tmp_path / "low.tle").write_text(file.read_text() + "\n".join(lines) + "\n")
    with pytest.raises(InputError, match=r"decays by SGP4 before .*: give at most --days") as refused:
        prediction.predict(tmp_path / "low.tle")
    days = float(str(refused.value).rsplit(" ", 1)[1])
    prediction.predict(tmp_path / "low.tle", days=days).to_oem(tmp_path / "low.oem")
    with pytest.raises(InputError, match="decays by SGP4"):
        prediction.predict(tmp_path / "low.tle", days=days + 0.02)


def test_of_sets_that_cannot_be_read_the_first_tells_why(file, tmp_path):
    lines = file.read_text().splitlines(keepends=True)
    (tmp_path / "cut.tle").write_text("".join(line[:40] + "\n" for line in lines))
    with pytest.raises(InputError, match=r"cut\.tle: line 1: expected "):
        prediction.predict(tmp_path / "cut.tle")


def test_of_several_objects_one_is_named(tmp_path):
    sinking_histories.write(tmp_path / "sets.tle", range(101, 104), 30)
    with pytest.raises(InputError, match="expected --object for one of several objects, got 101, 102, 103"):
        prediction.predict(tmp_path / "sets.tle")
    assert prediction.predict(tmp_path / "sets.tle", object=102).identity.number == 102


def burned_sets(path, day, metres):
    """Write daily sets of 40 days, of an orbit that is higher by metres from a day on."""
    days = np.arange(40.0)
    since = np.maximum(days - day, 0.0) * DAY * metres / 6.78e6
    scatter, tilt = np.random.default_rng(1).normal(scale=2.0, size=(2, len(days)))
    sets = history(days, noise=20.0)
    motion = sets["mean_motion"]
    sets = sets.assign(
        mean_motion=motion * (1.0 - 1.5 * (np.where(days >= day, metres, 0.0) + scatter) / 6.78e6),
        mean_anomaly=(sets["mean_anomaly"] - 1.5 * motion * since) % (2.0 * np.pi),
        raan=(sets["raan"] + 3.5 * 1.02e-6 * since) % (2.0 * np.pi),
        inclination=sets["inclination"] + tilt / 6.78e6,
    )
    path.write_text(tle_text(sets))
    return path


def test_an_object_that_burned_lately_is_wide_and_says_so(tmp_path):
    """Misses across the burn count in full: of a kilometre in size, 120 km in a day."""
    still = prediction.predict(burned_sets(tmp_path / "still.tle", 99, 0.0))
    burned = prediction.predict(burned_sets(tmp_path / "burned.tle", 30, 1000.0))
    assert not still.burns
    assert "wide" not in still.reason
    assert [one[:10] for one in burned.burns] == [str(np.datetime64(EPOCH[:10]) + 30)]
    assert "wide: its sets show burns, the last of 1 in 20 days on 20" in burned.reason
    missed = burned.past.groupby("lead")["left"].quantile(0.9) / 1.6449
    assert burned.sizes.loc[7, "s"] >= missed[7] > 10 * still.sizes.loc[7, "s"]
    assert burned.ephemeris.remark.endswith("future manoeuvres are not modelled")


def test_cautions_of_an_orbit_inside_call_no_sigma_wide():
    """Its sigmas are those of sets since the burn."""
    told = prediction._cautions({"jump": 9.0}, "", "", burns=["2023-03-15T06:14"], thrusts=2, is_inside=True)
    burn = "its sets show burns, the last of 1 in 20 days on 2023-03-15: later ones alone count"
    assert list(told) == [burn, "the newest set misses those before it 9 times as far as usual"]


def test_a_burn_that_is_not_yet_known_or_long_ago_does_not_count(tmp_path):
    path = burned_sets(tmp_path / "sets.tle", 25, 1000.0)
    day = np.datetime64(EPOCH) + np.timedelta64(25, "D")
    sets = known_sets.of_object([path], None)
    counts = []
    for later in (1, 3, 22):
        date = str(day + np.timedelta64(later, "D"))
        shown = burns_in_sets.burns_among(known_sets.since(date, sets, until=0.0), epoch=date)
        counts.append(len(prediction.burns_before(shown, date)))
    assert counts == [0, 1, 0]


def test_an_object_that_thrusts_is_wide_and_says_so(tmp_path):
    """Low down a B* below 0 is no drag; higher up other forces make it, too."""
    days = np.arange(40.0)
    low = history(days, noise=20.0, bstar=np.where(days % 7 == 0, -1e-4, 1e-4))
    made = []
    slower = (low["mean_anomaly"] - 0.1 * low["mean_motion"] * low["t"]) % (2.0 * np.pi)
    high = low.assign(mean_motion=0.9 * low["mean_motion"], mean_anomaly=slower)
    for name, sets in (("low", low), ("high", high)):
        (tmp_path / f"{name}.tle").write_text(tle_text(sets))
        made.append(prediction.predict(tmp_path / f"{name}.tle"))
    assert "wide: 3 of its sets of 20 days have a B* below 0, as it thrusts" in made[0].reason
    missed = made[0].past["left"].abs().groupby(made[0].past["lead"]).quantile(0.9) / 1.6449
    assert (made[0].sizes.loc[missed.index, "s"] >= 0.999 * missed).all()
    assert "thrusts" not in made[1].reason


def test_the_newest_set_that_misses_those_before_it_widens_and_says_so(made, file, monkeypatch):
    monkeypatch.setattr(corrector, "jumps", lambda rows: pd.Series(12.0, rows.index))
    jumped = prediction.predict(file, date=DATE)
    assert jumped.reason.endswith("the newest set misses those before it 12 times as far as usual")
    assert np.isfinite(made.how["jump"])
    np.testing.assert_allclose(jumped.how["sigma_7d"], 6.0 * made.how["sigma_7d"])
