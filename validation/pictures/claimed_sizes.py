"""Along-track sigmas of NASA's messages and of public sets, in docs/conjunctions.md.

    python -m validation.pictures.claimed_sizes CDM...

The messages are of NASA's CARA: they state the energy that drag takes (SEDR), and when they were made. So it
is known how far drag carries an object until the approach, and what public sets of that age usually err by.
"""

import re
import sys
from collections.abc import Iterator, Sequence

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter

from opml.base.constants import DAY, EARTH_GM, WGS84_A
from opml.conjunctions import cdm
from opml.conjunctions.conjunction import Participant
from opml.figures import style
from opml.figures.ticks import metres
from opml.interop.element_sets import sgp4_errors
from opml.interop.ephemeris import EPOCH
from opml.interop.orbit_arcs import contents
from validation.pictures import shrunk

CARRIED = 10e3
"""How far drag carries an object [m] whose error is the density's for the most part."""

SPLIT = 600.0
"""Height [km] that parts the panels."""

_SEDR = re.compile(r"^SEDR\s*=\s*([-+.\dEe]+)", re.MULTILINE)
_ROUND = 0.02  # eccentricity below which usual errors were learned


def table(paths: Sequence[str]) -> pd.DataFrame:
    """Return a row per object: name, height [km], days ahead, drag, claimed, usual [m], NaN where unknown."""
    return pd.DataFrame([row for path in paths for row in _rows(path)])


def _rows(path: str) -> Iterator[dict[str, object]]:
    conjunction = cdm.read(path, epoch=EPOCH)[0]
    rates = map(float, _SEDR.findall(contents(path).decode("ascii")))
    days = (conjunction.t - conjunction.known) / DAY
    for one, rate in zip((conjunction.first, conjunction.second), rates, strict=True):
        position, velocity = np.split(one.state, 2)
        half_axis = 1.0 / (2.0 / np.linalg.norm(position) - velocity @ velocity / EARTH_GM)
        # The axis shrinks by 2 a^2 SEDR / GM a second, and the motion grows by 3 / 2 of its share.
        drag = 1.5 * rate * half_axis**2 / EARTH_GM * (days * DAY) ** 2 * np.sqrt(EARTH_GM / half_axis**3)
        yield {
            "name": str(one.identity),
            "height": 1e-3 * (half_axis - WGS84_A),
            "days": days,
            "drag": drag,
            "claimed": np.sqrt(one.covariance[1, 1]),
            "usual": _usual(one, half_axis - WGS84_A, days, drag),
        }


def _usual(one: Participant, height: float, days: float, drag: float) -> float:
    """Return what sets at a height [m] usually err by along the track [m], NaN where that is unknown."""
    position, velocity = np.split(one.state, 2)
    axis = np.cross(velocity, np.cross(position, velocity)) / EARTH_GM - position / np.linalg.norm(position)
    band = int(np.searchsorted(sgp4_errors.HEIGHTS, height, side="right")) - 1
    if np.linalg.norm(axis) > _ROUND or not 0 <= band < len(sgp4_errors.HEIGHTS) - 1:
        return np.nan
    parts = sgp4_errors.law()[band, 1] * [1.0, days, drag]
    return float(np.linalg.norm([*parts, sgp4_errors.UNSEEN[1]]))


def claimed_sizes(objects: pd.DataFrame) -> Figure:
    """Draw one sigma along the track by days ahead, low and high: claimed, and of public sets."""
    known = objects.dropna()
    figure = style.page_figure(height_mm=80.0)
    panels = figure.subplots(1, 2, sharey=True)
    low = known["height"] < SPLIT
    for axes, rows, title in zip(
        panels, (known[low], known[~low]), (f"below {SPLIT:g} km", f"above {SPLIT:g} km"), strict=True
    ):
        axes.vlines(rows["days"], rows["claimed"], rows["usual"], color=style.MUTED, linewidth=0.6)
        look = {"color": style.RESIDUAL, "ms": 5.0, "markerfacecolor": "none"}
        axes.plot(rows["days"], rows["usual"], "D", label="typical of a public set", **look)
        look = {"color": style.TRUE_COLOR, "ms": 2.5}
        axes.plot(rows["days"], rows["claimed"], "o", label="stated in the message", **look)
        axes.set(yscale="log", xlabel="from the message to the approach [d]")
        axes.set_title(f"{title}: {len(rows)} objects", loc="left", fontsize=style.NOTE_SIZE)
        axes.yaxis.set_major_formatter(FuncFormatter(metres))
    panels[0].set_ylabel("one sigma along the track")
    panels[1].legend(loc="lower right")
    note = f"{len(known)} objects in conjunctions of NASA's CARA, 2021 to 2023; lines join an object's sigmas"
    style.add_head(
        figure,
        "After four days the typical sigma of public sets is hardly larger than that of NASA's messages",
        note,
    )
    return figure


def summary(objects: pd.DataFrame) -> str:
    """Return the median ratio of both by how far drag carries an object."""
    known = objects.dropna()
    ratio, is_carried = known["usual"] / known["claimed"], known["drag"] > CARRIED
    texts = []
    for is_in, name in ((is_carried, "over"), (~is_carried, "under")):
        low, middle, high = ratio[is_in].quantile([0.1, 0.5, 0.9])
        texts.append(f"{name} {CARRIED / 1e3:g} km: {middle:.2f} ({low:.2f} to {high:.2f}), {is_in.sum()}")
    return "\n".join(texts)


def main(*paths: str) -> None:
    """Print rows and ratios, draw the picture and shrink it."""
    objects = table(paths)
    print(objects.round(2).to_string(), summary(objects), sep="\n")
    shrunk.save(claimed_sizes(objects), "claimed")


if __name__ == "__main__":
    main(*sys.argv[1:])
