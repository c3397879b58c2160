"""How much each way to improve a set counts, by what it left of the object's own predictions."""

import numpy as np
import pandas as pd
import pytest

from opml.element_sets import weighting
from opml.element_sets.set_errors import LEADS

MORNINGS = 20
SCALE = 100.0


def rows(numbers, errors):
    """Rows of MORNINGS of objects, each with an error [m], NaN where none is judged."""
    found = [
        {"number": number, "morning": 60000.25 + k, "lead": lead, "error": error}
        for number, error in zip(numbers, errors, strict=True)
        for k in range(MORNINGS)
        for lead in LEADS
    ]
    fixed = {"band": 3, "scale": SCALE, "is_fit": True, "tau": 1.0, "response": 1.0, "missed": 0.0}
    return pd.DataFrame(found).assign(**fixed)


def tried(table, **corrections):
    return {
        name: pd.DataFrame({"correction": one, "sigma": 10.0}, index=table.index)
        for name, one in corrections.items()
    }


def test_ways_that_left_the_same_count_alike_and_a_much_better_one_nearly_alone():
    table = rows([1], [40.0])
    alike = weighting.weights(table, tried(table, unchanged=0.0, density=80.0))
    assert alike.loc[1].tolist() == pytest.approx([0.5, 0.5])
    better = weighting.weights(table, tried(table, unchanged=0.0, density=30.0))
    assert better.loc[1, "density"] > 0.999


def test_the_predictions_of_a_morning_count_as_one():
    """Laplace's errors as wide as what the best way leaves: a tenth more is worth exp(-0.1) a morning."""
    table = rows([1], [40.0])
    found = weighting.weights(table, tried(table, unchanged=0.0, density=-4.0)).loc[1]
    mornings = MORNINGS + 30 / len(LEADS)  # 30 predictions are the band's
    assert found["density"] / found["unchanged"] == pytest.approx(np.exp(-0.1 * mornings))


def test_an_object_without_judged_predictions_has_the_weights_of_its_band():
    table = rows([1, 2], [40.0, np.nan])
    found = weighting.weights(table, tried(table, unchanged=0.0, density=-4.0))
    assert found.loc[2, "density"] / found.loc[2, "unchanged"] == pytest.approx(np.exp(-0.1 * 30 / 4))


def test_the_density_counts_alone_where_nothing_is_judged():
    table = rows([1], [np.nan])
    found = weighting.weights(table, tried(table, unchanged=0.0, density=-4.0))
    assert found.loc[1].to_dict() == {"unchanged": 0.0, "density": 1.0}


def test_a_set_is_improved_by_the_mean_of_the_ways_that_correct_it():
    table = rows([1], [40.0])
    all_ways = tried(table, unchanged=0.0, density=8.0, learned=np.nan)
    weights = pd.DataFrame({"unchanged": 0.1, "density": 0.3, "learned": 0.6}, index=table.index)
    found = weighting.combined(table, all_ways, weights)
    assert found["correction"].to_numpy() == pytest.approx(6.0)
    assert found["sigma"].to_numpy() == pytest.approx(10.0)
    assert weighting.combined(table, tried(table, learned=np.nan), weights)["correction"].isna().all()


@pytest.mark.parametrize("bstar", [100.0, 1.0])
def test_two_numbers_come_nearest_to_the_corrections(bstar):
    """The least squares of docs/theory.md, with and without the bound on B*."""
    tau, response = np.array(LEADS, float), np.array([3.0, 40.0, 90.0, 210.0])
    sought = np.array([50.0, 300.0, 500.0, 1600.0])
    table = pd.DataFrame({"tau": tau, "response": response, "correction": sought})
    found = weighting.changes(table, pd.Series(0, table.index), pd.Series([bstar])).loc[0]
    weight, terms = tau**-1.5, np.column_stack([tau, response])
    best = np.linalg.lstsq(weight[:, None] * terms, weight * sought)[0]
    if (held := 0.9 * bstar) < best[1]:
        line, rest = weight * tau, weight * (sought - held * response)
        best = [line @ rest / (line @ line), held]
    assert found[["speed", "bstar"]].to_numpy() == pytest.approx(best)
