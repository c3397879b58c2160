"""Each method of forecasting on weather whose future is known, and forecasts from files."""

import numpy as np
import pytest
from support import paper_values, refusal, refusals

from opml.base.errors import InputError
from opml.environment import solar_activity, space_weather
from opml.environment.forecasts import methods
from opml.environment.forecasts.radio_bursts import remove_bursts
from opml.environment.weather import Weather
from validation import forecast_skill as report

FIRST, DAYS, AHEAD = 50000, 1500, 9
PHASE = 2.0 * np.pi / 27.0
FORECASTS = {name: methods.FORECASTS.validated(one) for name, one in paper_values()["forecasts"].items()}


def regular(days=DAYS):
    """Weather that the Sun's turn repeats every 27 days."""
    flux = 100.0 + 20.0 * np.sin(PHASE * np.arange(days))
    kp = 3.0 + 2.0 * np.cos(PHASE * np.arange(8 * days) / 8.0)
    return Weather(FIRST, flux, kp)


def forecast_by(name, history, past, ahead=AHEAD):
    forecast = methods.fit(history, days=ahead, settings=FORECASTS[name])
    return forecast(past, past.first + len(past.kp) / 8.0)


@pytest.mark.parametrize(("name", "error"), [("regression", 0.3), ("analogues", 3.0)])
def test_a_sun_that_repeats_itself_is_foretold(name, error):
    weather = regular()
    known = weather.keep_known(FIRST + 1200.0)
    found = forecast_by(name, weather.keep_known(FIRST + 1100.0), known)
    np.testing.assert_allclose(found.flux, weather.flux[1200 : 1200 + AHEAD], atol=20.0 * error)
    np.testing.assert_allclose(found.kp, weather.kp[9600 : 9600 + 8 * AHEAD], atol=error)
    assert (len(found.flux), len(found.kp)) == (AHEAD, 8 * AHEAD)


def test_persistence_is_the_last_flux_and_the_mean_kp_of_a_day():
    known = regular().keep_known(FIRST + 1200.5)
    found = forecast_by("persistence", regular(0), known)
    assert set(found.flux) == {known.flux[-1]}
    assert set(found.kp) == {known.kp[-8:].mean()}
    assert len(found.kp) == 8 * AHEAD


def test_futures_are_the_forecast_moved_by_its_errors_on_such_days():
    history, known = regular(), regular().keep_known(FIRST + 1200.0)
    flux, kp = history.flux.copy(), history.kp.copy()
    flux[1::2] *= 1.5
    kp[8::16] = 9.0
    settings = FORECASTS["persistence"]
    rough = Weather(FIRST, flux, kp).keep_known(FIRST + 1100.0)
    fitted = methods.fit(rough, days=2, settings=settings)
    found = methods.futures(rough, fitted, days=2, settings=settings, members=20)(known, FIRST + 1200.0)
    forecast = forecast_by("persistence", history, known, 2)
    assert len(found) == 20
    assert min(future.kp.min() for future in found) >= 0.0
    assert max(future.kp.max() for future in found) == 9.0
    # Tomorrow has half as much again, or as much less, as persistence says.
    ratios = np.array([future.flux[0] / forecast.flux[0] for future in found])
    np.testing.assert_allclose(np.minimum(abs(ratios - 1.5), abs(ratios - 1 / 1.5)), 0.0, atol=0.15)


def test_futures_of_a_forecast_whose_errors_cannot_be_told_are_what_followed():
    weather = regular()
    known = weather.keep_known(FIRST + 1200.0)
    history, settings = weather.keep_known(FIRST + 1100.0), FORECASTS["analogues"]
    fitted = methods.fit(history, days=2, settings=settings)
    find = methods.futures(history, fitted, days=2, settings=settings, members=5)
    futures = find(known, FIRST + 1200.0)
    assert len(futures) == 5
    for future in futures:
        np.testing.assert_allclose(future.kp, weather.kp[9600:9616], atol=1e-9)


def test_a_burst_of_one_day_is_left_out():
    flux = np.array([100.0, 101.0, 102.0, 938.0, 103.0, 104.0])
    assert remove_bursts(flux).tolist() == [100.0, 101.0, 102.0, 101.0, 103.0, 104.0]
    history = regular()
    burst = Weather(history.first, history.flux.copy(), history.kp)
    burst.flux[-1] += 500.0
    assert forecast_by("regression", history, burst).flux.max() < 250.0


