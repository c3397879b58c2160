"""The figure and the report's section on conjunctions."""

import pandas as pd
from support import refusal

from opml.figures import alarms
from opml.report import conjunctions as section
from opml.report.document import Paragraph, Table
from opml.report.results import NO_VALUE

TABLE = pd.DataFrame(
    {
        "model": ["none", "none", "none", "selected each day"],
        "covariance": ["the fit's own", "of past errors", "of past errors", "of past errors"],
        "weather": "forecast",
        "crossing": "any",
        "day": [1.0, 1.0, 3.0, 1.0],
        "flagged": [0.5, 0.9, 0.8, 1.0],
        "alarms": [500.0, 400.0, 3000.0, 31.8],
        "per_approach": [0.2, 0.16, 1.2, 0.01272],
        "predictions": 9,
    }
)


def test_each_model_and_covariance_has_a_line_in_both_panels():
    figure = alarms.by_duration(TABLE, note="a note")
    raised, flagged = figure.axes[:2]
    assert [line.get_label() for line in raised.get_lines()] == [
        "no correction, covariance the fit's own",
        "no correction, covariance of past errors",
        "selected each day, covariance of past errors",
    ]
    assert "32 alarms per collision after 1 d" in figure.get_suptitle()
    assert flagged.get_lines()[1].get_ydata().tolist() == [90.0, 80.0]
    assert raised.get_yscale() == "log"
    assert len({line.get_color() for line in raised.get_lines()}) == 3


def test_nothing_to_draw_is_told():
    assert "conjunctions: expected predictions" in refusal(alarms.by_duration, TABLE.iloc[:0])


def test_the_section_states_alarms_and_collisions():
    blocks = list(section.section({("swarm", "eglin"): TABLE}, {"radius_m": 20.0, "threshold": 1e-4}))
    (table,) = (block for block in blocks if isinstance(block, Table))
    assert table.header == ["model", "covariance", "weather", "angle [deg]", "1 d", "3 d"]
    assert table.rows[1] == [
        "no correction",
        "of past errors",
        "forecast",
        "any",
        "400 / 0.16 / 90",
        "3000 / 1.2 / 80",
    ]
    assert table.rows[2] == [
        "selected each day",
        "of past errors",
        "forecast",
        "any",
        "32 / 0.013 / 100",
        NO_VALUE,
    ]
    assert any("a sum of radii of 20 m" in block.text for block in blocks if isinstance(block, Paragraph))
    assert list(section.section({}, {})) == []
