"""All kinds of forecasts, by the names that settings give them."""

from collections.abc import Mapping
from typing import Any

from opml.base.errors import InputError
from opml.environment.forecasts import analogues, archive, error_dressing, persistence, recurrence, regression
from opml.environment.forecasts.method import Forecast, Method, Settings, Tell
from opml.environment.weather import Weather

METHODS = (persistence.METHOD, recurrence.METHOD, regression.METHOD, analogues.METHOD, archive.METHOD)

_BY_KIND: Mapping[str, Method] = {method.kind: method for method in METHODS}


def settings_types() -> dict[str, Mapping[str, Any]]:
    """Return the type of each key that the settings of a kind have beside `kind`, by kind."""
    return {kind: method.settings for kind, method in _BY_KIND.items()}


def fit(history: Weather, *, days: int, settings: Settings) -> Forecast:
    """Make the forecast that `settings['kind']` names. Raises InputError where it cannot be made."""
    check_history(history, days=days, settings=settings)
    return _BY_KIND[settings["kind"]].fit(history, days=days, settings=settings)


def futures(history: Weather, *, days: int, settings: Settings, members: int) -> Tell:
    """Make the futures of an ensemble about the forecast that `settings['kind']` names.

    The forecast with its errors on days like today; what followed those days where its errors of the past
    cannot be told. Raises InputError where they cannot be made.
    """
    check_history(history, days=days, settings={"kind": "analogues", "members": members})
    method = _BY_KIND[settings["kind"]]
    if not method.repeatable:
        return analogues.members_of(history, days=days, members=members)
    forecast, past_days = fit(history, days=days, settings=settings), method.past_days(settings)
    return error_dressing.members_of(history, forecast, days=days, past_days=past_days, members=members)


def check_history(history: Weather, *, days: int, settings: Settings) -> None:
    """Raise InputError where a method that learns has too little to learn from."""
    least = _BY_KIND[settings["kind"]].least_days(settings)
    if least and len(history.flux) < least + days:
        expected = f"{least + days} days of packaged weather before the epoch to learn from"
        raise InputError(f"forecast: expected {expected}, got {len(history.flux)}")


def check(history: Weather, past: Weather, day: float, *, settings: Settings) -> None:
    """Raise InputError where there is too little weather, or the user's files make no forecast at `day`."""
    check_history(history, days=1, settings=settings)
    needed, given = _BY_KIND[settings["kind"]].past_days(settings), min(len(past.flux), len(past.kp) // 8)
    if given < needed:
        raise InputError(f"forecast: expected {needed} measured days before the epoch, got {given}")
    if files(settings):
        fit(history, days=1, settings=settings)(past, day)


def files(settings: Settings) -> list[str]:
    """The user's own files that the settings of a forecast name."""
    return _BY_KIND[settings["kind"]].files(settings)
