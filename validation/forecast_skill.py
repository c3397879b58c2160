"""How well the space weather can be forecast: the tables of skill and of spread in docs/weather.md.

    python -m validation.forecast_skill docs/weather.md

Each day of ten years is a day of issue, at midnight UTC; methods have learned from the years before.
"""

import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from opml.base import epochs
from opml.base.constants import DAY
from opml.base.files import FilePath, replacing
from opml.catalog.predict import weather_futures
from opml.environment import knowledge, solar_activity
from opml.environment.forecasts import methods
from opml.environment.forecasts.method import Future
from opml.environment.space_weather import INTERVALS
from opml.environment.weather import RUN_UP, Weather
from validation.orbit_density import OrbitDensity

FORECASTS: Mapping[str, Mapping[str, Any]] = {
    "persistence": {"kind": "persistence"},
    "recurrence": {"kind": "recurrence", "turn_days": 27},
    "regression": {"kind": "regression", "lags": 82, "ridge": 10},
    "analogues": {"kind": "analogues", "members": 30},
}
"""The methods of config.yaml."""

_FIRST, _LAST = "2016-01-01T00:00:00", "2025-12-31T00:00:00"
_LEADS = 8
_MEMBERS, _LEVEL = 30, 0.9
_EVERY, _YEAR = 5, 73
"""Days between the issues that futures are told at, and how many of these are in a year."""
_SPANS = (1, 3, 5, 7)


def skill(first: str = _FIRST, last: str = _LAST) -> dict[str, np.ndarray]:
    """Return root mean squares (leads, 3) of each method: of F10.7 [sfu], of Kp, and of the density [%].

    `monthly` stands beside the methods. Days of issue are those from `first` to `last` (UTC text); methods
    learn from the days before `first`. Density is the daily mean at 400 km, as a part of what the measured
    activity gives.
    """
    weather = knowledge.read(solar_activity.OBSERVED)
    begin, end = (int(sum(epochs.utc(text, 0.0)) - epochs.MJD_ZERO) for text in (first, last))
    days = np.arange(begin, end - _LEADS + 1)
    true = _figures(weather, days)
    found = {"monthly": _rms(_monthly(days), true)}
    for name, settings in FORECASTS.items():
        found[name] = _rms(_forecast(weather, days, settings), true)
    return found


def _monthly(days: np.ndarray) -> np.ndarray:
    """Return the figures by MSAFE's smooth months, which were known half a year later."""
    epoch = f"{epochs.calendar(days[0])}T00:00:00"
    midnights = DAY * np.arange(days[-1] - days[0] + _LEADS)
    activity = solar_activity.tabulate(solar_activity.MSAFE, epoch, midnights, 50)
    density = OrbitDensity().densities(activity.drop(columns="t").to_numpy())
    daily: np.ndarray = np.column_stack([activity["f107"], *INTERVALS * [activity["kp_3h"]], density])
    found: np.ndarray = daily[(days - days[0])[:, None] + np.arange(_LEADS)]
    return found


def _figures(weather: Weather, days: np.ndarray) -> np.ndarray:
    """Return by day of issue (days, leads, 10): F10.7 of a day ahead, its eight Kp, its mean density."""
    ahead = days[:, None] + np.arange(_LEADS)
    flux = weather.flux[ahead - weather.first]
    kp = weather.kp[INTERVALS * (ahead[..., None] - weather.first) + np.arange(INTERVALS)]
    # A Kp acts in the interval after its own.
    times = ahead[..., None] + np.arange(1, INTERVALS + 1) / INTERVALS
    activity = np.stack(list(weather.activity(times.ravel()).values()), axis=1)
    density = OrbitDensity().densities(activity).reshape(times.shape).mean(axis=-1)
    return np.concatenate([flux[..., None], kp, density[..., None]], axis=-1)


def spread(first: str = _FIRST, last: str = _LAST) -> dict[str, np.ndarray]:
    """Return scores (spans, 2) of futures: CRPS [%] and part inside their 90 % [%], of drag over spans.

    Every fifth day from `first` to `last` (UTC text) is a day of issue, scored after a year. Drag is what
    moves a prediction along its track: each day's density times the days that are left. `errors of a year`
    are those of the regression in the year before, which know nothing of the day.
    """
    weather = knowledge.read(solar_activity.OBSERVED)
    begin, end = (int(sum(epochs.utc(text, 0.0)) - epochs.MJD_ZERO) for text in (first, last))
    days = np.arange(begin, end - _LEADS + 1, _EVERY)
    true = _drag(_figures(weather, days))
    drags = {name: _futures_drag(weather, days, FORECASTS[name]) for name in ("regression", "analogues")}
    point = _drag(_forecast(weather, days, FORECASTS["regression"])) / true - 1.0
    # An error of five days before is not known yet.
    scored = _YEAR + 1
    before = np.lib.stride_tricks.sliding_window_view(point, _YEAR, axis=0)[: len(days) - scored]
    futures = {name: drag[:, scored:] / true[scored:] - 1.0 for name, drag in drags.items()}
    futures["errors of a year"] = point[scored:] - np.moveaxis(before, -1, 0)
    return {
        name: np.array([_score(one[..., k]) for k in range(len(_SPANS))]) for name, one in futures.items()
    }


