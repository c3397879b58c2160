"""The picture of the parts of an error: they are stacked to the error, and the headline states its size."""

import numpy as np
import pandas as pd
import pytest

from validation.pictures.anatomy import CAUSES, COLORS, anatomy


@pytest.fixture
def rows():
    lead = np.linspace(0.1, 7.0, 70)
    parts = dict(zip(CAUSES, (100.0 * lead, 4e3 * lead, -3e3 * lead, 10.0 * lead), strict=True))
    early = pd.DataFrame({"i": 0, "t_i": 1.0, "lead": lead, **parts})
    later = pd.DataFrame({"i": 1, "t_i": 4.5, "lead": lead, **parts})
    table = pd.concat([early, later], ignore_index=True)
    return table.assign(error=table[list(CAUSES)].sum(axis=1))


def test_the_stack_of_one_prediction_ends_at_the_sums_of_its_parts(rows):
    one, usual = anatomy(rows).axes
    heights = np.concatenate([area.get_paths()[0].vertices[:, 1] for area in one.collections])
    assert heights.max() == pytest.approx(7.0 * 4110.0)
    assert heights.min() == pytest.approx(7.0 * -3000.0)
    (error,) = [line for line in one.lines if line.get_label() == "error"]
    assert error.get_ydata()[-1] == pytest.approx(7.0 * 1110.0)
    assert one.get_title(loc="left").endswith("from day 4.50")
    assert {text.get_text() for text in usual.texts} == {*COLORS, "error"}


def test_the_headline_has_the_median_error_of_the_last_day(rows):
    title = anatomy(rows).get_suptitle()
    assert title.startswith("The fit's Cd offsets the weather until the weather changes: a median of 7.3 km")
