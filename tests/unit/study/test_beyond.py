"""Beyond the paper: which experiments are run, the document that tells them, and their figures."""

import re
from dataclasses import replace

import pandas as pd
import pytest
from support import paper_values, study_of

from opml.figures import beyond as figures
from opml.learning.models import fixed_laws, learners
from opml.report import beyond as report
from opml.report import document
from opml.study.beyond import Beyond
from opml.study.paper import Paper


def beyond_of(values):
    return Beyond(Paper(study_of(values)))


PAPER = beyond_of(paper_values())
ENTRY = PAPER.entry


@pytest.fixture
def values():
    values = paper_values()
    values["study"]["curves"]["semi_major_axis"]["values"] = [0, 50]
    return values


def metrics(found):
    """P_ML that tells experiments apart: 10 more for each letter of the learner's name."""
    rows = []
    for one in found:
        names = one.columns()
        p_ml = 10.0 * len(one.learner)
        numbers = {"rows": 100, "estimates": 7, "p_ml": p_ml, "p_ml_low": p_ml - 1.0, "p_ml_high": p_ml + 2.0}
        rows.append(names | numbers | {"fraction_reduced": 0.5})
    return pd.DataFrame(rows)


def test_every_model_meets_every_split():
    found = PAPER.splits
    assert len(found) == 2 * len(ENTRY["learners"]) * 4
    one = found["eglin", "mechanism", "unseen"]
    assert (one.train, one.test) == ("days-0-30", "days-30-40-unseen")
    assert (one.rso, one.target, one.learner) == ("iss", "iss", "mechanism")


@pytest.mark.parametrize(
    ("stations", "split", "number"),
    [
        ("eglin", "random", 22.6),
        ("eglin-clear-kaena", "random", 9.6),
        ("eglin-clear-kaena", "future", 35.5),
        ("eglin-clear-kaena", "unseen", None),
        ("eglin", "future", None),
    ],
)
def test_the_papers_number_stands_beside_every_learner(stations, split, number):
    for learner in ("svr", "mechanism"):
        assert PAPER.paper.published_p_ml(PAPER.splits[stations, learner, split]) == number


def test_the_papers_transfers():
    found = PAPER.transfers
    assert PAPER.paper.published_p_ml(found["inclination", "svr", "iss_i50"]) == 40.2
    assert PAPER.paper.published_p_ml(found["semi_major_axis", "svr", "iss_a+50"]) == 86.0
    assert PAPER.paper.published_p_ml(found["semi_major_axis", "svr", "iss_a+60"]) is None


def test_document_tells_every_model_and_split(values):
    beyond = beyond_of(values)
    blocks = report.document(beyond.report, metrics(beyond.every))
    text = document.markdown(blocks)
    assert "| `mechanism` | 90.0 (89.0 to 92.0) | 90.0 (89.0 to 92.0)" in text
    assert "| Peng & Bai, SVR | 9.6 | - | 35.5 | - |" in text
    assert "random: random-80, rest (7 estimates)" in text
    assert "| `iss_i50` | 40.2 | 30.0 (29.0 to 32.0) |" in text
    assert not re.search(r"\bnan\b", text)


def test_a_kind_of_learner_that_was_added_is_described(values, monkeypatch):
    oracle = replace(fixed_laws.NONE, kind="oracle", description="what the truth says")
    monkeypatch.setattr(learners, "LEARNERS", (*learners.LEARNERS, oracle))
    values["learners"]["seer"] = {"kind": "oracle"}
    values["study"]["beyond"]["learners"] = ["none", "seer"]
    beyond = beyond_of(values)
    blocks = report.document(beyond.report, metrics(beyond.every))
    assert "| `seer` | what the truth says | - |" in document.markdown(blocks)


def test_figure_of_splits_shows_every_model_and_the_paper():
    found = PAPER.splits
    table = metrics(found.values()).assign(split=[key[2] for key in found])
    figure = figures.splits(
        table,
        panels=ENTRY["station_sets"],
        models=dict.fromkeys(ENTRY["learners"], "a model"),
        splits=list(ENTRY["splits"]),
        published={("eglin", "random"): 22.6},
        component="e_y",
    )
    left, right = figure.axes
    assert [label.get_text() for label in left.get_yticklabels()] == ENTRY["learners"]
    assert sum("Peng & Bai" in line.get_label() for line in left.lines) == 1
    assert sum("Peng & Bai" in line.get_label() for line in right.lines) == 0
    assert "P_" in figure.get_supxlabel()
    flattered = table.assign(p_ml=table["p_ml"].where(table["split"] != "random", 1.0))
    headline = figures._flattered(flattered[flattered["stations"] == "eglin"], list(ENTRY["splits"]))
    assert headline.endswith("= 1 % on random rows, 110 % on unseen rows")
