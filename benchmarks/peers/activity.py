"""The run's solar activity, day by day, for tools that read another format."""

import datetime
from collections.abc import Iterator

import numpy as np

from benchmarks import case
from opml.base import epochs
from opml.environment import solar_activity

MARGIN = 60
"""Days before and after the run, for means of 81 days; there the figures of its ends stand."""


def daily() -> Iterator[tuple[datetime.date, float, float]]:
    """Return date, F10.7 [sfu] and Ap of each day around the run."""
    epoch, settings = case.paper().epoch, case.paper().values["environment"]
    first = datetime.date.fromisoformat(epoch[:10])
    last = int(2 * case.DAYS)
    for number in range(-MARGIN, last + MARGIN):
        date = first + datetime.timedelta(days=number)
        inside = first + datetime.timedelta(days=min(max(number, 0), last))
        t = np.array([epochs.seconds_between(epoch, f"{inside}T12:00:00")])
        row = solar_activity.tabulate(settings["solar_activity"], epoch, t, settings["percentile"]).iloc[0]
        yield date, float(row["f107"]), ap_from_kp(float(row["kp_24h"]))


def ap_from_kp(kp: float) -> float:
    """Return the inverse of `solar_activity.kp_from_ap`."""
    return float(np.sinh(kp / 1.89) / 0.154)
