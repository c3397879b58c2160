"""Figures of a prediction: the ground track of a day, and errors expected over its days."""

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter

from opml.base.constants import DAY
from opml.element_sets.prediction import Prediction
from opml.element_sets.station_passes import Place, in_itrf
from opml.figures.ground_tracks import draw_land, frame, geodetic_places, split_line
from opml.figures.line_ends import name_ends
from opml.figures.style import (
    HIGHLIGHT,
    PREDICTED_COLOR,
    RESIDUAL,
    TRUE_COLOR,
    add_head,
    legend,
    screen_figure,
)
from opml.figures.ticks import metres, rounded
from opml.interop.predicted_orbit import PredictedOrbit

_KILO = 1e3


def ground_track(prediction: PredictedOrbit, places: list[Place]) -> Figure:
    """Draw where the object passes over the Earth on the first day, and the places that look at it."""
    t = np.arange(0.0, DAY * min(prediction.days, 1.0), 30.0)
    longitude, latitude, height = geodetic_places(in_itrf(prediction.ephemeris, prediction.date, t))
    figure = screen_figure()
    axes = figure.add_subplot()
    draw_land(axes)
    axes.plot(*split_line(longitude, latitude), color=PREDICTED_COLOR, lw=0.8, label="ground track")
    axes.plot(longitude[:1], latitude[:1], "o", color=RESIDUAL, label="beginning")
    for place in places:
        x = (np.degrees(place.longitude) + 180.0) % 360.0 - 180.0
        axes.plot(x, np.degrees(place.latitude), "^", color=HIGHLIGHT, mec=TRUE_COLOR, ms=6, label=place.name)
    frame(axes)
    axes.set_xticks(np.arange(-180, 181, 60))
    note = f"24 h from {prediction.date} UTC, {height.mean() / _KILO:.0f} km high"
    legend(figure, columns=3, note=note)
    return figure


def expected_errors(prediction: PredictedOrbit) -> Figure:
    """Draw the expected error along the track by days ahead, past errors of the object, and SGP4's."""
    figure = screen_figure()
    axes = figure.add_subplot()
    past = prediction.past[prediction.past["lead"] <= prediction.days]
    lead = np.linspace(0.0, prediction.days, 100)
    sigmas = prediction.sigmas(DAY * lead)[:, 1]
    lines = {"this prediction": (sigmas, past["left"], 0.0, RESIDUAL)}
    if isinstance(prediction, Prediction):
        sgp4 = np.interp(lead, prediction.sizes.index, prediction.sizes["sgp4"])
        lines = {"SGP4": (sgp4, past["error"], -0.12, TRUE_COLOR)} | lines
    for sizes, errors, aside, color in lines.values():
        axes.plot(lead, sizes, color=color)
        axes.plot(past["lead"] + aside, errors.abs(), "o", color=color, ms=2.5, alpha=0.4)
    axes.set(xlabel="lead time [d]", ylabel="along-track error", yscale="log")
    axes.set_xlim(-0.2, prediction.days + 0.2)
    axes.yaxis.set_major_formatter(FuncFormatter(metres))
    ends = {name: float(line[0][-1]) for name, line in lines.items()}
    name_ends(axes, ends, {name: line[-1] for name, line in lines.items()})
    size = metres(rounded(float(sigmas[-1])))
    points = f"; points: {len(past)} past predictions, compared with what came later" if len(past) else ""
    note = f"lines: one sigma expected{points}"
    add_head(figure, f"After {prediction.days:g} d the expected along-track error is {size}", note)
    return figure
