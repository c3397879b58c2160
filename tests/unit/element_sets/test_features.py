"""What the corrector sees: the drag's displacement, and the misses that a band of heights has in common."""

from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from opml.element_sets import features
from opml.element_sets.density import DAYS_AHEAD, HEIGHTS, QUARTERS, RUN_UP, Densities, MorningDensity
from opml.element_sets.set_errors import BACK

MISS = 0.4


def band_of(objects=6, mornings=5):
    """Return predictions a day ahead that all miss by MISS, judged half a day after their time."""
    morning = 61000.25 + np.repeat(np.arange(mornings), objects)
    return pd.DataFrame(
        {
            "number": np.tile(np.arange(objects), mornings),
            "morning": morning,
            "lead": 1,
            "band": 2,
            "judged": morning + 1.5,
            "miss": MISS,
        }
    )


def by_morning(rows):
    return pd.Series(features.common_misses(rows)).groupby(rows["morning"].to_numpy()).first().to_list()


def test_a_common_miss_counts_once_its_judges_are_known():
    assert by_morning(band_of()) == pytest.approx([0.0, 0.0, MISS, MISS, MISS])


def test_few_objects_have_no_common_miss():
    assert by_morning(band_of(objects=4)) == [0.0] * 5


def test_bands_do_not_lend_each_other_their_misses():
    rows = pd.concat([band_of(), band_of().assign(band=3, miss=-MISS)], ignore_index=True)
    common = features.common_misses(rows)
    late = rows["morning"] > 61002.0
    assert set(common[late & rows["band"].eq(2)]) == {MISS}
    assert set(common[late & rows["band"].eq(3)]) == {-MISS}


def test_misses_older_than_three_mornings_are_forgotten():
    rows = band_of(mornings=8)
    rows.loc[rows["morning"] > 61001.0, "miss"] = np.nan
    assert by_morning(rows) == pytest.approx([0.0, 0.0, MISS, MISS, 0.0, 0.0, 0.0, 0.0])


@pytest.mark.parametrize("times", [1.0, 2.0, 0.5])
def test_drag_that_changes_at_the_epoch_displaces_by_the_change_of_b_star(times):
    """The equations of docs/theory.md: Q is 0 under a constant density, and S its displacement and 30 m/d."""
    morning, tau, response, bstar = 60_000.0, 5.0, 4e8, 1e-4
    known = np.full((QUARTERS * (RUN_UP + 1), len(HEIGHTS)), np.log(1e-12))
    air = MorningDensity(Densities(60_000 - RUN_UP, known), known[:DAYS_AHEAD] + np.log(times), morning)
    sets = {"number": [7] * 3, "t": morning - np.arange(3.0)[::-1], "bstar": bstar, "height": 500e3}
    catalogue = SimpleNamespace(table=pd.DataFrame(sets))
    rows = pd.DataFrame({"newest": [2], "tau": [tau], "response": [response]})
    ((scale, density, *_),) = features._of_morning(catalogue, rows.iloc[:1], np.zeros((3, BACK)), air)
    assert density == pytest.approx(response * bstar * (1.0 - times), abs=1e-3 * response * bstar)
    assert scale == pytest.approx(times * response * bstar + features.FLOOR * tau, rel=1e-3)
