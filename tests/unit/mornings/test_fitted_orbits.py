"""A prediction from points or tracks: nothing later counts, its covariance holds the truth."""

import json
import re
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from support import EPOCH, refusal

from opml import api, cli
from opml.base.constants import DAY, HOUR
from opml.base.errors import InputError
from opml.catalog.propagator import Propagator
from opml.catalog.simulate import tracking, truth
from opml.dynamics.settings import ForceModelSettings
from opml.ephemerides import along_track_shift
from opml.ephemerides.paths import Paths
from opml.interop import known_orbits, oem, tdm
from opml.interop.element_sets import mean_elements
from opml.mornings.outcomes import UNPROVEN
from opml.mornings.prediction_request import Request
from opml.orbits.elements import in_rsw
from opml.study import prediction
from opml.tables import STATE

DATE = "2016-10-02T00:09:45"
SMALL = {"degree": 8, "order": 8, "third_bodies": ["sun", "moon"]}


@pytest.fixture(scope="module")
def orbit(iss):
    """Five days of the paper's RSO, with a tenth of its drag, under the weather that was measured."""
    environment = api.make_environment(EPOCH, days=5, activity="OBSERVED", degree=8)
    propagator = Propagator(api.force_model(environment, **SMALL), replace(iss, area_to_mass=0.005))
    return truth.simulate(propagator, duration=5 * DAY, step=60.0)


@pytest.fixture(scope="module", autouse=True)
def small():
    """Settings with few forces and futures, and fits of a day."""
    settings = prediction.settings()
    changes = {
        "force_model": ForceModelSettings(**SMALL),
        "futures": 2,
        "integrator": settings.integrator.evolve(max_step_s=120.0),
        "models": {"running24": settings.models["running24"]},
    }
    few = settings.model_copy(update=changes)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(prediction, "settings", lambda: few)
        yield


def points(orbit, path, *, until=5 * DAY, ahead=0.0):
    """Write the orbit up to a time as an OEM, later positions moved."""
    kept = orbit[orbit["t"] <= until].copy()
    kept.loc[kept["t"] > DAY * 3.55, STATE[:3]] += ahead
    oem.write(path, oem.truth_segments(kept, rso="iss"), epoch=EPOCH)
    return path


def made_of(path, **asked):
    asked = {"days": 1.0, "date": DATE, "area_to_mass": 0.005} | asked
    return prediction.of_measurements(Request([path], **asked), progress=lambda line: None)


@pytest.fixture(scope="module")
def made(orbit, tmp_path_factory):
    return made_of(points(orbit, tmp_path_factory.mktemp("points") / "iss.oem"))


def off(made, orbit, days):
    """How far a prediction is off the orbit in RSW, an hour each for a day, from a day of the orbit on."""
    begin, t = round(days * DAY / 60.0), np.arange(0.0, DAY + 1.0, HOUR)
    true = orbit[STATE].to_numpy()[begin : begin + 1441 : 60]
    return in_rsw(made.states(t) - true, true)[:, :3], made.sigmas(t)


def test_its_covariance_holds_the_truth(made, orbit):
    errors, sigmas = off(made, orbit, 3.5)
    assert (np.abs(errors) < 3.0 * sigmas).all()
    assert sigmas[-1, 1] > 5.0 * sigmas[0, 1]
    assert sigmas[-1, 1] < 2e3
    assert re.fullmatch(
        r"from 2\d predictions on 3 mornings before, up to 2\.\d days long, and typical .*", made.basis
    )
    assert np.linalg.eigvalsh(made.ephemeris.covariances).min() > 0.0


def test_what_was_measured_after_the_date_changes_nothing(made, orbit, tmp_path):
    again = made_of(points(orbit, tmp_path / "iss.oem", until=4 * DAY, ahead=1e4))
    np.testing.assert_array_equal(again.states(again.t), made.states(made.t))
    np.testing.assert_array_equal(again.sigmas(again.t), made.sigmas(made.t))


@pytest.fixture(scope="module")
def hours(orbit, tmp_path_factory):
    """A file of seven hours."""
    return points(orbit, tmp_path_factory.mktemp("hours") / "iss.oem", until=0.3 * DAY)


@pytest.fixture(scope="module")
def short(hours):
    return made_of(hours, date=None)


def test_a_past_of_hours_has_the_covariance_of_its_fit(short, orbit):
    assert (short.reason.split(":")[0], short.date) == (UNPROVEN, "2016-09-28T19:21:45")
    assert short.basis.startswith("from typical errors of such fits")
    assert short.past.empty
    errors, sigmas = off(short, orbit, 0.3)
    assert (np.abs(errors) < 3.0 * sigmas).all()


