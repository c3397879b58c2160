"""How much more the fits of an RSO scatter than their covariances say.

A covariance is the noise of the measurements through the fit. Where the assumed model errs, fits of different
tracks differ by more, and a catalogue sees that without a truth.
"""

import numpy as np
import pandas as pd

_MEDIAN = 0.4549  # median of the square of a normal deviate
_LEAST = 5  # fewest comparisons that tell a scatter


def excess(estimates: pd.DataFrame, *, window: float) -> np.ndarray:
    """Return a factor (n,) on the covariance of each estimate, at least 1, from the estimates up to it.

    Cd of each estimate is compared with that of the newest more than `window` [s] before, which has no track
    in common: the median of their squared differences, in units of the formal variance, over that of chance.
    """
    t, cd, variance = (estimates[name].to_numpy() for name in ("t", "cd", "cov_cd_cd"))
    use = np.flatnonzero(estimates["converged"].to_numpy() & (variance > 0.0))
    before = np.searchsorted(t[use], t[use] - window) - 1
    later, earlier = use[before >= 0], use[before[before >= 0]]
    square = (cd[later] - cd[earlier]) ** 2 / (variance[later] + variance[earlier])
    known = np.searchsorted(later, np.arange(len(t)), side="right")
    medians = [np.median(square[:count]) if count >= _LEAST else 0.0 for count in known]
    return np.maximum(np.array(medians) / _MEDIAN, 1.0)
