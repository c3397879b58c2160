"""Table of solar and geomagnetic activity, the inputs of the thermosphere's model.

MSAFE: monthly estimates of the 13-month smoothed F10.7 and Ap by NASA's Marshall Space Flight Center. In the
package each month is from the newest bulletin that lists it, published half a year later, as in Orekit.
OBSERVED: measured activity, see `space_weather`. NEWEST: that which `opml fetch` fetched, else OBSERVED.
"""

import re
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike

from opml.base import epochs, files
from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.base.files import data_folder
from opml.environment import space_weather

MSAFE = "MSAFE"
OBSERVED = "OBSERVED"
NEWEST = "NEWEST"
_PERCENTILES = (95, 50, 5)  # percentiles of MSAFE's estimates [%]

PACKAGED = {MSAFE: "msafe.tsv", OBSERVED: "space_weather.csv"}
"""Files of the package by their names in the settings."""

_COLUMNS = [f"{index}_{percentile}" for index in ("f107", "ap") for percentile in _PERCENTILES]
_MONTHS = ("JAN", "FEB", "MAR", "APR", "MAY", "JUN", "JUL", "AUG", "SEP", "OCT", "NOV", "DEC")
_BULLETIN_TITLE = "13-MONTH SMOOTH SOLAR ACTIVITY"
_FIGURES = 6 * r"\s+(\d+(?:\.\d+)?)"
_PACKAGED_TITLE = "\t".join(["month", *_COLUMNS])
_YEAR = re.compile(r"\d{4}[.-]", re.ASCII)
_MONTH = rf"(?:-(0[1-9]|1[0-2])|\.\d+\s+({'|'.join(_MONTHS)}))"
_ROW = re.compile(rf"(\d{{4}}){_MONTH}{_FIGURES}", re.ASCII)


def tabulate(source: str | Path, epoch: str, t: np.ndarray, percentile: int) -> pd.DataFrame:
    """Return the table `solar_activity`.

    source: 'MSAFE' or 'OBSERVED' (packaged), or the path of an MSAFE bulletin or of CSSI's space weather
    percentile: one of PERCENTILES, for MSAFE only

    Columns: t [s], f107, f107_mean [sfu], kp_3h, kp_24h. MSAFE's one smoothed F10.7 is both the daily and
    the mean flux, its one Ap both the three-hourly and the daily Kp. Raises InputError for an unreadable
    file and for dates outside the file's.
    """
    if percentile not in _PERCENTILES:
        raise InputError(f"percentile: expected 95, 50 or 5, got {percentile!r}")
    path = resolve(source)
    text = read_text(path)
    if space_weather.is_space_weather(text):
        return space_weather.tabulate(path, text, epoch, t)
    months = read(path, text)
    t = np.asarray(t, dtype=float)
    begin, end = (_month_start(epoch, month) for month in months.index[[0, -1]])
    if t.min() < begin or t.max() > end:
        raise InputError(
            f"{path.name}: epoch: expected dates from {months.index[0]}-01 to {months.index[-1]}-01, "
            f"got {epochs.calendar_day(epoch, t.min())} to {epochs.calendar_day(epoch, t.max())}"
        )
    months = _months_around(months, epoch, t)
    starts = np.array([_month_start(epoch, month) for month in months.index])
    f107 = np.interp(t, starts, months[f"f107_{percentile}"])
    kp = kp_from_ap(np.interp(t, starts, months[f"ap_{percentile}"]))
    return pd.DataFrame({"t": t, "f107": f107, "f107_mean": f107, "kp_3h": kp, "kp_24h": kp})


def _month_start(epoch: str, month: str) -> float:
    return epochs.seconds_between(epoch, f"{month}-01T00:00:00")


def _months_around(months: pd.DataFrame, epoch: str, t: np.ndarray) -> pd.DataFrame:
    """Return the few months, of a file's decades, that surround times `t` [s since `epoch`]."""
    # A day's margin, as calendar days are rounded.
    first, last = (epochs.calendar_day(epoch, moment)[:7] for moment in (t.min() - DAY, t.max() + DAY))
    return months.loc[first : _next_month(last)]


def reach(source: str | Path) -> tuple[str, str]:
    """Return the first and last calendar day of a source. Raises InputError for an unreadable file."""
    path = resolve(source)
    text = read_text(path)
    if space_weather.is_space_weather(text):
        return space_weather.reach(space_weather.read(path, text))
    months = read(path, text).index
    return f"{months[0]}-01", f"{months[-1]}-01"


def kp_from_ap(ap: ArrayLike) -> np.ndarray:
    """Return Kp of Ap, by a smooth fit to the conversion table (Euler & Zeng, with NASA MSFC's bulletins)."""
    return np.asarray(1.89 * np.arcsinh(0.154 * np.asarray(ap)))


def resolve(source: str | Path) -> Path:
    """Return the path of the file in a setting: 'MSAFE' or 'OBSERVED' (packaged), 'NEWEST', or a path."""
    if str(source) == NEWEST and (fetched := fetched_weather()).exists():
        return fetched
    packaged = PACKAGED.get(OBSERVED if str(source) == NEWEST else str(source))
    return Path(str(resources.files("opml") / "data" / packaged)) if packaged else Path(source)


def fetched_weather() -> Path:
    """Return where `opml fetch` leaves the weather."""
    return data_folder() / "weather.csv"


def read_text(path: str | Path) -> str:
    """Read a file of solar activity as text. Raises InputError where the file is missing or no text."""
    return files.read_text(path, "a table of solar activity", encoding="utf-8-sig")


def read(path: str | Path, text: str) -> pd.DataFrame:
    """Read the monthly activity from the text of an MSAFE bulletin or of the package's own table.

    Index: consecutive months 'YYYY-MM'. Columns: f107_95, f107_50, f107_5 [sfu], ap_95, ap_50, ap_5.
    Raises InputError for an unknown format, a malformed line, and a month that is missing or out of order.
    """
    if _BULLETIN_TITLE not in text and _PACKAGED_TITLE not in text.splitlines():
        raise InputError(f"{path}: expected an MSAFE bulletin or CSSI space weather, got an unknown format")
    lines = enumerate(map(str.strip, text.splitlines()), start=1)
    texts = [(number, line) for number, line in lines if line and line[0] != "#"]
    first = next((k for k, (_, line) in enumerate(texts) if _YEAR.match(line)), len(texts))
    rows = []
    for number, line in texts[first:]:
        match = _ROW.fullmatch(line)
        if match is None:
            raise InputError(f"{path}: line {number}: expected year, month and six figures, got {line!r}")
        year, month, name, *figures = match.groups()
        month = month or f"{_MONTHS.index(name) + 1:02d}"
        rows.append((f"{year}-{month}", *map(float, figures)))
    return _months(path, rows)


def _months(path: str | Path, rows: list[tuple[Any, ...]]) -> pd.DataFrame:
    if len(rows) < 2:
        raise InputError(f"{path}: expected at least two months, got {len(rows)}")
    months = pd.DataFrame(rows, columns=["month", *_COLUMNS]).set_index("month")
    for month, following in zip(months.index[:-1], months.index[1:], strict=True):
        expected = _next_month(month)
        if following != expected:
            raise InputError(f"{path}: expected the month {expected} after {month}, got {following}")
    return months


def _next_month(month: str) -> str:
    year, number = map(int, month.split("-"))
    return f"{year + number // 12}-{number % 12 + 1:02d}"
