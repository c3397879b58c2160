"""Removal of flares' radio bursts from F10.7: readings of minutes, which do not last into the next day."""

import numpy as np

_DAYS = 5  # days up to a reading whose median it is compared with
_HIGHEST = 60.0  # highest reading above the median that is no burst [sfu]


def remove_bursts(flux: np.ndarray) -> np.ndarray:
    """Return daily F10.7 (n,) [sfu] with each burst replaced by the median of the five days up to it."""
    before = np.concatenate([np.repeat(flux[:1], _DAYS - 1), flux])
    median = np.median(np.lib.stride_tricks.sliding_window_view(before, _DAYS), axis=1)
    return np.where(flux > median + _HIGHEST, median, flux)
