"""How well the space weather can be forecast: the table of skill in docs/weather.md.

    python -m opml.report.weather docs/weather.md

Each day of ten years is a day of issue, at midnight UTC; methods have learned from the years before.
"""

import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from opml import epochs
from opml.constants import DAY
from opml.dynamics.orbit_density import OrbitDensity
from opml.environment import knowledge, solar_activity
from opml.environment.forecasts import methods
from opml.environment.space_weather import INTERVALS
from opml.environment.weather import RUN_UP, Weather
from opml.files import FilePath, replacing

FORECASTS: Mapping[str, Mapping[str, Any]] = {
    "persistence": {"kind": "persistence"},
    "recurrence": {"kind": "recurrence", "turn_days": 27},
    "regression": {"kind": "regression", "lags": 82, "ridge": 10},
    "analogues": {"kind": "analogues", "members": 30},
}
"""The methods of config.yaml."""

_FIRST, _LAST = "2016-01-01T00:00:00", "2025-12-31T00:00:00"
_LEADS = 8
_BEGIN, _END = "<!-- skill -->\n", "<!-- end of skill -->\n"


def skill(first: str = _FIRST, last: str = _LAST) -> dict[str, np.ndarray]:
    """Root mean squares (leads, 3) of each method: of F10.7 [sfu], of Kp, and of the density [%].

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
        method = methods.fit(weather.known_at(begin), days=_LEADS + 1, settings=settings)
        expected = []
        for day in map(int, days):
            known = weather.known_at(day)
            ahead = known.since(day - RUN_UP - 1).followed_by(*method(known, float(day)))
            expected.append(_figures(ahead, np.array([day])))
        found[name] = _rms(np.concatenate(expected), true)
    return found


def _monthly(days: np.ndarray) -> np.ndarray:
    """The figures by MSAFE's smooth months, which were known half a year later."""
    epoch = f"{epochs.calendar(days[0])}T00:00:00"
    midnights = DAY * np.arange(days[-1] - days[0] + _LEADS)
    activity = solar_activity.tabulate(solar_activity.MSAFE, epoch, midnights, 50)
    density = OrbitDensity().of(activity.drop(columns="t").to_numpy())
    daily: np.ndarray = np.column_stack([activity["f107"], *INTERVALS * [activity["kp_3h"]], density])
    found: np.ndarray = daily[(days - days[0])[:, None] + np.arange(_LEADS)]
    return found


def _figures(weather: Weather, days: np.ndarray) -> np.ndarray:
    """Of each day of issue, (days, leads, 10): F10.7 of a day ahead, its eight Kp, and its mean density."""
    ahead = days[:, None] + np.arange(_LEADS)
    flux = weather.flux[ahead - weather.first]
    kp = weather.kp[INTERVALS * (ahead[..., None] - weather.first) + np.arange(INTERVALS)]
    # A Kp acts in the interval after its own.
    times = ahead[..., None] + np.arange(1, INTERVALS + 1) / INTERVALS
    activity = np.stack(list(weather.activity(times.ravel()).values()), axis=1)
    density = OrbitDensity().of(activity).reshape(times.shape).mean(axis=-1)
    return np.concatenate([flux[..., None], kp, density[..., None]], axis=-1)


def _rms(expected: np.ndarray, true: np.ndarray) -> np.ndarray:
    error = expected - true
    parts = error[..., :1], error[..., 1:-1], 100.0 * error[..., -1:] / true[..., -1:]
    return np.stack([np.sqrt(np.mean(part**2, axis=(0, 2))) for part in parts], axis=1)


def table(found: Mapping[str, np.ndarray]) -> str:
    """The skill as a Markdown table, one row per quantity and method."""
    leads = range(1, _LEADS + 1)
    lines = [f"| RMS of | method | {' | '.join(f'{lead} d' for lead in leads)} |"]
    lines.append("| --- | --- |" + _LEADS * " --- |")
    for column, (quantity, digits) in enumerate((("F10.7, sfu", 1), ("Kp", 2), ("density, %", 1))):
        for name, rms in found.items():
            cells = " | ".join(f"{value:.{digits}f}" for value in rms[:, column])
            lines.append(f"| {quantity} | `{name}` | {cells} |")
    return "\n".join(lines) + "\n"


def write(path: FilePath, found: Mapping[str, np.ndarray]) -> None:
    """Put the table between its marks in a page."""
    before, _, rest = Path(path).read_text(encoding="utf-8").partition(_BEGIN)
    after = rest.partition(_END)[2]
    with replacing(path) as unfinished:
        Path(unfinished).write_text(f"{before}{_BEGIN}\n{table(found)}\n{_END}{after}", encoding="utf-8")


if __name__ == "__main__":
    write(sys.argv[1], skill())
