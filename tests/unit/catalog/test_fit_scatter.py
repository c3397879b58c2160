"""How much more fits scatter than their covariances say."""

import numpy as np
import pandas as pd
import pytest

from opml.base.constants import HOUR
from opml.catalog.predict.fit_scatter import excess

COUNT = 600


def fits(scale, sigma=0.1):
    """Fits of every hour whose Cd scatters by `scale` times what they say."""
    random = np.random.default_rng(5)
    cd = 2.2 + scale * sigma * random.normal(size=COUNT)
    return pd.DataFrame({"t": HOUR * np.arange(COUNT), "cd": cd, "cov_cd_cd": sigma**2, "converged": True})


@pytest.mark.parametrize("scale", [1.0, 2.0, 5.0])
def test_the_excess_is_that_of_the_variance(scale):
    assert excess(fits(scale), window=12 * HOUR)[-1] == pytest.approx(scale**2, rel=0.25)


def test_fits_that_scatter_less_than_they_say_are_left_as_they_are():
    assert set(excess(fits(0.3), window=12 * HOUR)) == {1.0}


def test_nothing_is_known_before_five_fits_could_be_compared_nor_of_later_ones():
    table = fits(3.0)
    found = excess(table, window=12 * HOUR)
    assert set(found[:17]) == {1.0}
    assert (found[30:] > 2.0).all()
    np.testing.assert_array_equal(excess(table[:100], window=12 * HOUR), found[:100])


def test_fits_that_failed_or_held_cd_and_those_that_share_tracks_are_not_compared():
    table = fits(1.0)
    worse = table.assign(cd=table["cd"].where(table.index % 7 > 0, 1e3), converged=table.index % 7 > 0)
    held = worse.assign(converged=True, cov_cd_cd=np.where(table.index % 7 > 0, 0.01, 0.0))
    for other in (worse, held):
        assert excess(other, window=12 * HOUR)[-1] == pytest.approx(1.0, abs=0.35)
    alike = table.assign(cd=2.2 + np.floor(table.index / 12) % 2)
    assert excess(alike, window=2 * HOUR)[-1] == 1.0
    assert excess(alike, window=12 * HOUR)[-1] > 50.0
