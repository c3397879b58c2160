"""Ticks of axes: days with their dates, and lengths in metres or kilometres."""

from calendar import month_abbr
from datetime import datetime, timedelta

from matplotlib.axes import Axes
from matplotlib.ticker import FuncFormatter

MINUS = "\N{MINUS SIGN}"  # as axes write it


def mark_dates(axes: Axes, epoch: str, *, what: str = "time") -> None:
    """Give an axis of days since the epoch their dates.

    epoch: UTC, such as `2019-09-03T00:00:00`
    """
    start = datetime.fromisoformat(epoch)

    def date(day: float, _: int) -> str:
        there = start + timedelta(days=day)
        return f"{day:g}\n{there.day} {month_abbr[there.month]}"

    axes.xaxis.set_major_formatter(FuncFormatter(date))
    axes.set_xlabel(f"{what} [d], since {start:%Y-%m-%d %H:%M} UTC")


def metres(size: float, _: int = 0) -> str:
    """Return a size [m] as an axis writes it: `100 m`, `10 km`."""
    text = f"{size / 1e3:g} km" if abs(size) >= 1e3 else f"{size:g} m"
    return text.replace("-", MINUS)


def rounded(size: float) -> float:
    """Return a size with two significant digits."""
    return float(f"{size:.2g}")
