"""Test of spans of time for manoeuvres."""

from collections.abc import Sequence

import numpy as np


def contain_any(begin: np.ndarray, end: np.ndarray, times: Sequence[float]) -> np.ndarray:
    """Return which spans (begin, end], (n,) [s], contain one of the times [s]: (n,)."""
    contain = np.zeros(len(end), dtype=bool)
    for t in times:
        contain |= (begin < t) & (t <= end)
    return contain
