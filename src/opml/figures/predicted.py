"""Figures of a prediction: the ground track of a day, and errors expected over its days."""

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
from opml.interop.predicted_orbit import PredictedOrbit

_KILO = 1e3


def ground_track(prediction: PredictedOrbit, places: list[Place]) -> Figure:
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


def expected_errors(prediction: PredictedOrbit) -> Figure:
    """Draw the expected error along the track by days ahead, and past errors of the object; SGP4's beside."""
    figure = page_figure(height_mm=75.0)
    axes = figure.add_subplot()
    past = prediction.past[prediction.past["lead"] <= prediction.days]
    lead = np.linspace(0.0, prediction.days, 100)
    marks: dict[str, Any] = {"ls": "", "marker": "o", "ms": 2.5, "alpha": 0.5}
    if isinstance(prediction, Prediction):
        sgp4 = np.interp(lead, prediction.sizes.index, prediction.sizes["sgp4"])
        axes.plot(past["lead"] - 0.12, past["error"].abs() / _KILO, color=MUTED, label="SGP4, past", **marks)
        axes.plot(lead, sgp4 / _KILO, color=TRUE_COLOR, label="SGP4, expected")
    axes.plot(past["lead"], past["left"].abs() / _KILO, color=RESIDUAL, label="this one, past", **marks)
    sigmas = prediction.sigmas(DAY * lead)[:, 1]
    axes.plot(lead, sigmas / _KILO, color=RESIDUAL, label="this one, expected")
    axes.set(xlabel="days ahead", ylabel="error along the track [km]", yscale="log")
    axes.set_xlim(-0.2, prediction.days + 0.2)
    legend(figure, columns=4, note="one sigma; points are single predictions, held against what came later")
    return figure
