"""Arrays that a value hands out."""

import numpy as np


def read_only(array: np.ndarray) -> np.ndarray:
    """Return an array that nobody can change: a value that keeps it would change with it."""
    array = array.view()
    array.flags.writeable = False
    return array
