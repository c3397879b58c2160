"""Which spans of time a manoeuvre lies in."""

from collections.abc import Sequence

import numpy as np


def have_any(begin: np.ndarray, end: np.ndarray, times: Sequence[float]) -> np.ndarray:
    """Which of the spans (begin, end], (n,) [s], have one of the times [s] in them."""
    have = np.zeros(len(end), dtype=bool)
    for t in times:
        have |= (begin < t) & (t <= end)
    return have
