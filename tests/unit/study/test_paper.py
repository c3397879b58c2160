"""Experiments: what the settings ask for, as names."""

import pytest
from support import paper_values, study_of

from opml.naming import Experiment
from opml.report.sections import section_of
from opml.study.paper import Paper

PAPER = Paper(study_of(paper_values()))
OWN = Experiment("iss", "eglin", "random-80", "svr", "e_y", "iss", "rest")


@pytest.fixture
def values():
    return paper_values()


def test_entry_takes_the_defaults(values):
    values["study"]["evaluations"] = {"mine": {"train": "random-80", "test": "rest"}}
    assert Paper(study_of(values)).evaluations == {
        "mine": Experiment("iss", "eglin-clear-kaena", "random-80", "svr", "e_y", "iss", "rest")
    }


def test_entry_of_another_rso_is_tested_on_itself(values):
    values["study"]["evaluations"] = {"mine": {"rso": "lares", "train": "random-80", "test": "rest"}}
    assert Paper(study_of(values)).evaluations["mine"].target == "lares"


def test_sections_are_the_papers():
    found = {name: section_of(one)[0] for name, one in PAPER.evaluations.items()}
    assert found == {
        "svr_training_1station": "4",
        "svr_testing_1station": "4",
        "svr_testing_3stations": "4",
        "future_5days": "5",
        "future_10days": "5",
        "future_10days_unfenced": "5",
        "future_15days": "5",
        "inclination_50": "6",
        "semi_major_axis_50": "6",
    }


def test_headlines_are_the_papers_numbers_in_its_order():
    assert {one.name: one.published for one in PAPER.headlines} == {
        "svr_training_1station": 18.3,
        "svr_testing_1station": 22.6,
        "svr_testing_3stations": 9.6,
        "partition_40": 14.8,
        "partition_90": 9.7,
        "future_10days": 35.5,
        "inclination_50": 40.2,
        "semi_major_axis_50": 86.0,
    }
    assert [section_of(one.experiment)[0] for one in PAPER.headlines] == list("44444566")


def test_curves_name_the_training_rso_once():
    assert PAPER.curves["inclination"].targets == {
        "iss_i48": 48,
        "iss_i50": 50,
        "iss": 51.6393,
        "iss_i52": 52,
        "iss_i54": 54,
    }
    assert list(PAPER.curves["semi_major_axis"].targets) == [
        "iss",
        *(f"iss_a+{km}" for km in range(10, 101, 10)),
    ]
    assert len(PAPER.curves["inclination"].experiments) == 10


def test_spread_over_noise_is_not_asked_of_a_transfer():
    assert len(PAPER.study.noise_spread(OWN)) == 5
    transfer = PAPER.evaluations["inclination_50"]
    assert PAPER.study.noise_spread(transfer) == []
    assert len(PAPER.study.split_spread(transfer)) == 5


@pytest.mark.parametrize(
    ("name", "part", "random", "future"),
    [
        ("previous_track", "reading", "_track", "_track"),
        ("without_cd", "learner", "svrnocd", "svrnocd"),
        ("unseen_windows", "test", None, "days-30-40-unseen"),
        ("grouped_split", "train", "grouped-80", None),
    ],
)
def test_reading_changes_one_part_or_nothing(name, part, random, future):
    for key, expected in (("svr_testing_1station", random), ("future_10days", future)):
        own = PAPER.evaluations[key]
        text = PAPER.study.entry("reproduction")["readings"][name]["text"]
        read = PAPER.readings[text].get(key)
        if expected is None:
            assert read is None
        else:
            assert read.names() == own.names() | {part: expected}


def test_reading_that_is_the_settings_own_is_none(values):
    values["study"]["cleaning"]["previous"] = "track"
    paper = Paper(study_of(values))
    assert paper.readings["t_b is the track just before, or none"] == {}


def test_reported_are_all_and_each_once():
    found = PAPER.reported
    assert len(found) == len(set(found))
    for one in (
        *PAPER.partitions,
        *PAPER.grids["rso"].values(),
        *PAPER.curves["semi_major_axis"].experiments,
    ):
        assert one in found
