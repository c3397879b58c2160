"""The model that a morning selects: the best of the past, lately, and nothing from after it."""

import numpy as np
import pandas as pd
import pytest
from mornings import replays

from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.learning.data.splits import are_over
from opml.learning.judge.model_choice import best_model


@pytest.fixture(scope="module")
def errors():
    return replays(days=25)


def scaled(table, factor, *, since=0.0):
    """The same errors, so many times as large from a day on."""
    return table.assign(e_y=table["e_y"] * np.where(table["t_i"] >= since * DAY, factor, 1.0))


def best(now, /, **tables):
    """The best model by what is known at a day, of tables by model."""
    judged = pd.concat([table.assign(model=name) for name, table in tables.items()], ignore_index=True)
    return best_model(judged[are_over(judged, now * DAY)], list(tables), now=now * DAY)


def test_the_model_that_left_least_is_selected(errors):
    assert best(15.0, fit48=scaled(errors, 2.0), running=errors, fit96=scaled(errors, 1.1)) == "running"


def test_what_was_best_lately_is_selected(errors):
    tables = {"fit48": errors, "running": scaled(scaled(errors, 0.5), 6.0, since=12.0)}
    assert best(12.0, **tables) == "running"
    assert best(20.0, **tables) == "fit48"


def test_each_day_of_duration_has_the_same_weight(errors):
    """Metre by metre the long predictions would decide, which are few and large."""
    long = errors["duration"] > 6.0 * DAY
    early = errors.assign(e_y=errors["e_y"] * np.where(long, 1.7, 0.8))
    assert np.abs(early["e_y"]).sum() > np.abs(errors["e_y"]).sum()
    assert best(15.0, early=early, late=errors) == "early"


def test_predictions_that_one_model_lacks_count_for_none(errors):
    small = scaled(errors, 0.1, since=10.0)
    assert best(20.0, fit48=errors, running=scaled(small, 1.2)[small["t_i"] < 10.0 * DAY]) == "fit48"


def test_without_a_prediction_of_all_models_nothing_is_selected(errors):
    with pytest.raises(InputError, match=r"expected a prediction of all models .* by day 5, got none"):
        best(5.0, running=errors, fit48=errors[:0])
