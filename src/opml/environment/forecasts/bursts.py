"""Radio bursts of flares in F10.7: the reading of a minute, which says nothing of the next days."""

import numpy as np

_DAYS = 5
_HIGHEST = 60.0
"""How far a reading may stand above the median of the days up to it [sfu]."""


def without_bursts(flux: np.ndarray) -> np.ndarray:
    """Daily F10.7 (n,) [sfu] with bursts replaced by the median of the five days up to each."""
    before = np.concatenate([np.repeat(flux[:1], _DAYS - 1), flux])
    median = np.median(np.lib.stride_tricks.sliding_window_view(before, _DAYS), axis=1)
    return np.where(flux > median + _HIGHEST, median, flux)
