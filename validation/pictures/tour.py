"""The picture of docs/index.md: Hubble's prediction, its passes over a station, and a conjunction.

    python -m validation.pictures.tour SETS WEATHER CDM

SETS are Hubble's element sets of 2023, WEATHER is a CSSI file, CDM is a message of NASA's CARA about it.
"""

import sys

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Ellipse
from matplotlib.ticker import FuncFormatter

from opml.conjunctions import cdm
from opml.conjunctions.conjunction import Conjunction
from opml.conjunctions.probability import in_plane
from opml.element_sets import prediction, station_passes
from opml.figures import style
from opml.figures.ticks import metres
from opml.interop.ephemeris import EPOCH
from validation.pictures import shrunk

DATE, STATION = "2023-04-30T06:00:00", "28.5,-80.6,3"
_SIGMAS = {
    "sgp4_along_track": ("SGP4, along-track", style.PREDICTED_COLOR),
    "along_track": ("opml, along-track", style.RESIDUAL),
    "cross_track": ("opml, cross-track", style.OBSERVED_COLOR),
    "radial": ("opml, radial", style.ESTIMATE),
}


def tour(expected: pd.DataFrame, passes: pd.DataFrame, conjunction: Conjunction) -> Figure:
    """Draw sigmas by days ahead, seconds early or late by pass, and the plane of an encounter.

    expected, passes: tables `expected_errors` and `passes`
    """
    figure = style.page_figure(height_mm=72.0)
    sigmas, late, plane = figure.subplots(1, 3)
    for name, (label, color) in _SIGMAS.items():
        sigmas.plot(expected["lead"], expected[name], color=color, marker="o", ms=3.0, label=label)
    sigmas.set(yscale="log", xlabel="days ahead", ylim=(5.0, None))
    sigmas.yaxis.set_major_formatter(FuncFormatter(metres))
    sigmas.set_title("expected errors, one sigma", loc="left", fontsize=8.0)
    sigmas.legend(fontsize=style.NOTE_SIZE, loc="center right", bbox_to_anchor=(1.0, 0.53))
    days = (pd.to_datetime(passes["highest"]) - pd.Timestamp(DATE)) / pd.Timedelta(days=1)
    late.plot(days, passes["early_or_late"], ls="", marker="o", ms=3.0, color=style.RESIDUAL)
    late.set(xlabel="days ahead", ylim=(0.0, None))
    late.set_title("passes early or late by up to [s], 90 %", loc="left", fontsize=8.0)
    _plane(plane, conjunction)
    headline = "Hubble: where it will be, when it passes, and how near a rocket body comes"
    note = (
        f"left, middle: from sets of {DATE[:10]}, {len(passes)} passes over Cape Canaveral; right: a "
        "Diamant rocket body on 2023-06-13, the plane across the relative velocity, 1 to 3 sigma"
    )
    style.add_head(figure, headline, note)
    return figure


def _plane(axes: Axes, conjunction: Conjunction) -> None:
    miss, covariance = in_plane(conjunction.likeliest)
    variances, directions = np.linalg.eigh(covariance)
    angle = np.degrees(np.arctan2(*directions[::-1, 1]))
    widths = 2.0 * np.sqrt(variances[::-1]) / 1e3
    for sigma in (1, 2, 3):
        axes.add_patch(
            Ellipse(miss / 1e3, *(sigma * widths), angle=angle, color=style.RESIDUAL, alpha=0.2, lw=0)
        )
    axes.plot(*(miss / 1e3), marker="D", color=style.RESIDUAL, ls="", ms=4.0)
    axes.plot(0.0, 0.0, marker="o", color=style.TRUE_COLOR, ls="", ms=4.0)
    axes.annotate(
        "Hubble", (0.0, 0.0), xytext=(4.0, 4.0), textcoords="offset points", fontsize=style.NOTE_SIZE
    )
    axes.set(xlabel="distance [km]", ylabel="distance [km]")
    axes.autoscale_view()
    probability = conjunction.chance.probability
    axes.set_title(f"probability of a collision {probability:.1e}", loc="left", fontsize=8.0)


def main(sets: str, weather: str, message: str) -> None:
    """Draw the picture and shrink it."""
    predicted = prediction.predict([sets], date=DATE, weather=weather)
    passes = station_passes.passes(predicted.ephemeris, predicted.date, station_passes.place(STATION))
    (conjunction,) = cdm.read(message, epoch=EPOCH)
    shrunk.save(tour(predicted.expected(), passes, conjunction), "tour")


if __name__ == "__main__":
    main(*sys.argv[1:])
