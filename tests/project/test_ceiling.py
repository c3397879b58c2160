"""What an oracle would leave: the best Cd of a group, and the table's cells."""

import numpy as np
import pandas as pd

from opml.base.constants import DAY
from validation.ceiling import Mornings, sizes


def test_the_best_cd_of_each_arc_takes_all_that_cd_explains():
    days = np.array([1.0, 2.0, 4.0, 7.0])
    pairs = pd.DataFrame({"i": np.repeat([3, 8], 4), "t_i": 0.0, "t_j": DAY * np.tile(days, 2)})
    mornings = Mornings({}, pairs, pd.DataFrame(), np.empty((8, 6)), np.empty((2, 6)))
    answer = np.tile(100.0 * days**2, 2)
    errors = answer * np.repeat([0.3, -0.1], 4)
    assert np.abs(mornings.with_best_cd(errors, answer, mornings.arc)).max() < 1e-9
    shared = mornings.with_best_cd(errors, answer, np.zeros(8, int))
    np.testing.assert_allclose(shared, answer * np.repeat([0.2, -0.2], 4))
    assert sizes(mornings.days, shared).split(" | ")[0] == "20 / 20"
