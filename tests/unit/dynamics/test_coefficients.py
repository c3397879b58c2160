"""The integrator's coefficients beside SciPy's."""

import numpy as np
import pytest
from scipy.integrate import DOP853

from opml.dynamics.kernels import coefficients


@pytest.mark.parametrize(
    ("ours", "theirs"), [("NODES", "C"), ("INNER", "A"), ("OUTER", "B"), ("ERROR_3", "E3"), ("ERROR_5", "E5")]
)
def test_every_coefficient_is_scipys_to_the_last_bit(ours, theirs):
    assert np.array_equal(getattr(coefficients, ours), getattr(DOP853, theirs))
    assert getattr(coefficients, ours).flags.c_contiguous
