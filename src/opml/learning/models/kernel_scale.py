"""Rules for the scale s of the Gaussian kernel k(x, z) = exp(-|x - z|^2 / s^2), on standardised variables.

The paper leaves s to fitrsvm's 'auto' heuristic, a subsampling procedure that is not public. The public rule
nearest to it is kernlab's `sigest` (Karatzoglou, Smola, Hornik & Zeileis 2004, J. Stat. Softw. 11(9), and the
package's manual; after Caputo et al. 2002): with kernlab's k = exp(-sigma |x - z|^2), values of 1/sigma
between the 0.1 and the 0.9 quantile of |x - z|^2 serve well. As sigma = 1/s^2, s runs from the 0.1 to the 0.9
quantile of the distance |x - z|, and `sigest` here is the lower end of that range.
"""

from collections.abc import Callable

import numpy as np

from opml.base.errors import InputError
from opml.learning.models.inputs import subsample

QUANTILES = {"sigest": 0.1, "median": 0.5}
RULES = (*QUANTILES, "cv")

DISTANCE_ROWS = 2000  # two million pairs: the quantile's sampling error is far below what s is worth
CV_ROWS = 4000
CV_FOLDS = 5
CV_FACTORS = (0.35, 0.5, 0.7, 1.0, 1.4, 2.0, 2.8, 4.0)  # times sigest's scale


def distance_quantile(x: np.ndarray, quantile: float, *, rng: np.random.Generator) -> float:
    """Quantile of the distances between distinct rows of x (n, variables), or of a subsample of them.

    Coincident rows are left out, as kernlab does. Raises InputError where all rows coincide.
    """
    from scipy.spatial.distance import pdist  # slow to import, and only training needs it

    distances = pdist(x[subsample(len(x), DISTANCE_ROWS, rng)])
    distances = distances[distances > 0.0]
    if len(distances) == 0:
        raise InputError("kernel scale: expected rows that differ in some variable, got coincident rows only")
    return float(np.quantile(distances, quantile))


def cross_validated(
    x: np.ndarray,
    y: np.ndarray,
    groups: np.ndarray | None,
    *,
    predicted: Callable[[float, np.ndarray, np.ndarray, np.ndarray], np.ndarray],
    rng: np.random.Generator,
) -> float:
    """Scale with the smallest absolute error on held-out groups (estimates), from a grid around sigest's.

    `predicted(scale, x, y, new)` trains on rows x with target y and predicts new rows. Rows of one estimate
    stay in one fold: they share all learning variables but the duration, and a scale tuned on their siblings
    would be too small.
    Raises InputError with fewer groups than folds.
    """
    from sklearn.model_selection import GroupKFold  # slow to import, and only this rule needs it

    found = 0 if groups is None else len(np.unique(groups))
    if groups is None or found < CV_FOLDS:
        raise InputError(f"kernel_scale: cv: expected at least {CV_FOLDS} estimates to hold out, got {found}")
    base = distance_quantile(x, QUANTILES["sigest"], rng=rng)
    rows = subsample(len(x), CV_ROWS, rng)
    x, y, groups = x[rows], y[rows], groups[rows]
    folds = list(GroupKFold(CV_FOLDS).split(x, y, groups))

    def error(scale: float) -> float:
        held_out = (
            np.sum(np.abs(y[test] - predicted(scale, x[train], y[train], x[test]))) for train, test in folds
        )
        return float(sum(held_out))

    return min((base * factor for factor in CV_FACTORS), key=error)
