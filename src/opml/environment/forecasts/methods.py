"""All kinds of forecasts, by their names in the settings."""

from collections.abc import Mapping
from typing import Annotated, Any

from opml.base.errors import InputError
from opml.base.kind_sections import OfItsKind
from opml.environment.forecasts import analogues, archive, error_dressing, persistence, regression
from opml.environment.forecasts.method import Forecast, ForecastMethod, ForecastSettings, FutureForecast
from opml.environment.weather import Weather

METHODS: tuple[ForecastMethod[Any], ...] = (
    persistence.METHOD,
    regression.METHOD,
    analogues.METHOD,
    archive.METHOD,
)

_BY_KIND: Mapping[str, ForecastMethod[Any]] = {method.kind: method for method in METHODS}


FORECASTS = OfItsKind("forecast", lambda: {kind: method.settings for kind, method in _BY_KIND.items()})

AnyForecast = Annotated[ForecastSettings, FORECASTS]  # settings of a forecast, of whatever kind


def fit(history: Weather, *, days: int, settings: ForecastSettings) -> Forecast:
    """Return the forecast of `days` days of the settings' kind.

    history: weather before the run

    Raises InputError where the history is too short or a file unreadable.
    """
    check_history(history, days=days, settings=settings)
    return _BY_KIND[settings.kind].fit(history, days, settings)


def futures(
    history: Weather, forecast: Forecast, *, days: int, settings: ForecastSettings, members: int
) -> FutureForecast:
    """Return the ensemble about a forecast.

    history: weather before the run
    forecast: of `fit`, with the same settings
    days: of each future
    members: number of futures

    The futures are the forecast with its errors on days like today. Where the forecast cannot be repeated on
    past days, they are what followed those days. Raises InputError where the history is too short or a file
    unreadable.
    """
    check_history(history, days=days, settings=analogues.AnalogueSettings(kind="analogues", members=members))
    method = _BY_KIND[settings.kind]
    if not method.repeatable:
        return analogues.fit_futures(history, days=days, members=members)
    past_days = method.past_days(settings)
    return error_dressing.dress_futures(history, forecast, days=days, past_days=past_days, members=members)


def check_history(history: Weather, *, days: int, settings: ForecastSettings) -> None:
    """Raise InputError where the history is too short for a method that learns from it."""
    least = _BY_KIND[settings.kind].least_days(settings)
    if least and len(history.flux) < least + days:
        expected = f"{least + days} days of packaged weather before the epoch to learn from"
        raise InputError(f"forecast: expected {expected}, got {len(history.flux)}")


def check(history: Weather, past: Weather, day: float, *, settings: ForecastSettings) -> None:
    """Raise InputError where no forecast can be made at a time.

    history: weather before the run
    past: weather known at the time
    day: the time, a modified Julian day
    """
    check_history(history, days=1, settings=settings)
    needed, measured = _BY_KIND[settings.kind].past_days(settings), min(len(past.flux), len(past.kp) // 8)
    if measured < needed:
        raise InputError(f"forecast: expected {needed} measured days before the epoch, got {measured}")
    if files(settings):
        fit(history, days=1, settings=settings)(past, day)


def files(settings: ForecastSettings) -> list[str]:
    """Return the user's own files in the settings of a forecast."""
    return _BY_KIND[settings.kind].files(settings)
