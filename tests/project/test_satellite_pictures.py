"""The pictures of real satellites have the numbers of the pages' tables."""

import pytest

from validation.pictures import real_satellites as pictures

SATELLITES = pictures.satellites()


def test_each_satellite_has_its_errors_and_its_number_of_predictions():
    assert {name: one.predictions for name, one in SATELLITES.items()} == {
        "Swarm A": 7200,
        "Larets": 8120,
        "Sentinel-3A": 558,
        "LAGEOS-2": 135,
    }
    assert all(set(one.errors) == set(pictures.LOOKS) for one in SATELLITES.values())
    assert SATELLITES["Swarm A"].errors[pictures.SELECTED][7.0] == (474.0, 2430.0)
    assert SATELLITES["LAGEOS-2"].errors[pictures.BEFORE] == {1.0: (59.7, 286.0), 2.0: (110.0, 544.0)}


def test_the_overview_draws_every_median():
    for axes, one in zip(pictures.overview(SATELLITES).axes, SATELLITES.values(), strict=True):
        drawn = {line.get_label(): list(line.get_ydata()) for line in axes.lines}
        assert drawn == {kind: [size for size, _ in e.values()] for kind, e in one.errors.items()}


def test_the_headline_on_learning_is_true_after_the_longest_lead_time():
    for one in SATELLITES.values():
        learned, selected = (
            list(one.errors[kind].values()) for kind in (pictures.LEARNED, pictures.SELECTED)
        )
        assert learned[-1][0] > selected[-1][0]


def test_hindsight_follows_the_corrections():
    figure = pictures.ladder(SATELLITES["Swarm A"], pictures.hindsight())
    labels = [label.get_text() for label in figure.axes[0].get_yticklabels()]
    assert labels[:3] == list(SATELLITES["Swarm A"].errors)
    assert labels[-1] == "hindsight: state, Cd of each week, weather"
    assert figure.get_suptitle().strip() == (
        "Swarm A after a week: 14 km by a 12-hour fit, 470 m by the model selected"
    )


def test_shares_inside_have_wilsons_interval():
    figure = pictures.ellipsoids(pictures.coverage())
    assert "contain 83 to 98 % of the errors, 75 to 93 % in a storm" in figure.get_suptitle()
    assert pictures.interval(50.0, 10.0) == pytest.approx((26.93, 73.07), abs=0.01)
