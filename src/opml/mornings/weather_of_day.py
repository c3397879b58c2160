"""The space weather of the days about a morning: what was seen, and what ephemerides took the future for."""

from collections.abc import Sequence
from datetime import date, timedelta
from typing import Any

import numpy as np
import pandas as pd

from opml.base.constants import DAY
from opml.mornings.calendar import Calendar
from opml.tables import read_table

FIGURES = ("f107", "f107_mean", "kp_24h")  # columns of `solar_activity` that are told
BEFORE, AHEAD = 3, 7  # days before and after the morning
_LOW, _HIGH = 0.1, 0.9  # quantiles of the futures


def about(
    seen: pd.DataFrame, outlooks: pd.DataFrame | None, futures: pd.DataFrame | None, *, now: float
) -> pd.DataFrame:
    """Return the figures a day apart about a morning, those to come as they were forecast by then.

    seen: table `solar_activity`, or `hindcast`
    outlooks, futures: tables of these names; None where the weather to come is taken for known
    now: when the morning is [s]

    Columns: t [s], those of FIGURES, `<figure>_low` and `<figure>_high` (the 10th and the 90th percentile of
    the futures, NaN before the morning), is_seen. Days that a table does not cover are left out.
    """
    days = now + DAY * np.arange(-BEFORE, AHEAD + 1)
    past, ahead = days[days <= now], days[days > now]
    later = seen if outlooks is None else _newest(outlooks, now)
    rows = pd.concat([_at(seen, past).assign(is_seen=True), _at(later, ahead).assign(is_seen=False)])
    return rows.join(_ranges(futures, ahead, now), on="t").reset_index(drop=True)


def read(files: Any, *, epoch: str, hour: float, day: str) -> list[dict[str, Any]]:
    """Return the figures about the morning of a date, as JSON values; None where a figure is not known.

    files: activity, and outlooks and futures where the weather to come is forecast
    """
    today, calendar = date.fromisoformat(day), Calendar(epoch, hour)
    forecast = [
        read_table(files[name], name) if files.get(name) else None for name in ("outlooks", "futures")
    ]
    now = calendar.time(today)
    rows = about(read_table(files.activity, "solar_activity"), *forecast, now=now)
    return [
        _as_values(row, today + timedelta(days=round((row["t"] - now) / DAY)))
        for row in rows.to_dict("records")
    ]


def _as_values(row: dict[Any, Any], day: date) -> dict[str, Any]:
    figures = {name: float(value) for name, value in row.items() if name not in ("t", "is_seen")}
    rounded = {name: round(value, 2) if np.isfinite(value) else None for name, value in figures.items()}
    return {"date": day.isoformat(), "is_seen": bool(row["is_seen"])} | rounded


def _newest(issues: pd.DataFrame, now: float) -> pd.DataFrame:
    """Return the rows of the newest issue by `now`; none where there is none."""
    issued = issues["issued"][issues["issued"] <= now]
    return issues[issues["issued"] == issued.max()]


def _at(table: pd.DataFrame, t: np.ndarray) -> pd.DataFrame:
    """Return the figures of the newest row by each time; no time beyond the last row has any."""
    rows = table.dropna(subset=list(FIGURES))
    begins, end = rows["t"].to_numpy(), rows["t"].max()
    known = t[t <= end] if len(rows) else t[:0]
    newest = np.searchsorted(begins, known, side="right") - 1
    figures = rows[list(FIGURES)].iloc[newest[newest >= 0]]
    return figures.assign(t=known[newest >= 0])


def _ranges(futures: pd.DataFrame | None, t: np.ndarray, now: float) -> pd.DataFrame:
    """Return the quantiles of the newest futures by time."""
    names = [f"{figure}_{end}" for figure in FIGURES for end in ("low", "high")]
    if futures is None:
        return pd.DataFrame(columns=names, index=pd.Index([], dtype=float), dtype=float)
    members: Sequence[pd.DataFrame] = [_at(rows, t) for _, rows in _newest(futures, now).groupby("member")]
    by_time = pd.concat(members).groupby("t")[list(FIGURES)]
    low, high = by_time.quantile(_LOW).add_suffix("_low"), by_time.quantile(_HIGH).add_suffix("_high")
    return low.join(high)[names]
