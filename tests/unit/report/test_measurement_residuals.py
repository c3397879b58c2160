"""What a study's report tells of the measurements: residuals by instrument, tracks held back, burns."""

import numpy as np
import pandas as pd
from support import EPOCH

from opml.base.constants import DAY
from opml.catalog.fit.biases import summary
from opml.report import document, measurement_residuals
from opml.tables import BURN

KEY = ("mine", "ranges")


def told(noise, estimates):
    """The section, as Markdown."""
    return document.markdown(list(measurement_residuals.section({KEY: noise}, {KEY: estimates}, epoch=EPOCH)))


def watched(burns=()):
    """Estimates at midnights of which the second was held back; burns: by track."""
    table = pd.DataFrame({"t": DAY * np.arange(4.0), "held_back": [False, True, False, False]})
    table[BURN] = np.nan
    for track, burn in burns:
        table.loc[track, BURN] = burn
    return table


def test_residuals_stand_in_the_units_of_their_instruments():
    names = ["7090 range", "eglin range", "eglin azimuth", "eglin range_rate", "radial rate"]
    sigmas = np.array([0.02, 50.0, np.radians(0.02), 0.5, 0.01])
    text = told(summary(np.array(names), np.array([-2.0, 1.0, 0.5, 3.0, 0.1]), sigmas), watched()[["t"]])
    assert text.startswith("## Measurement residuals\n")
    for row in (
        "| mine | ranges | 7090 range | 1 | 2 cm | 4 cm | -4 cm | 2.00 |",
        "| mine | ranges | eglin range | 1 | 50 m | 50 m | 50 m | 1.00 |",
        "| mine | ranges | eglin azimuth | 1 | 0.02 deg | 0.01 deg | 0.01 deg | 0.50 |",
        "| mine | ranges | eglin range_rate | 1 | 0.5 m/s | 1.5 m/s | 1.5 m/s | 3.00 |",
        "| mine | ranges | radial rate | 1 | 0.01 m/s | 0.001 m/s | 0.001 m/s | 0.10 |",
    ):
        assert row in text
    assert "held" not in text


def test_tracks_held_back_and_burns_are_named():
    burns = [(2, [1.5 * DAY, 0.0, 0.0512, -0.001]), (3, [2.5 * DAY, *[np.nan] * 3])]
    text = told(pd.DataFrame(), watched(burns))
    assert (
        "**mine, ranges.** `estimation.suspect_sigma` held 1 of 4 tracks back when they came: on day 1.0."
        in text
    )
    assert "| mine | ranges | 2016-09-30T00:09 | 2016-09-30T12:09 | +0.0000 | +0.0512 | -0.0010 |" in text
    assert "| mine | ranges | 2016-10-01T00:09 | 2016-10-01T12:09 | - | - | - |" in text
    assert "Residuals" not in text
    calm = told(pd.DataFrame(), watched().assign(held_back=False))
    assert "held 0 of 4 tracks back when they came." in calm
    assert "Burns" not in calm


def test_what_was_simulated_and_not_watched_has_no_section():
    assert told(pd.DataFrame(), watched()[["t"]]).strip() == ""
