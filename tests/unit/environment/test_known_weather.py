"""What an assumed model knows of the weather: nothing that was measured later."""

from functools import partial

import numpy as np
import pandas as pd
import pytest
from support import EPOCH, ESTIMATION, environment
from weather_files import other_after, up_to

from opml.base import epochs
from opml.base.constants import DAY, HOUR
from opml.base.errors import InputError
from opml.catalog.associate import quarantine
from opml.catalog.fit import observations, start_states
from opml.catalog.predict import prediction
from opml.catalog.propagator import Propagator
from opml.catalog.simulate import tracking, truth as truths
from opml.dynamics import forces
from opml.dynamics.run_environment import Environment
from opml.dynamics.settings import ForceModelSettings
from opml.environment import gravity_field, known_weather, nodes, solar_activity, space_weather
from opml.environment.known_weather import Issues
from opml.environment.weather import Weather
from opml.tables import STATE

T = nodes(EPOCH, 3 * DAY)


def outlooks(source="OBSERVED", hours=3):
    return known_weather.outlooks(Issues(source=source, epoch=EPOCH, issue_hours=hours, max_days=1), T)


def mjd(utc):
    return float(sum(epochs.utc(utc, 0.0))) - epochs.MJD_ZERO


def futures():
    issues = Issues(source="OBSERVED", epoch=EPOCH, issue_hours=6, max_days=1)
    return known_weather.tabulate_futures(issues, T, members=3)


EVENING = "2016-09-29T20:00:00"
TABLES = {
    **{
        f"outlooks, {utc}": (outlooks, "issued", utc)
        for utc in ("2016-09-29T00:00:00", EVENING, "2016-09-30T04:12:00")
    },
    "futures": (futures, "issued", EVENING),
    "hindcast": (partial(known_weather.hindcast, "OBSERVED", EPOCH, T), "t", EVENING),
}


@pytest.mark.parametrize("table", TABLES)
def test_no_table_knows_what_was_measured_after_its_issue(tmp_path, monkeypatch, table):
    tabulate, time, utc = TABLES[table]
    expected = tabulate()
    other = other_after(tmp_path / "other.csv", mjd(utc))
    # As the source of the run, and as the history to learn from.
    monkeypatch.setitem(solar_activity.PACKAGED, "OBSERVED", str(other))
    found = tabulate()
    known = expected[time] <= epochs.seconds_between(EPOCH, utc)
    assert 0.2 < known.mean() < 0.8
    pd.testing.assert_frame_equal(found[known], expected[known], check_exact=True)
    assert not found[~known].equals(expected[~known])


def test_each_issue_has_all_members_of_futures():
    assert futures().groupby("issued")["member"].nunique().eq(3).all()


def test_a_forecast_starts_from_what_is_measured_and_reaches_beyond(tmp_path):
    """The operator's file ends yesterday, the run a week from now."""
    t = nodes(EPOCH, 12 * DAY)
    whole = known_weather.measured_activity("OBSERVED", EPOCH, t)
    pd.testing.assert_frame_equal(whole, known_weather.hindcast("OBSERVED", EPOCH, t), check_exact=True)
    cut = up_to(tmp_path / "cut.csv", 57664)  # ends 2016-10-03
    found = known_weather.measured_activity(cut, EPOCH, t)
    known = np.isfinite(found["f107"])
    assert t[known].max() == pytest.approx(5.327 * DAY, abs=0.01 * DAY)  # 20:00 UTC, by its last F10.7
    pd.testing.assert_frame_equal(found[known], whole[known], check_exact=True)
    issues = (Issues(source=source, epoch=EPOCH, issue_hours=24, max_days=7) for source in (cut, "OBSERVED"))
    ahead, all_of_it = (known_weather.outlooks(one, t) for one in issues)
    assert ahead["issued"].max() < all_of_it["issued"].max()
    shared = all_of_it["issued"] <= ahead["issued"].max()
    pd.testing.assert_frame_equal(ahead, all_of_it[shared].reset_index(drop=True), check_exact=True)
    assert ahead["t"].max() > t[known].max() + 6 * DAY
    with pytest.raises(InputError, match=r"expected dates from .* to 2016-10-0"):
        known_weather.hindcast(cut, EPOCH, t)
    with pytest.raises(InputError, match="expected dates from"):
        known_weather.measured_activity(up_to(tmp_path / "old.csv", 57600), EPOCH, t)


def model(source, **settings):
    """A small force model that forecasts, under the weather of a source."""
    field = gravity_field.read_icgem(gravity_field.resolve("EGM2008"))
    tables = environment(3.0) | {"solar_activity": known_weather.hindcast(source, EPOCH, T)}
    surroundings = Environment(
        EPOCH,
        **tables,
        gravity_field=gravity_field.table(field.truncate(2, 2), EPOCH),
        gm=field.gm,
        radius=field.radius,
    )
    known = forces.build(surroundings, ForceModelSettings(degree=2, order=2, third_bodies=[]))
    return forces.with_outlooks(known, outlooks(source, **settings))


