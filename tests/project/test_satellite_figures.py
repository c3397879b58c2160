"""Figures of real satellites: their numbers are those of the tables, said in words."""

import pytest
from matplotlib.text import Annotation
from mornings import replays

from opml.figures import line_ends
from validation.pictures import satellite_figures as figures


@pytest.fixture
def tables():
    """Rows without correction, and of a plain model and the choice of the past, half and a quarter of it."""
    flown = replays(days=20)
    shares = {figures.BEFORE: 50.0, figures.PAPER: 40.0, figures.PLAIN: 2.0, figures.CHOSEN: 1.0}
    return {label: flown.assign(e_y=share * flown["e_y"]) for label, share in shares.items()}


def words(figure):
    """Return all that a figure says about its lines."""
    return [text.get_text() for text in figure.findobj(Annotation)]


def test_the_title_and_the_ends_of_the_lines_tell_the_table_s_numbers(tables):
    figure = figures.headline("Swarm A", tables)
    size = figures.sizes(tables[figures.CHOSEN], figures.DAYS)["after_50"].iloc[-1]
    before, after = (figures.metres(figures._rounded(scale * size)) for scale in (50.0, 1.0))
    assert figure.get_suptitle() == f"Swarm A: {before} off after a week, {after} after correction"
    assert f"chosen by the past: {after}" in words(figure)
    assert [text.split(":")[0] for text in words(figure)] == list(tables)[::-1]


def test_satellites_stand_by_altitude_and_a_short_orbit_at_its_last_mark(tables):
    del tables[figures.PAPER]
    short = {label: table[table["duration"] < 2.2 * 86400.0] for label, table in tables.items()}
    figure = figures.overview({"high": short, "low": tables}, {"high": 5.8e6, "low": 0.43e6})
    figure.draw_without_rendering()
    day, week = ([tick.get_text() for tick in axes.get_xticklabels()] for axes in figure.axes)
    assert day == ["low\n430 km\nafter 1 d", "high\n5800 km\nafter 1 d"]
    assert week == ["low\n430 km\nafter 7 d", "high\n5800 km\nafter 2 d"]
    assert len(words(figure)) == 8


def test_names_of_near_lines_are_pushed_apart():
    places = line_ends.push_apart([100.0, 101.0, 1000.0], 0.1)
    assert places[1] / places[0] == pytest.approx(10.0**0.1)
    assert places[2] == pytest.approx(1000.0, rel=0.1)
