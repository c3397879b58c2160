"""The scan: combinations of readings, what they ask for, and how near they come to the paper."""

import math

import pandas as pd
import pytest
from support import REPOSITORY, paper_values, study_of

from opml.readings import scan_figure as figures
from opml.readings import scan_report
from opml.readings.scan import scan as scanned
from opml.readings.scan_report import Combination
from opml.report import document
from opml.study.checks import load_settings
from opml.study.experiments import Study
from opml.study.paper import Paper
from opml.study.settings.merging import merged

AXES = {
    "learners": ["svr", "svr_s5.6"],
    "estimations": [{}, {"convergence": 1}],
    "fences": ["dataset", "none"],
    "standardisations": ["training", "own"],
}


@pytest.fixture(scope="module")
def asked():
    values = paper_values()
    values["study"]["scan"] = {"all": AXES, "again": {"learners": ["svr"]}}
    return scanned(Paper(study_of(values)))


def metrics(asked, p_ml):
    rest = {"rows": 9, "estimates": 5, "fraction_reduced": 0.8, "last_before": 45e3, "last_after": 1e4}
    return pd.DataFrame([one.columns() | rest | {"p_ml": p_ml(one)} for one in asked.experiments])


def test_combinations_are_the_product_of_the_axes(asked):
    assert len(asked.combinations) == len(set(map(str, asked.combinations))) == 16
    assert str(asked.combinations[0]) == "svr"
    assert "svr_s5.6_tol1-unfenced-zscore" in map(str, asked.combinations)


def test_products_of_axes_stand_one_after_the_other():
    values = paper_values()
    values["study"]["scan"] = {
        "together": {"learners": ["svr_s2"], "standardisations": ["together"]},
        "light": {"learners": ["svr"], "estimations": [{"cd_sigma": 1, "light_time": True}]},
    }
    found = scanned(Paper(study_of(values)))
    assert list(map(str, found.combinations)) == ["svr", "svr_s2-together", "svr_cd1_light"]


def test_a_study_without_a_scan_has_none():
    assert not scanned(Paper(study_of(paper_values()))).combinations


def test_a_combination_is_a_part_of_every_name(asked):
    one = Combination("svr_s2", window="_tol1", reading="_track", fence=math.inf, standardisation="own")
    future, _ = asked.numbers["future_10days"]
    assert one.applied_to(future).path("metrics") == (
        "metrics/iss/eglin-clear-kaena_tol1_track/days-0-30/svr_s2/e_y/iss/days-30-40-unfenced-zscore.parquet"
    )
    rest, _ = asked.numbers["svr_testing_1station"]
    assert one.applied_to(rest).test == "rest-zscore"  # its training rows have the dataset's fences


def test_the_default_combination_changes_nothing(asked):
    for experiment, _ in asked.numbers.values():
        assert asked.combinations[0].applied_to(experiment) == experiment


def test_the_nearest_comes_first(asked):
    published = {experiment.path(""): number for experiment, number in asked.numbers.values()}

    def p_ml(one):
        """The paper's own numbers, five points off but for one combination, which is one point off."""
        number = published.get(Combination("svr").applied_to(one).path("").replace("-unfenced", ""), 50.0)
        return number + (1.0 if one.learner == "svr_s5.6" and not one.window else 5.0)

    found = scan_report.outcomes(asked, metrics(asked, p_ml))
    assert len(found) == 16
    assert found[0].combination.learner == "svr_s5.6"
    assert found[0].distance == pytest.approx(1.0)
    assert (found[0].near, found[-1].near) == (8, 0)
    assert len(found[0].held) == 10
    text = document.markdown(scan_report.document(asked, metrics(asked, p_ml)))
    assert "| the paper |  |  |  |  | 18.3 | 22.6 |" in text
    assert "| `svr_s5.6` | 1.0 | 8 |" in text


@pytest.fixture(scope="module")
def drawn(asked):
    published = {"one": 20.0, "other": 40.0}
    experiments = {
        "one": asked.numbers["svr_training_1station"][0],
        "other": asked.numbers["inclination_50"][0],
    }
    found = {
        "near": {"one": 21.0, "other": 44.0},
        "svr": {"one": 50.0, "other": 90.0},
        "far": {"one": 25.0, "other": 300.0},
    }
    return figures.scan_dots(found, published, experiments, default="svr").axes[0]


def test_the_figure_has_dots_for_each_that_no_line_joins_and_the_papers_marks(drawn):
    heights = [line.get_ydata()[0] for line in drawn.lines if line.get_label() != "_beyond"]
    assert heights == [21.0, 50.0, 25.0, 20.0]
    assert {line.get_linestyle() for line in drawn.lines} == {"None"}
    labels = drawn.get_legend_handles_labels()[1]
    assert labels == ["nearest in the mean: near", "default: the paper's SVR", "Peng & Bai"]
    ticks = [tick.get_text() for tick in drawn.get_xticklabels()]
    assert ticks == ["one radar\n80 %,\nthe same rows", "i = 50 deg\ndays 0 to 30,\ndays 30 to 40"]


def test_what_is_beyond_the_axis_is_marked_at_its_end(drawn):
    beyond = [line for line in drawn.lines if line.get_label() == "_beyond" and len(line.get_xdata())]
    assert [(line.get_marker(), list(line.get_ydata())) for line in beyond] == [("^", [130.0])]
    assert round(beyond[0].get_xdata()[0]) == 1


def test_the_scan_that_comes_with_the_settings_is_one():
    source = merged([f"{REPOSITORY}/config/config.yaml", f"{REPOSITORY}/config/scan.yaml"], {})
    found = scanned(Paper(Study(load_settings(source))))
    names = [*map(str, found.combinations)]
    assert len(names) == 27
    assert "svrnoplane10_cd1-zscore" in names
    assert names[-3:] == ["svr-together", "svrnoplane50_cd1-together", "svr_light"]
