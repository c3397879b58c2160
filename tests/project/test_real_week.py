"""The picture of a real prediction's week: parts add up to the error, and the headline has two of them."""

import pandas as pd
import pytest
from support import shared

from validation.pictures.real_week import DAYS, parts, real_week


@pytest.mark.slow
def test_parts_of_sentinel_3a_s_error_add_up():
    orbit, sets = "real/sp3/ssas3a20.b18358.e19003.DG_.sp3.gz", "real/tle/dpshorten_Sentinel-3A.tle.gz"
    rows = parts(*(str(shared(file)) for file in (orbit, sets, "real/catalogue/sw_cssi_2026-10-15.txt.gz")))
    assert rows.index[-1] == DAYS
    pd.testing.assert_series_equal(rows["error"], rows.drop(columns="error").sum(axis=1), check_names=False)
    assert rows["rest"].abs().max() < 20.0
    assert abs(rows["weather"].iloc[0]) < 2.0 < abs(rows["weather"].iloc[-1])
    figure = real_week(rows)
    assert figure.get_suptitle().startswith("After a week 70 m come from the drag coefficient, 30 m from the")
    assert [line.get_label() for line in figure.axes[0].lines[:5]] == list(rows)