def test_tracks_are_fitted_by_their_radars(orbit, earth_orientation, three_stations, tmp_path, capsys):
    measured = tracking.simulate(
        orbit[orbit["t"] <= 1.5 * DAY], earth_orientation, three_stations, rso="iss", seed=1
    )
    tdm.write(tmp_path / "tracks.tdm", measured, epoch=EPOCH, rso="iss")
    made = api.predict(tmp_path / "tracks.tdm", days=1, stations=three_stations, area_to_mass=0.005)
    assert made.identity.name == "iss"
    (late,) = np.flatnonzero(orbit["t"] == np.floor(measured["t"].max() / 60.0) * 60.0 + 3600.0)
    when = str(np.datetime64(EPOCH) + np.timedelta64(int(orbit["t"].iloc[late]), "s"))
    assert np.linalg.norm(made.state(when)[:3] - orbit[STATE[:3]].to_numpy()[late]) < 2e3


def test_measurements_that_no_orbit_fits_are_refused(tmp_path):
    """A circle whose plane does not turn."""
    turn, t = 1.1e-3, np.arange(0.0, 0.75 * DAY, 120.0)
    circle = 6.9e6 * np.array([np.cos(turn * t), 0.6 * np.sin(turn * t), 0.8 * np.sin(turn * t)])
    utc = np.datetime64("2016-10-02T00:00:00") + t.astype("m8[s]")
    table = pd.DataFrame(dict(zip(("utc", "x_gcrf_m", "y_gcrf_m", "z_gcrf_m"), [utc, *circle], strict=True)))
    table.to_csv(tmp_path / "mine.csv", index=False, date_format="%Y-%m-%dT%H:%M:%S")
    with pytest.raises(InputError, match=r"mine.csv: expected .* off the best: .* did it burn"):
        made_of(tmp_path / "mine.csv", date=None)


def test_one_track_of_one_radar_tells_no_drag_but_where_the_object_is(
    orbit, earth_orientation, three_stations, tmp_path
):
    measured = tracking.simulate(orbit, earth_orientation, three_stations[:1], rso="iss", seed=1)
    begins = measured.groupby("track")["t"].min()
    alone = begins.index[begins.diff() > 12.5 * HOUR][-1]  # no other in the twelve hours before
    tdm.write(tmp_path / "few.tdm", measured[measured["track"] <= alone], epoch=EPOCH, rso="iss")
    made = api.predict(tmp_path / "few.tdm", days=1, stations=three_stations, area_to_mass=0.005)
    last = np.ceil(measured.loc[measured["track"] == alone, "t"].max())
    at = orbit[(orbit["t"] > last) & (orbit["t"] < last + HOUR)]
    t, true = at["t"].to_numpy() - last, at[STATE].to_numpy()
    errors, sigmas = in_rsw(made.states(t) - true, true)[:, :3], made.sigmas(t)
    assert (np.abs(errors) < 3.0 * sigmas).all()
    assert sigmas.max() < 1e3


SUFFIXES = ("oem", "tle", "kvn", "csv", "json", "czml", "html")


def test_the_command_writes_every_format(hours, short, tmp_path, capsys):
    outputs = [part for suffix in SUFFIXES for part in ("-o", str(tmp_path / f"mine.{suffix}"))]
    asked = ["--days", "1", "--area-to-mass", "0.005", "--station", "52.2,21.0,110"]
    assert cli.main(["predict", str(hours), *asked, *outputs]) == 0
    told = capsys.readouterr()
    assert short.way in told.out
    assert short.reason in told.out
    assert "sgp4" not in told.out
    assert "morning 1 of 1" in told.err
    (segment,) = known_orbits.segments(tmp_path / "mine.oem", epoch=short.date)
    np.testing.assert_allclose(segment.states[60], short.states(short.t[60:61])[0], rtol=1e-12)
    np.testing.assert_allclose(np.sqrt(np.diag(segment.covariances[0])[:3]), short.sigmas(short.t[:1])[0])
    pd.testing.assert_frame_equal(pd.read_csv(tmp_path / "mine.csv"), short.expected(), check_dtype=False)
    rows = json.loads((tmp_path / "mine.json").read_text())["rows"]
    assert rows[0]["sgp4_along_track"] is None
    for suffix in ("tle", "kvn"):
        flown = mean_elements.states(
            mean_elements.read(tmp_path / f"mine.{suffix}"), epoch=short.date, t=short.t
        )
        assert np.linalg.norm(flown - short.states(short.t), axis=1).max() < 5e3
    page = (tmp_path / "mine.html").read_text()
    assert page.count("data:image/png;base64,") == 2
    assert "Passes over 52.2,21.0,110" in page
    assert short.reason in page
    assert "SGP4" not in page