@pytest.mark.parametrize("name", ["regression", "analogues"])
def test_too_little_to_learn_from_is_told(name):
    with pytest.raises(InputError, match=r"^forecast: expected \d+ days of packaged weather"):
        forecast_by(name, regular(200), regular())


TABLE = """# forecasts that were made
issued\tvalid\tf107\tap
1995-10-10T00:10:00\t1995-10-10T00:00:00\t80\t15
1995-10-10T00:10:00\t1995-10-11T00:00:00\t90\t15
1995-10-12T00:10:00\t1995-10-13T00:00:00\t70\t7
"""


def archive(path):
    return methods.fit(
        regular(0), days=3, settings=methods.FORECASTS.validated({"kind": "archive", "files": [str(path)]})
    )


def test_the_newest_forecast_issued_by_then_is_used_and_its_last_row_holds_on(tmp_path):
    path = tmp_path / "archive.tsv"
    path.write_text(TABLE)
    day = 50000.0  # 1995-10-10
    known = regular().keep_known
    forecast = archive(path)
    assert forecast(known(day + 0.125), day + 0.125).flux.tolist() == [80.0, 90.0, 90.0]
    later = forecast(known(day + 2.5), day + 2.5)
    assert later.flux.tolist() == [70.0, 70.0, 70.0]
    assert set(later.kp) == {float(solar_activity.kp_from_ap(7.0))}
    with pytest.raises(InputError, match="expected one issued by 1995-10-10, got the first on 1995-10-10"):
        forecast(known(day), day)


def test_predicted_days_of_cssi_count_as_issued_when_the_measured_ones_end(tmp_path):
    lines = solar_activity.read_text(solar_activity.resolve("OBSERVED")).splitlines()
    path = tmp_path / "weather.csv"
    path.write_text("\n".join([*lines[:30], *(line.replace("OBS", "PRD") for line in lines[30:40])]))
    weather = space_weather.read(path, path.read_text())
    issued = int(weather.index[-10])
    past = Weather(issued - 5, weather["F10.7_OBS"].to_numpy()[-15:-10], np.zeros(40))
    found = archive(path)(past, float(issued))
    assert found.flux.tolist() == weather["F10.7_OBS"].to_numpy()[-10:-7].tolist()
    np.testing.assert_array_equal(found.kp, weather[space_weather.KP].to_numpy()[-10:-7].ravel())


@pytest.mark.parametrize(("old", "new", "message"), refusals("forecasts"))
def test_a_wrong_file_is_told_in_one_line(tmp_path, old, new, message):
    path = tmp_path / "archive.tsv"
    path.write_text(TABLE.replace(old, new))
    assert f"archive.tsv: {message}" in refusal(archive, path)


def test_skill_grows_worse_with_the_lead_and_the_page_holds_its_table(tmp_path):
    found = report.skill("2016-01-01T00:00:00", "2016-02-01T00:00:00")
    for name in ("persistence", "regression"):
        assert found[name][0, 0] < found[name][-1, 0]
    path = tmp_path / "page.md"
    path.write_text("before\n\n<!-- skill -->\nold\n<!-- end of skill -->\n\nafter\n")
    report.write(path, "skill", report.table(found))
    text = path.read_text()
    assert text.startswith("before\n\n<!-- skill -->\n\n| RMS of")
    assert text.endswith("\n\n<!-- end of skill -->\n\nafter\n")
    assert "old" not in text


def test_the_spread_of_futures_is_scored_by_kind_and_span(monkeypatch):
    monkeypatch.setattr(report, "_YEAR", 5)
    found = report.spread("2017-01-01T00:00:00", "2017-03-01T00:00:00")
    assert list(found) == ["regression", "analogues", "errors of a year"]
    for scores in found.values():
        assert scores.shape == (4, 2)
        assert (scores[:, 0] > 0.0).all()
        assert ((scores[:, 1] >= 0.0) & (scores[:, 1] <= 100.0)).all()
    text = report.table_of_spread(found)
    assert text.splitlines()[2].startswith(f"| `regression` | {found['regression'][0, 0]:.2f}; ")
