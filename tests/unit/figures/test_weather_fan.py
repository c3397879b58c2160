"""The fan chart of one prediction."""

import numpy as np
import pandas as pd
import pytest

from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.figures import weather_fan

DAYS = np.array([1.0, 3.0, 5.0])
FANS = pd.DataFrame(
    {"i": 4, "j": [5, 6, 7], "duration": DAY * DAYS, "e_y": [-1e3, -9e3, -25e3]}
    | {"low": -2e3 * DAYS, "median": 0.0, "high": 3e3 * DAYS}
)
ENSEMBLE = pd.concat(FANS[["i", "j"]].assign(member=k, d_y=1e3 * k * DAYS) for k in (1, 2))


def test_chart_shows_each_future_their_band_and_the_true_error():
    axes = weather_fan.chart(FANS, ENSEMBLE, track=4, level=0.8).axes[0]
    first, second, median, true = axes.lines
    np.testing.assert_allclose(first.get_ydata(), [0.0, *-DAYS])
    np.testing.assert_allclose(second.get_ydata(), [0.0, *(-2.0 * DAYS)])
    np.testing.assert_allclose(true.get_ydata(), [0.0, -1.0, -9.0, -25.0])
    np.testing.assert_allclose(median.get_xdata(), [0.0, *DAYS])
    assert axes.get_legend_handles_labels()[1] == ["80 % of the futures", "their median", "true error"]


def test_a_track_without_predictions_is_told():
    with pytest.raises(InputError, match=r"fan: expected the track of an estimate .*, got 3"):
        weather_fan.chart(FANS, ENSEMBLE, track=3, level=0.8)