def test_a_mirrored_orbit_is_told(orbit, tmp_path, caplog):
    """As with one sign wrong: oceans and continents pull at other longitudes."""
    mirrored = orbit.assign(x=-orbit["x"], vx=-orbit["vx"])
    path = points(mirrored, tmp_path / "iss.oem", until=1.2 * DAY)
    made_of(path, date=None)
    (told,) = caplog.messages
    assert re.fullmatch(r".*iss\.oem: measurements are off their fit by \d+ sigma: are .*", told)


def test_an_area_that_is_not_given_follows_from_how_light_presses(iss, tmp_path, caplog):
    """High up a day of points tells it."""
    environment = api.make_environment(EPOCH, days=2, activity="OBSERVED", degree=8)
    high = Propagator(api.force_model(environment, **SMALL), replace(iss, a=12e6, area_to_mass=0.001))
    path = points(truth.simulate(high, duration=1.2 * DAY, step=60.0), tmp_path / "high.oem")
    made_of(path, date=None, area_to_mass=None)
    (told,) = re.findall(r"high\.oem: area to mass of (\S+) m2/kg, by how light presses", caplog.text)
    assert float(told) == pytest.approx(0.001, rel=0.2)


def test_an_area_that_light_does_not_tell_is_a_guess_and_told(hours, monkeypatch, caplog):
    monkeypatch.setattr("opml.mornings.prediction.LIT", 0.0)
    monkeypatch.setattr("opml.mornings.prediction._PRIOR", 1.0)
    made_of(hours, date=None, area_to_mass=None)
    assert "iss.oem: area to mass is a guess, 0.01 m2/kg: light presses by it" in caplog.text


def test_a_date_that_does_not_exist_is_refused(hours):
    expected = "epoch: expected an instant that exists, got '2016-02-30T00:00:00'"
    assert refusal(made_of, hours, date="2016-02-30T00:00:00").startswith(expected)


def test_a_single_point_is_refused(tmp_path):
    (tmp_path / "one.csv").write_text("utc,x_gcrf_m,y_gcrf_m,z_gcrf_m\n2019-09-03T00:00:00,7e6,0,0\n")
    with pytest.raises(InputError, match=r"one\.csv: expected measurements, got fewer than two"):
        made_of(tmp_path / "one.csv", date=None)


def test_an_orbit_that_is_hardly_determined_is_refused(hours, monkeypatch):
    made = Paths.ephemeris
    monkeypatch.setattr(Paths, "ephemeris", lambda *path, at: made(*path, at=at).head(200))
    said = refusal(made_of, hours, date=None)
    assert re.fullmatch(
        r".*iss\.oem: expected an orbit for 1 days, got one that comes down, or .* after 0\.\d", said
    )
    monkeypatch.setattr(Paths, "ephemeris", lambda *path, at: made(*path, at=at).head(1))
    assert refusal(made_of, hours, date=None).endswith("as little was measured before the date")
    monkeypatch.setattr(Paths, "ephemeris", made)
    monkeypatch.setattr(along_track_shift, "LEAST_EPOCHS", 10**6)
    assert "expected at least 1000000 epochs to correct" in refusal(made_of, hours, date=None)
    monkeypatch.setattr(along_track_shift, "ROUGH", 0.0)
    assert "got fits over several windows that differ too fast" in refusal(made_of, hours, date=None)


def test_points_of_no_orbit_are_refused(tmp_path):
    lines = "utc,x_gcrf_m,y_gcrf_m,z_gcrf_m\n2019-09-03T00:00:00,7e6,0,0\n2019-09-03T00:20:00,5e6,4e6,0\n"
    (tmp_path / "two.csv").write_text(lines)
    with pytest.raises(InputError, match=r"two\.csv: expected what an orbit fits, got none: are frame, axes"):
        made_of(tmp_path / "two.csv", date=None)


def test_weather_that_ends_too_early_is_refused(tmp_path):
    lines = "utc,x_gcrf_m,y_gcrf_m,z_gcrf_m\n2026-05-01T00:00:00,7e6,0,0\n2026-05-01T02:00:00,0,7e6,0\n"
    (tmp_path / "new.csv").write_text(lines)
    with pytest.raises(InputError, match=r"OBSERVED: expected space weather.* `opml fetch` gets newer"):
        made_of(tmp_path / "new.csv", date=None)
