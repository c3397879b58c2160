"""Figures of a prediction from element sets: the ground track of a day, and errors expected over its days."""

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from opml.base.constants import DAY
from opml.element_sets.passes import Place, in_itrf
from opml.element_sets.prediction import Prediction
from opml.figures.ground import draw_land, frame, geodetic_places, split_line
from opml.figures.style import (
    HIGHLIGHT,
    MUTED,
    PREDICTED_COLOR,
    RESIDUAL,
    TRUE_COLOR,
    legend,
    page_figure,
)

_KILO = 1e3


def ground_track(prediction: Prediction, places: list[Place]) -> Figure:
    """Draw where the object passes over the Earth on the first day, and the places that look at it."""
    t = np.arange(0.0, DAY * min(prediction.days, 1.0), 30.0)
    longitude, latitude, height = geodetic_places(in_itrf(prediction, t))
    figure = page_figure(height_mm=100.0)
    axes = figure.add_subplot()
    draw_land(axes)
    axes.plot(*split_line(longitude, latitude), color=PREDICTED_COLOR, lw=0.8, label="ground track")
    axes.plot(longitude[:1], latitude[:1], "o", color=RESIDUAL, label="beginning")
    for place in places:
        x = (np.degrees(place.longitude) + 180.0) % 360.0 - 180.0
        axes.plot(x, np.degrees(place.latitude), "^", color=HIGHLIGHT, mec="white", label=place.name)
    frame(axes)
    note = f"24 h from {prediction.date} UTC, {height.mean() / _KILO:.0f} km high"
    legend(figure, columns=4, note=note)
    return figure


def expected_errors(prediction: Prediction) -> Figure:
    """Draw the expected error along the track by days ahead, SGP4's, and past errors of the object."""
    figure = page_figure(height_mm=75.0)
    axes = figure.add_subplot()
    sizes, past = prediction.sizes, prediction.past
    past = past[past["lead"] <= prediction.days]
    before, after = past["lead"] - 0.06, past["lead"] + 0.06
    marks: dict[str, Any] = {"ls": "", "marker": "o", "ms": 2.5, "alpha": 0.5}
    axes.plot(before, past["error"].abs() / _KILO, color=MUTED, label="SGP4, past mornings", **marks)
    axes.plot(after, past["left"].abs() / _KILO, color=RESIDUAL, label="as improved, past mornings", **marks)
    lead = np.linspace(0.0, prediction.days, 100)
    for name, color, label in (("sgp4", TRUE_COLOR, "SGP4, expected"), ("s", RESIDUAL, "this one, expected")):
        axes.plot(lead, np.interp(lead, sizes.index, sizes[name]) / _KILO, color=color, label=label)
    axes.set(xlabel="days ahead", ylabel="error along the track [km]", yscale="log")
    axes.set_xlim(-0.2, prediction.days + 0.2)
    legend(figure, columns=4, note="one sigma; points are single predictions, held against later sets")
    return figure