def test_fits_and_predictions_know_nothing_measured_after_they_start(tmp_path, iss, three_stations):
    settings = ESTIMATION.evolve(window_hours=6.0)
    orientation = environment(3.0)["earth_orientation"]
    observed = model("OBSERVED")
    truth = truths.simulate(Propagator(observed.for_block(np.array([0])), iss), duration=DAY, step=20.0)
    tracks = tracking.simulate(truth, orientation, three_stations, rso="iss", seed=1)
    utc = "2016-09-29T03:00:00"
    results = []
    for one in (observed, model(other_after(tmp_path / "other.csv", mjd(utc)))):
        starts = start_states.perturbed(truth, tracks, rso="iss", settings=settings, seed=1)
        propagator, measured = (
            Propagator(one, iss),
            observations.Measured(tracks, orientation, three_stations),
        )
        estimates = quarantine.estimate_all(propagator, starts, measured, settings=settings)
        predictions = prediction.predict_all(propagator, truth, estimates, max_days=1)
        results.append((estimates, predictions))
    (estimates, predictions), (other_estimates, other_predictions) = results
    known = estimates["t"] <= epochs.seconds_between(EPOCH, utc)
    assert 0 < known.sum() < len(known)
    pd.testing.assert_frame_equal(estimates[known], other_estimates[known], check_exact=True)
    from_then = predictions["t_i"] <= epochs.seconds_between(EPOCH, utc)
    assert predictions.loc[from_then, "t_j"].max() > epochs.seconds_between(EPOCH, utc) + 3 * HOUR
    pd.testing.assert_frame_equal(predictions[from_then], other_predictions[from_then], check_exact=True)
    assert not predictions[~from_then][STATE].equals(other_predictions[~from_then][STATE])


def test_outlooks_are_issued_on_whole_hours_the_first_at_or_before_the_epoch():
    t, day = known_weather.issue_times(EPOCH, T, 3)
    assert t[0] <= 0.0 < t[1]
    np.testing.assert_allclose(8.0 * day, np.round(8.0 * day), atol=1e-6)
    assert known_weather.issue_times(EPOCH, T, 24)[0][0] == epochs.seconds_between(
        EPOCH, "2016-09-28T00:00:00"
    )
    table = outlooks()
    assert (table["t"] > table["issued"]).all()
    assert (table["t"] - table["issued"]).max() <= DAY + 5 * HOUR


def test_the_mean_flux_is_that_of_the_81_days_before_and_kp_that_of_the_intervals_before():
    weather = Weather(50000, np.arange(100.0), np.arange(800.0))
    found = weather.activity(np.array([50090.0 + 20 / 24, 50091.0]))
    assert found["f107"].tolist() == pytest.approx([89.0, 89.0 + 4 / 24])
    assert found["f107_mean"].tolist() == pytest.approx([49.0, 49.0 + 4 / 24])
    assert found["kp_3h"].tolist() == [725.0, 727.0]
    assert found["kp_24h"].tolist() == pytest.approx([721.5, 723.5])


@pytest.mark.parametrize(
    ("day", "fluxes", "kps"), [(50001.0, 1, 8), (50000.8, 0, 6), (50000 + 20 / 24, 1, 6), (49999.0, 0, 0)]
)
def test_a_flux_is_known_at_20_hours_and_a_kp_when_its_three_hours_are_over(day, fluxes, kps):
    known = Weather(50000, np.arange(9.0), np.arange(72.0)).keep_known(day)
    assert (len(known.flux), len(known.kp)) == (fluxes, kps)


def test_monthly_figures_were_not_measured():
    with pytest.raises(InputError, match="MSAFE: expected weather that was measured day by day"):
        known_weather.hindcast("MSAFE", EPOCH, T)
    assert [known_weather.measured_source(one) for one in ("MSAFE", "OBSERVED")] == 2 * ["OBSERVED"]


def test_weather_that_does_not_reach_81_days_back_is_refused():
    with pytest.raises(InputError, match="OBSERVED: epoch: expected dates from 1996-03-20 to 2026-01-14"):
        known_weather.hindcast("OBSERVED", "1996-02-01T00:00:00", np.array([0.0, DAY]))


def test_predicted_days_of_a_file_were_not_measured(tmp_path):
    text = solar_activity.read_text(solar_activity.resolve("OBSERVED"))
    lines = text.splitlines()
    path = tmp_path / "weather.csv"
    path.write_text("\n".join([*lines[:-5], *(line.replace("OBS", "PRD") for line in lines[-5:])]))
    whole, measured = known_weather.read("OBSERVED"), known_weather.read(path)
    assert len(measured.flux) == len(whole.flux) - 5
    assert len(space_weather.read(path, path.read_text())) == len(whole.flux)
