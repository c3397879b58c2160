"""The picture of docs/weather.md on what the error of a real prediction is made of, over a week.

    python -m validation.pictures.real_week ORBIT SETS WEATHER

ORBIT is Sentinel-3A's precise orbit, SETS are its element sets, WEATHER is a CSSI file. The weather's part is
what the prediction changes by under the measured weather; state and drag are the changes that then come
nearest to the orbit.
"""

import sys
from dataclasses import replace

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter

from opml.base import epochs
from opml.base.constants import DAY
from opml.element_sets import prediction
from opml.element_sets.inside import inside_forces, inside_now
from opml.element_sets.inside.inside_now import InsideNow
from opml.element_sets.inside.orbit_inside import DRAG, Beginning, departing
from opml.figures import style
from opml.figures.ticks import metres
from opml.interop import known_orbits
from opml.interop.ephemeris import EPOCH
from opml.orbits.elements import bent_rsw
from validation.pictures import shrunk
from validation.pictures.anatomy import COLORS

DATE, DAYS = "2018-12-26T06:00:00", 7
_MOTION, _LATITUDE = 0, 5  # places of the numbers that move an orbit along its track
_EVERY = 600.0  # between looks [s]


def parts(orbit: str, sets: str, weather: str) -> pd.DataFrame:
    """Return the along-track error of a prediction and its parts [m], by days ahead."""
    predicted = prediction.predict([sets], date=DATE, weather=weather)
    now: InsideNow = predicted.inside.now
    today = float(np.sum(epochs.utc(DATE, 0.0)) - epochs.MJD_ZERO)
    first = today - inside_now.PAST - inside_now.OLDEST
    measured = inside_forces.read(weather, first=first, last=today + DAYS + 1)
    begin, date = now.orbit.begin_again(now.numbers), now.forces.time(DATE)
    t = date + np.arange(0.0, DAY * DAYS + 1.0, _EVERY)
    truth = known_orbits.read([orbit]).at(epochs.seconds_between(EPOCH, DATE) + t - date)
    later = measured.time(DATE) - date
    informed = replace(begin, t=begin.t + later, known=measured.time(DATE) + DAY * (DAYS + 1))
    issued, known = (
        bent_rsw(_path(forces, one, times), truth)[:, 1]
        for forces, one, times in ((now.forces, begin, t), (measured, informed, t + later))
    )
    at = now.orbit.t
    free = [_MOTION, _LATITUDE, DRAG]
    design = np.stack([np.interp(t, at, now.orbit.partials[:, 1, k]) for k in free], axis=1)
    changes = np.linalg.lstsq(design, known, rcond=None)[0]
    state, drag = design[:, :2] @ changes[:2], design[:, 2] * changes[2]
    named = {"error": issued, "weather": issued - known, "state": state, "drag coefficient": drag}
    return pd.DataFrame(named | {"rest": known - state - drag}, index=(t - date) / DAY)


def _path(forces: inside_forces.Forces, begin: Beginning, t: np.ndarray) -> np.ndarray:
    """Return GCRF positions (n, 3) [m] of an orbit at times (n,) after its beginning."""
    times = np.concatenate([[begin.t], t])
    departures = departing([begin], forces, first=np.zeros(1, int), last=np.array([len(t)]))
    return forces.propagate(times, departures).path(0)[:, :3]


def real_week(rows: pd.DataFrame) -> Figure:
    """Draw the error of a prediction and its parts by days ahead."""
    figure = style.page_figure(height_mm=72.0)
    axes = figure.add_subplot()
    colors = {"error": style.TRUE_COLOR, **COLORS, "rest": style.MUTED}
    for name in rows:
        width = 1.4 if name == "error" else 0.9
        axes.plot(rows.index, rows[name], color=colors[name], lw=width, label=name)
    axes.axhline(0.0, color=style.MUTED, lw=0.7)
    axes.set(xlabel="days ahead", ylabel="along-track error", xlim=(0.0, DAYS))
    axes.yaxis.set_major_formatter(FuncFormatter(metres))
    drag, weather = (metres(abs(round(rows[name].iloc[-1], -1))) for name in ("drag coefficient", "weather"))
    headline = f"After a week {drag} come from the drag coefficient, {weather} from the weather: parts cancel"
    note = f"Sentinel-3A, orbit inside its set of {DATE[:10]}, against its DORIS orbit"
    style.add_head_and_legend(figure, headline, note, columns=5)
    return figure


def main(orbit: str, sets: str, weather: str) -> None:
    """Draw the picture and shrink it."""
    shrunk.save(real_week(parts(orbit, sets, weather)), "real_week")


if __name__ == "__main__":
    main(*sys.argv[1:])
