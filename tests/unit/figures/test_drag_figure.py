"""Figures of Cd beside the solar activity, and of errors by the day that a prediction starts on."""

import numpy as np
import pandas as pd
import pytest

from opml.base.errors import InputError
from opml.figures import own_study as figures

EPOCH = "2019-09-03T00:00:00"

DAY = 86400.0


def test_errors_by_the_day_that_a_prediction_starts_on():
    rows = [(day, lasts, 100.0 * day * k) for day in (1, 2) for lasts in (0.9, 4.0) for k in (1, 2, 3)]
    table = pd.DataFrame(rows, columns=["day", "duration", "e_y"]).assign(keep=True)
    table["t_i"], table["duration"] = (table["day"] + 0.3) * DAY, table["duration"] * DAY
    dropped = table.assign(keep=False, e_y=1e9)
    found = figures.daily_errors(pd.concat([table, dropped]), component="e_y", day=1.0)
    assert (found["t"] / DAY).tolist() == [1.5, 2.5]
    assert found["50"].tolist() == [200.0, 400.0]
    assert found["25"].tolist() == [150.0, 300.0]
    assert figures.daily_errors(table, component="e_y", day=7.0).empty


def test_figure_of_drag_shows_every_window_and_the_weather():
    t = np.arange(0.0, 5.0, 0.1) * DAY
    table = pd.DataFrame({"t": t, "cd": 2.2 + 0.1 * np.sin(t / DAY), "converged": t > 0.0})
    weather = pd.DataFrame({"t": t, "f107": 70.0, "f107_mean": 72.0, "kp_3h": 1.0})
    usable = {"12-hour fits": table, "48-hour fits": table.assign(cd=2.2)}
    figure = figures.drag_figure(usable, weather, epoch=EPOCH, manoeuvres=[2.5 * DAY])
    cd, flux, kp = figure.axes
    assert [text.get_text() for text in cd.get_legend().get_texts()] == [*usable, "manoeuvre"]
    assert all(axes.lines[-1].get_xdata() == [2.5, 2.5] for axes in figure.axes)
    assert len(cd.lines[0].get_xdata()) == len(t) - 1  # what did not converge is left out
    assert "sfu" in flux.get_ylabel()
    assert kp.get_xlabel() == "time [d], since 2019-09-03 00:00 UTC"
    assert kp.xaxis.get_major_formatter()(5.0) == "5\n8 Sep"
    daily = pd.DataFrame({"t": [DAY, 2 * DAY], "25": 1.0, "50": [2.0, 4.0], "75": 8.0, "day": 1.0})
    *_, last = figures.drag_figure({"12-hour fits": table}, weather, daily, epoch=EPOCH, note="lares").axes
    assert last.lines[0].get_label() == "after 1 d"
    assert last.lines[0].get_ydata().tolist() == [2.0, 4.0]
    assert last.get_xlabel() == kp.get_xlabel()
    lost = table.assign(converged=False, weighted_rms=2.0)
    with pytest.raises(InputError, match=r"expected an estimate that converged, got none of \d+$"):
        figures.drag_figure({"12-hour fits": lost}, weather, epoch=EPOCH)


def test_estimates_of_drag_beyond_the_axis_are_marked_and_counted():
    t = np.arange(100) * 0.1 * DAY
    cd = np.where(np.arange(100) == 50, -180.0, 2.0 + 0.001 * np.arange(100))
    table = pd.DataFrame({"t": t, "cd": cd, "converged": True})
    weather = pd.DataFrame({"t": t, "f107": 70.0, "f107_mean": 72.0, "kp_3h": 1.0})
    axes, *_ = figures.drag_figure({"12-hour fits": table}, weather, epoch=EPOCH).axes
    _, below, above = axes.lines
    assert below.get_xdata().tolist() == [5.0]
    assert below.get_ydata().tolist() == [axes.get_ylim()[0]]
    assert len(above.get_xdata()) == 0
    assert axes.get_title(loc="right").startswith("1 of 100 estimates lie beyond the axis")
