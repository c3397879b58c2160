"""The performance metric on numbers that can be added in the head, and the tables around it."""

import numpy as np
import pandas as pd
import pytest

from opml.base.errors import InputError
from opml.learning.judge.evaluation import evaluate
from opml.learning.judge.metrics import (
    against_labels,
    bootstrap_interval,
    fraction_reduced,
    individual_p_ml,
    p_ml,
    summary,
)
from opml.tables import SCHEMAS, write_table

TRUE = np.array([10.0, -20.0, 30.0, -40.0])
PREDICTED = np.array([8.0, -25.0, 31.0, 10.0])  # residuals 2, 5, -1, -50


class Constant:
    """Stands in for a model: predicts the second variable it was given."""

    variables = ("cd_b", "d_a")

    def predict(self, x):
        return x[:, 1]


def test_p_ml_is_the_share_of_the_error_left():
    assert p_ml(TRUE, PREDICTED) == pytest.approx(100.0 * 58.0 / 100.0)
    assert p_ml(TRUE, TRUE) == 0.0
    assert p_ml(TRUE, 0.0 * TRUE) == 100.0
    assert p_ml(TRUE, -TRUE) == 200.0


@pytest.mark.parametrize("true", [[], [0.0, 0.0], [1.0, np.nan]])
def test_p_ml_wants_an_error_to_correct(true):
    with pytest.raises(InputError, match="P_ML"):
        p_ml(np.array(true), np.zeros(len(true)))


def test_individual_p_ml():
    assert individual_p_ml(TRUE, PREDICTED) == pytest.approx([20.0, 25.0, 100.0 / 30.0, 125.0])
    assert individual_p_ml(np.array([0.0, 0.0]), np.array([1.0, 0.0])).tolist() == [np.inf, 0.0]


def test_fraction_reduced_counts_strict_improvements():
    assert fraction_reduced(TRUE, PREDICTED) == 0.75
    assert fraction_reduced(TRUE, 0.0 * TRUE) == 0.0


def test_evaluation_and_its_summary(tmp_path):
    dataset = pd.DataFrame(
        {
            "i": [0, 0, 3, 4, 5],
            "j": [1, 2, 4, 5, 6],
            "duration": [1.0, 2.0, 3.0, 4.0, 5.0],
            "cd_b": 2.2,
            "d_a": [*PREDICTED, 0.0],
            "e_y": [*TRUE, 1e9],
        },
        index=[5, 4, 3, 2, 1],
    )
    rows = np.array([True, True, True, True, False])
    table = evaluate(Constant(), dataset, rows, component="e_y")
    assert table["residual"].tolist() == [2.0, 5.0, -1.0, -50.0]
    assert table[["i", "j", "duration"]].iloc[2].tolist() == [3, 4, 3.0]
    write_table(tmp_path / "evaluation.parquet", table, "evaluation", metadata={})

    names = {
        "rso": "iss",
        "stations": "eglin",
        "train": "random-80",
        "learner": "svr",
        "component": "e_y",
        "target": "iss_i50",
        "test": "rest",
    }
    row = summary(table, seed_noise=43, seed_split=42, kernel_scale=1.5, p_ml_later=57.0, **names)
    low, high = bootstrap_interval(table, seed=42)
    assert row.columns.tolist() == SCHEMAS["metrics"].names
    assert row.iloc[0].to_dict() == names | {
        "seed_noise": 43,
        "seed_split": 42,
        "kernel_scale": 1.5,
        "rows": 4,
        "estimates": 3,
        "p_ml": pytest.approx(58.0),
        "p_ml_low": low,
        "p_ml_high": high,
        "fraction_reduced": 0.75,
        "p_ml_later": 57.0,
        "last_before": 25.0,
        "last_after": 14.5,
    }
    write_table(tmp_path / "metrics.parquet", row, "metrics", metadata={})


def test_the_same_rows_against_labels():
    evaluation = pd.DataFrame({"i": [0, 0, 1], "j": [1, 2, 2], "predicted": [1.0, 2.0, 3.0]})
    labelled = pd.DataFrame(
        {
            "i": [0, 0, 1],
            "j": [1, 2, 2],
            "e_y": [2.0, 2.0, np.nan],
            "keep": [True, True, False],
            "t_known": 0.0,
        }
    )
    assert against_labels(evaluation, labelled, component="e_y") == 25.0
    assert np.isnan(against_labels(evaluation, labelled.drop(columns="t_known"), component="e_y"))
    assert np.isnan(against_labels(evaluation, labelled.assign(keep=False), component="e_y"))
