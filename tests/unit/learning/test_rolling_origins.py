"""Learners trained anew: on what, when, and what they are tested on."""

import numpy as np
import pandas as pd
import pytest

from opml.base.errors import InputError
from opml.learning.judge.rolling_origins import Rolling, by_day, roll

DAY = 86400.0


class Seen:
    """Predicts the newest error that it was trained on."""

    variables = ("duration",)

    def __init__(self, rows):
        self.newest = rows["e_y"].max()

    def predict(self, x):
        return np.full(len(x), self.newest)


@pytest.fixture
def table():
    """Predictions of two hours, one each hour of twelve days; an error is its own t_j in days."""
    t_i = 3600.0 * np.arange(1, 12 * 24 + 1)
    table = pd.DataFrame({"i": np.arange(len(t_i)), "t_i": t_i, "t_j": t_i + 7200.0, "duration": 7200.0})
    return table.assign(j=table["i"] + 2, e_y=table["t_j"] / DAY, keep=table["i"] % 7 != 3)


def test_a_model_knows_what_is_known_when_it_is_trained_and_no_more(table):
    late = table.assign(t_known=table["t_j"] + 0.5 * DAY)
    for learned, behind in ((table, 0.0), (late, 0.5)):
        found = roll(Seen, learned, table, Rolling((6.0, 9.0), 1.0, 3.0), component="e_y")
        newest = found.groupby("day")["predicted"].max()
        assert newest.index.tolist() == [6.0, 7.0, 8.0]
        assert (newest <= newest.index - behind).all()
        assert (newest > newest.index - behind - 0.1).all()
        assert found["predicted_once"].unique() == [found.loc[0, "predicted"]]
        assert found["trained"].max() <= 3 * 24


def test_a_day_is_tested_on_the_predictions_that_start_in_it(table):
    found = roll(Seen, table, table, Rolling((6.0, 9.0), 2.0, 3.0), component="e_y")
    t_i = found["i"].map(table.set_index("i")["t_i"]) / DAY
    assert found["day"].unique().tolist() == [6.0, 8.0]
    assert ((t_i > found["day"]) & (t_i <= np.minimum(found["day"] + 2.0, 9.0))).all()
    kept = table["keep"] & (table["t_i"] > 6 * DAY) & (table["t_i"] <= 9 * DAY)
    assert sorted(found["i"]) == table.loc[kept, "i"].tolist()


def test_the_truth_judges_where_labels_are_learned_from(table):
    found = roll(
        Seen, table.assign(e_y=100.0), table, Rolling((6.0, 7.0), 1.0, 3.0), component="e_y"
    )  # fmt: skip
    assert found["predicted"].unique().tolist() == [100.0]
    assert found["true"].max() < 10.0


def test_p_ml_by_day():
    table = pd.DataFrame(
        {
            "day": [1.0, 1.0, 2.0],
            "true": [10.0, -10.0, 5.0],
            "predicted": [9.0, -10.0, 5.0],
            "predicted_once": [0.0, 0.0, 10.0],
        }
    )
    assert by_day(table).to_dict("list") == {
        "day": [1.0, 2.0],
        "rows": [2, 1],
        "anew": [5.0, 0.0],
        "once": [100.0, 100.0],
    }


def test_nothing_known_and_nothing_to_test_are_told(table):
    with pytest.raises(InputError, match="known by day 0"):
        roll(Seen, table, table, Rolling((0.0, 3.0), 1.0, 3.0), component="e_y")
    with pytest.raises(InputError, match="from days 20 to 21"):
        roll(Seen, table, table, Rolling((20.0, 21.0), 1.0, 30.0), component="e_y")
