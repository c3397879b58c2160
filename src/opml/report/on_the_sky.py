"""Along-track errors as a station sees them: seconds too early or too late, degrees off in the sky.

The largest angle is that of a station below the RSO. An RSO of mean motion n is at r = (GM / n^2)^(1/3), and
flies at n r.
"""

from collections.abc import Sequence

import numpy as np
import pandas as pd

from opml.base.constants import DAY, EARTH_GM, WGS84_A
from opml.learning.judge.errors_by_duration import REACH_DAYS
from opml.report import texts
from opml.report.document import Block
from opml.report.results import length

BOUND = 1000.0  # along-track error [m] that a prediction's use is counted up to
SHARE = 0.9  # share of the errors that sizes hold


def section(flown: pd.DataFrame, marks: Sequence[float]) -> list[Block]:
    """Return the errors of a `replay` table as a station sees them; marks: durations [days]."""
    rate = float(flown["rate"].median())
    radius = float((EARTH_GM / rate**2) ** (1.0 / 3.0))
    speed, height = rate * radius, radius - WGS84_A
    rows = []
    for day in marks:
        near = (flown["duration"] / DAY - day).abs() <= REACH_DAYS
        if near.any():
            size = float(flown.loc[near, "e_y"].abs().quantile(SHARE))
            angle = np.degrees(np.arctan2(size, height))
            rows.append([f"{day:g} d", length(size), f"{size / speed:.2g}", f"{angle:.2g}"])
    sizes = {"speed": speed / 1000.0, "height": height / 1000.0, "within": days_within(flown)}
    return list(texts.blocks("on_the_sky.section", rows, **sizes))


def days_within(flown: pd.DataFrame) -> str:
    """Return in words for how long nine tenths of the errors of a `replay` table stay within BOUND."""
    step = 2.0 * REACH_DAYS
    number = np.round(flown["duration"] / DAY / step)
    passed = flown["e_y"].abs().groupby(number).quantile(SHARE) > BOUND
    if not passed.any():
        return "90 % stay within 1 km for the whole prediction."
    return f"90 % stay within 1 km for {max(float(passed.idxmax()) - 1.0, 0.0) * step:g} days."
