"""Skill and spread of the forecasts of the space weather: the two tables of docs/weather.md.

    python -m validation.forecast_skill docs/weather.md

Each day of ten years is a day of issue, at midnight UTC; the regression learns from the years before.
"""

import argparse
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np
from scoringrules import crps_ensemble

from opml.base import epochs
from opml.base.constants import DAY
from opml.base.files import FilePath, replacing
from opml.environment import known_weather, solar_activity
from opml.environment.forecasts.regression import Forecast
from opml.environment.space_weather import INTERVALS
from opml.environment.weather import RUN_UP, Future, Weather
from validation.orbit_density import OrbitDensity

_FIRST, _LAST = "2016-01-01T00:00:00", "2025-12-31T00:00:00"
_LEADS = 8
_MEMBERS, _LEVEL = 30, 0.9
_EVERY, _YEAR = 5, 73
"""Days between the issues of futures, and the number of these issues in a year."""
_SPANS = (1, 3, 5, 7)
"""Days ahead that tables tell."""


def skill(first: str = _FIRST, last: str = _LAST) -> dict[str, np.ndarray]:
    """Return the root mean square errors (leads, 3) of F10.7 [sfu], Kp and density [%], by forecast.

    first, last: days of issue (UTC text); the regression learns from the days before `first`

    `monthly` and the last values stand beside the regression. Density is the daily mean at 400 km, its error
    relative to the density by the measured activity.
    """
    weather = known_weather.read(solar_activity.OBSERVED)
    begin, end = (int(sum(epochs.utc(text, 0.0)) - epochs.MJD_ZERO) for text in (first, last))
    days = np.arange(begin, end - _LEADS + 1)
    true = _figures(weather, days)
    expected = {
        "monthly": _monthly(days),
        "persistence": _expected(weather, days, _persistence),
        "regression": _expected(weather, days, _fitted(weather, days).future),
    }
    return {name: _rms(figures, true) for name, figures in expected.items()}


def _monthly(days: np.ndarray) -> np.ndarray:
    """Return the figures by MSAFE's smooth months, which were known half a year later."""
    epoch = f"{epochs.calendar(days[0])}T00:00:00"
    midnights = DAY * np.arange(days[-1] - days[0] + _LEADS)
    activity = solar_activity.tabulate(solar_activity.MSAFE, epoch, midnights, 50)
    density = OrbitDensity().means(activity.drop(columns="t").to_numpy())
    daily = np.column_stack([activity["f107"], *INTERVALS * [activity["kp_3h"]], density])
    return np.asarray(daily[(days - days[0])[:, None] + np.arange(_LEADS)])


def _figures(weather: Weather, days: np.ndarray) -> np.ndarray:
    """Return F10.7, the eight Kp and the mean density of each day ahead: (days of issue, leads, 10)."""
    ahead = days[:, None] + np.arange(_LEADS)
    flux = weather.flux[ahead - weather.first]
    kp = weather.kp[INTERVALS * (ahead[..., None] - weather.first) + np.arange(INTERVALS)]
    # A Kp acts in the interval after its own.
    times = ahead[..., None] + np.arange(1, INTERVALS + 1) / INTERVALS
    activity = np.stack(list(weather.activity(times.ravel()).values()), axis=1)
    density = OrbitDensity().means(activity).reshape(times.shape).mean(axis=-1)
    return np.concatenate([flux[..., None], kp, density[..., None]], axis=-1)


def spread(first: str = _FIRST, last: str = _LAST) -> dict[str, np.ndarray]:
    """Return the CRPS [%] and the share inside 90 % [%] of futures of the drag over spans: (spans, 2).

    first, last: days of issue (UTC text), of which every fifth is taken; scores begin after a year

    The drag that moves a prediction along its track is the sum of each day's density times the days that
    remain. `errors of a year` are those of the regression in the year before, which know nothing of the day.
    """
    weather = known_weather.read(solar_activity.OBSERVED)
    begin, end = (int(sum(epochs.utc(text, 0.0)) - epochs.MJD_ZERO) for text in (first, last))
    days = np.arange(begin, end - _LEADS + 1, _EVERY)
    true = _drag(_figures(weather, days))
    forecast = _fitted(weather, days)
    point = _drag(_expected(weather, days, forecast.future)) / true - 1.0
    # The error of the issue five days before is not known yet.
    scored = _YEAR + 1
    before = np.lib.stride_tricks.sliding_window_view(point, _YEAR, axis=0)[: len(days) - scored]
    futures = {"regression": _future_drags(weather, days, forecast)[:, scored:] / true[scored:] - 1.0}
    futures["errors of a year"] = point[scored:] - np.moveaxis(before, -1, 0)
    return {
        name: np.array([_score(errors[..., k]) for k in range(len(_SPANS))])
        for name, errors in futures.items()
    }