def _futures_drag(weather: Weather, days: np.ndarray, settings: Mapping[str, Any]) -> np.ndarray:
    """Return the drag (members, days, spans) of the futures about a forecast, issued on some days."""
    tell = methods.futures(weather.known_at(days[0]), days=_LEADS + 1, settings=settings, members=_MEMBERS)
    parts = [_ahead(weather, day, tell(weather.known_at(day), float(day))) for day in map(int, days)]
    return _drag(np.stack(parts, axis=1))


def _forecast(weather: Weather, days: np.ndarray, settings: Mapping[str, Any]) -> np.ndarray:
    """Return the figures (days, leads, 10) of a forecast at days of issue."""
    method = methods.fit(weather.known_at(days[0]), days=_LEADS + 1, settings=settings)
    parts = [_ahead(weather, day, [method(weather.known_at(day), float(day))]) for day in map(int, days)]
    return np.concatenate(parts)


def _ahead(weather: Weather, day: int, futures: Sequence[Future]) -> np.ndarray:
    """Return the figures (futures, leads, 10) of futures from a day of issue on."""
    past = weather.known_at(day).since(day - RUN_UP - 1)
    today = np.array([day])
    return np.concatenate([_figures(past.followed_by(*future), today) for future in futures])


def _drag(figures: np.ndarray) -> np.ndarray:
    """Return each day's density times the days that are left, up to the end of each span: (..., spans)."""
    left = np.array(_SPANS)[:, None] - np.arange(_LEADS) - 0.5
    drag: np.ndarray = figures[..., -1] @ np.maximum(left, 0.0).T
    return drag


def _score(futures: np.ndarray) -> tuple[float, float]:
    """Return CRPS and part inside [%] of what futures (members, days) say of a truth that is 0."""
    low, _, high = weather_futures.band(futures, _LEVEL)
    inside = (low <= 0.0) & (high >= 0.0)
    score = weather_futures.crps(futures, np.zeros(futures.shape[1]))
    return 100.0 * float(score.mean()), 100.0 * float(inside.mean())


def _rms(expected: np.ndarray, true: np.ndarray) -> np.ndarray:
    error = expected - true
    parts = error[..., :1], error[..., 1:-1], 100.0 * error[..., -1:] / true[..., -1:]
    return np.stack([np.sqrt(np.mean(part**2, axis=(0, 2))) for part in parts], axis=1)


def table(found: Mapping[str, np.ndarray]) -> str:
    """Return the skill as a Markdown table, one row per quantity and method."""
    leads = range(1, _LEADS + 1)
    lines = [f"| RMS of | method | {' | '.join(f'{lead} d' for lead in leads)} |"]
    lines.append("| --- | --- |" + _LEADS * " --- |")
    for column, (quantity, digits) in enumerate((("F10.7, sfu", 1), ("Kp", 2), ("density, %", 1))):
        for name, rms in found.items():
            cells = " | ".join(f"{value:.{digits}f}" for value in rms[:, column])
            lines.append(f"| {quantity} | `{name}` | {cells} |")
    return "\n".join(lines) + "\n"


def table_of_spread(found: Mapping[str, np.ndarray]) -> str:
    """Return the spread as a Markdown table, one row per kind of futures."""
    lines = [f"| CRPS, %; part inside, % | {' | '.join(f'{span} d' for span in _SPANS)} |"]
    lines.append("| --- |" + len(_SPANS) * " --- |")
    for name, scores in found.items():
        cells = " | ".join(f"{score:.2f}; {inside:.0f}" for score, inside in scores)
        lines.append(f"| `{name}` | {cells} |")
    return "\n".join(lines) + "\n"


def write(path: FilePath, name: str, text: str) -> None:
    """Put a table between the marks of its name in a page."""
    begin, end = f"<!-- {name} -->\n", f"<!-- end of {name} -->\n"
    before, _, rest = Path(path).read_text(encoding="utf-8").partition(begin)
    after = rest.partition(end)[2]
    with replacing(path) as unfinished:
        Path(unfinished).write_text(f"{before}{begin}\n{text}\n{end}{after}", encoding="utf-8")


if __name__ == "__main__":
    write(sys.argv[1], "skill", table(skill()))
    write(sys.argv[1], "spread", table_of_spread(spread()))
