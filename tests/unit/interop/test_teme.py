"""TEME to GCRF: as the full series has it, whatever times are asked for beside."""

import erfa
import numpy as np

from opml.base import epochs
from opml.base.constants import DAY
from opml.interop.element_sets.teme import teme_to_gcrf

EPOCH = "2016-12-30T07:00:00"  # a leap second later
T = np.random.default_rng(3).uniform(-400.0 * DAY, 400.0 * DAY, 50)


def test_it_is_the_rotation_of_the_full_series():
    utc, tt = epochs.utc(EPOCH, T), epochs.tt(EPOCH, T)
    to_cirs = erfa.rz(erfa.gmst82(*utc) - erfa.era00(*utc), np.eye(3))
    expected = erfa.c2ixys(*erfa.xys06a(*tt)).transpose(0, 2, 1) @ to_cirs
    found = teme_to_gcrf(EPOCH, T)
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=2e-12)
    np.testing.assert_allclose(found @ found.transpose(0, 2, 1), np.tile(np.eye(3), (50, 1, 1)), atol=1e-14)


def test_a_time_has_the_same_rotation_alone():
    np.testing.assert_array_equal(teme_to_gcrf(EPOCH, T)[7], teme_to_gcrf(EPOCH, T[7:8])[0])