def _fitted(weather: Weather, days: np.ndarray) -> Forecast:
    return Forecast.fit(weather.keep_known(days[0]), days=_LEADS + 1)


def _persistence(past: Weather) -> Future:
    """Return the last F10.7, and the mean Kp of the last 24 hours."""
    kp = np.full(INTERVALS * (_LEADS + 1), past.kp[-INTERVALS:].mean())
    return Future(np.full(_LEADS + 1, past.flux[-1]), kp)


def _future_drags(weather: Weather, days: np.ndarray, forecast: Forecast) -> np.ndarray:
    """Return the drag (members, days, spans) of the futures about a forecast at days of issue."""
    parts = [
        _ahead(weather, day, forecast.futures(weather.keep_known(day), _MEMBERS)) for day in map(int, days)
    ]
    return _drag(np.stack(parts, axis=1))


def _expected(weather: Weather, days: np.ndarray, forecast: Callable[[Weather], Future]) -> np.ndarray:
    """Return the figures (days, leads, 10) of a forecast at days of issue."""
    return np.concatenate(
        [_ahead(weather, day, [forecast(weather.keep_known(day))]) for day in map(int, days)]
    )


def _ahead(weather: Weather, day: int, futures: Sequence[Future]) -> np.ndarray:
    """Return the figures (futures, leads, 10) of futures from a day of issue on."""
    past = weather.keep_known(day).drop_before(day - RUN_UP - 1)
    today = np.array([day])
    return np.concatenate([_figures(past.extend(future), today) for future in futures])


def _drag(figures: np.ndarray) -> np.ndarray:
    """Return the sum of each day's density times the days that remain of each span: (..., spans)."""
    remaining = np.array(_SPANS)[:, None] - np.arange(_LEADS) - 0.5
    return np.asarray(figures[..., -1] @ np.maximum(remaining, 0.0).T)


def _score(futures: np.ndarray) -> tuple[float, float]:
    """Return the CRPS [%] and the share inside [%] of futures (members, days) of a truth of 0."""
    low, high = np.quantile(futures, [0.5 - 0.5 * _LEVEL, 0.5 + 0.5 * _LEVEL], axis=0, method="weibull")
    inside = (low <= 0.0) & (high >= 0.0)
    score = crps_ensemble(np.zeros(futures.shape[1]), futures, m_axis=0)
    return 100.0 * float(score.mean()), 100.0 * float(inside.mean())


def _rms(expected: np.ndarray, true: np.ndarray) -> np.ndarray:
    error = expected - true
    parts = error[..., :1], error[..., 1:-1], 100.0 * error[..., -1:] / true[..., -1:]
    return np.stack([np.sqrt(np.mean(part**2, axis=(0, 2))) for part in parts], axis=1)


def table(errors: Mapping[str, np.ndarray]) -> str:
    """Return the skill as a Markdown table, one row per quantity and forecast."""
    lines = [f"| RMS of | forecast | {' | '.join(f'{span} d' for span in _SPANS)} |"]
    lines.append("| --- | --- |" + len(_SPANS) * " --- |")
    for column, (quantity, digits) in enumerate((("F10.7, sfu", 1), ("Kp", 2), ("density, %", 1))):
        for name, rms in errors.items():
            cells = " | ".join(f"{rms[span - 1, column]:.{digits}f}" for span in _SPANS)
            lines.append(f"| {quantity} | `{name}` | {cells} |")
    return "\n".join(lines) + "\n"


def table_of_spread(scores: Mapping[str, np.ndarray]) -> str:
    """Return the spread as a Markdown table, one row per kind of futures."""
    lines = [f"| CRPS, %; part inside, % | {' | '.join(f'{span} d' for span in _SPANS)} |"]
    lines.append("| --- |" + len(_SPANS) * " --- |")
    for name, spans in scores.items():
        cells = " | ".join(f"{score:.2f}; {inside:.0f}" for score, inside in spans)
        lines.append(f"| `{name}` | {cells} |")
    return "\n".join(lines) + "\n"


def write(path: FilePath, name: str, text: str) -> None:
    """Put a table between the marks of its name in a page."""
    begin, end = f"<!-- {name} -->\n", f"<!-- end of {name} -->\n"
    before, _, rest = Path(path).read_text(encoding="utf-8").partition(begin)
    after = rest.partition(end)[2]
    with replacing(path) as unfinished:
        Path(unfinished).write_text(f"{before}{begin}\n{text}\n{end}{after}", encoding="utf-8")


def main(arguments: Sequence[str] | None = None) -> None:
    """Write both tables into a page."""
    parser = argparse.ArgumentParser(prog="python -m validation.forecast_skill", description=main.__doc__)
    parser.add_argument("page", help="the page with the marks of both tables, docs/weather.md")
    page = parser.parse_args(arguments).page
    write(page, "skill", table(skill()))
    write(page, "spread", table_of_spread(spread()))


if __name__ == "__main__":
    main()
