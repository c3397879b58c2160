"""The forecast on weather whose future is known, and the futures about it."""

import numpy as np
import pytest

from opml.base.errors import InputError
from opml.environment.forecasts.regression import Forecast
from opml.environment.forecasts.similar_days import remove_bursts
from opml.environment.weather import Weather

FIRST, DAYS, AHEAD = 50000, 1500, 9
PHASE = 2.0 * np.pi / 27.0


def regular(days=DAYS):
    """Weather that the Sun's turn repeats every 27 days."""
    flux = 100.0 + 20.0 * np.sin(PHASE * np.arange(days))
    kp = 3.0 + 2.0 * np.cos(PHASE * np.arange(8 * days) / 8.0)
    return Weather(FIRST, flux, kp)


def test_a_sun_that_repeats_itself_is_foretold():
    weather = regular()
    forecast = Forecast.fit(weather.keep_known(FIRST + 1100.0), days=AHEAD)
    found = forecast.future(weather.keep_known(FIRST + 1200.0))
    np.testing.assert_allclose(found.flux, weather.flux[1200 : 1200 + AHEAD], atol=6.0)
    np.testing.assert_allclose(found.kp, weather.kp[9600 : 9600 + 8 * AHEAD], atol=0.3)
    assert (len(found.flux), len(found.kp)) == (AHEAD, 8 * AHEAD)


def test_futures_are_the_forecast_moved_by_its_errors_on_such_days():
    history, known = regular(), regular().keep_known(FIRST + 1200.0)
    flux, kp = history.flux.copy(), history.kp.copy()
    flux[1::3] *= np.random.default_rng(1).choice([1.5, 1.0], len(flux[1::3]))
    kp[8::24] = np.random.default_rng(2).choice([9.0, 0.0], len(kp[8::24]))
    rough = Weather(FIRST, flux, kp).keep_known(FIRST + 1100.0)
    forecast = Forecast.fit(rough, days=2)
    today, found = forecast.future(known), forecast.futures(known, 20)
    assert len(found) == 20
    assert min(future.kp.min() for future in found) >= 0.0
    assert max(future.kp.max() for future in found) <= 9.0
    ratios = np.array([future.flux[0] / today.flux[0] for future in found])
    assert np.ptp(ratios) > 0.3
    assert ratios.min() < 1.0 < ratios.max()


def test_a_burst_of_one_day_is_left_out():
    flux = np.array([100.0, 101.0, 102.0, 938.0, 103.0, 104.0])
    assert remove_bursts(flux).tolist() == [100.0, 101.0, 102.0, 101.0, 103.0, 104.0]
    history = regular()
    burst = Weather(history.first, history.flux.copy(), history.kp)
    burst.flux[-1] += 500.0
    assert Forecast.fit(history, days=AHEAD).future(burst).flux.max() < 250.0


def test_too_little_to_learn_from_is_told():
    with pytest.raises(InputError, match=r"^forecast: expected \d+ days of packaged weather"):
        Forecast.fit(regular(200), days=AHEAD)
    with pytest.raises(InputError, match=r"^forecast: expected 2462 days of packaged weather"):
        Forecast.fit(regular(), days=2).futures(regular(), 200)
