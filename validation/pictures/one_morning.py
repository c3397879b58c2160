"""The picture of docs/elements.md: one morning of one object, by SGP4, by opml and by what was known later.

    python -m validation.pictures.one_morning SETS WEATHER

SETS are element sets of object 20580 before and after the date, WEATHER CelesTrak's. The object and the date
are README's; of sets after the date nothing is used but where the object was.
"""

import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Ellipse
from matplotlib.ticker import FuncFormatter, MaxNLocator

import opml
from opml.base.constants import DAY
from opml.figures import style
from opml.figures.ticks import metres, rounded
from opml.interop.element_sets import mean_elements
from opml.interop.element_sets.element_set import seconds_since
from opml.orbits.elements import bent_rsw
from validation.pictures import shrunk

DATE, NAME = "2023-02-09T06:00:00", "Hubble (20580)"
LEADS = (1, 3, 7)
"""Lead times of the panels [d]."""

INSIDE = 0.9
"""Share of the errors that an ellipse of two dimensions should contain."""

_LOOKS = {"SGP4": (style.PREDICTED_COLOR, "s"), "opml": (style.RESIDUAL, "^")}


@dataclass(frozen=True)
class Places:
    """Where predictions have an object, relative to where it was.

    lead: time since the date [d]; speed: of the object [m/s]
    errors: radial and along-track error [m], by the prediction
    sigma: standard deviations of opml's, radial and along the track [m]
    """

    lead: float
    speed: float
    errors: Mapping[str, tuple[float, float]]
    sigma: tuple[float, float]


def places(sets: Path, weather: Path) -> list[Places]:
    """Return the errors after each of LEADS, at the epoch of the nearest later set."""
    made = opml.predict(sets, weather=weather, date=DATE)
    later = [one.satellite for one in mean_elements.read_sets(sets)]
    t = seconds_since(DATE, later)
    return [_places(made, later[k], t[[k]]) for k in (np.abs(t - DAY * lead).argmin() for lead in LEADS)]


def _places(made: opml.Prediction, later: mean_elements.Satrec, at: np.ndarray) -> Places:
    """Return the errors at the epoch of a later set; at: that epoch (1,) [s since the date]."""
    true = mean_elements.states(later, epoch=DATE, t=at)
    errors = {}
    for name, elements in {"SGP4": made.published, "opml": made.improved}.items():
        state = mean_elements.states(elements, epoch=DATE, t=at)
        radial, along, _ = bent_rsw(state[:, :3], true)[0]
        errors[name] = (float(radial), float(along))
    radial, along, _ = made.sigmas(at)[0]
    speed = float(np.linalg.norm(true[0, 3:]))
    return Places(float(at[0] / DAY), speed, errors, (float(radial), float(along)))


def one_morning(panels: list[Places]) -> Figure:
    """Draw a panel for each lead time: the object, and where SGP4 and opml have it, with opml's ellipse."""
    figure = style.page_figure(height_mm=110.0)
    rows = figure.subplots(len(panels), 1, squeeze=False)[:, 0]
    for axes, place in zip(rows, panels, strict=True):
        _draw(axes, place)
    figure.axes[-1].set_xlabel("along-track distance from the object")
    figure.supylabel("radial distance from the object", fontsize=8.0)
    sgp4, better = (metres(rounded(abs(panels[-1].errors[name][1]))) for name in _LOOKS)
    headline = f"One morning, three orbits: after a week SGP4 is {sgp4} off along the track, opml {better}"
    note = (
        f"{NAME}, one morning: sets, weather and forecasts known at {DATE[:16].replace('T', ' ')} UTC; true: "
        f"sets of later days; shaded: {100.0 * INSIDE:g} % ellipse of opml; each panel has its own scales"
    )
    style.add_head(figure, headline, note)
    return figure


def _draw(axes: Axes, place: Places) -> None:
    """Draw one lead time, the along-track distances also as time."""
    scale = np.sqrt(-2.0 * np.log(1.0 - INSIDE))  # of an ellipse in a plane, in sigmas
    height, width = (2.0 * scale * sigma for sigma in place.sigma)
    radial, along = place.errors["opml"]
    look = {"facecolor": style.RESIDUAL, "alpha": 0.15, "lw": 0.0}
    axes.add_patch(Ellipse((along, radial), width, height, **look))
    axes.plot(0.0, 0.0, "o", color=style.TRUE_COLOR)
    _name(axes, "true", (0.0, 0.0), style.TRUE_COLOR, (8.0, 0.0))
    sides = {"SGP4": (-8.0, 0.0), "opml": (0.0, 10.0)}
    for name, (radial, along) in place.errors.items():
        color, marker = _LOOKS[name]
        axes.plot(along, radial, marker, color=color)
        seconds = abs(along) / place.speed
        text = f"{name}: {metres(rounded(along))}, {seconds:.2g} s {'late' if along < 0.0 else 'early'}"
        _name(axes, text, (along, radial), color, sides[name])
    axes.set_title(f"after {place.lead:.1f} d", loc="left", fontsize=8.0)
    axes.yaxis.set_major_locator(MaxNLocator(4))
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_formatter(FuncFormatter(metres))
    axes.margins(0.05, 0.15)


def _name(axes: Axes, text: str, point: tuple[float, float], color: str, side: tuple[float, float]) -> None:
    """Write a text at a side of a point [points]."""
    across = {-1: "right", 0: "center", 1: "left"}[int(np.sign(side[0]))]
    look = {"ha": across, "va": "center", "fontsize": style.NOTE_SIZE, "color": color}
    axes.annotate(text, point, side, textcoords="offset points", **look)


def main() -> None:
    """Draw the picture and shrink it."""
    shrunk.save(one_morning(places(*map(Path, sys.argv[1:]))), "morning")


if __name__ == "__main__":
    main()
