"""Rules for the scale s of the Gaussian kernel k(x, z) = exp(-|x - z|^2 / s^2), on standardised variables.

The paper leaves s to fitrsvm's 'auto' heuristic, a subsampling procedure that is not public. The nearest
public rule is kernlab's `sigest` (Karatzoglou, Smola, Hornik & Zeileis 2004, J. Stat. Softw. 11(9), and the
package's manual; after Caputo et al. 2002): with kernlab's k = exp(-sigma |x - z|^2), values of 1/sigma
between the 0.1 and the 0.9 quantile of |x - z|^2 serve well. As sigma = 1/s^2, s runs from the 0.1 to the 0.9
quantile of the distance |x - z|. Here `sigest` is the lower end of that range.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from opml.base.errors import InputError
from opml.learning.models.training_inputs import Training, subsample

QUANTILES = {"sigest": 0.1, "median": 0.5}
RULES = (*QUANTILES, "cv")

DISTANCE_ROWS = 2000  # two million pairs: the sampling error of the quantile is far below what matters of s
CV_ROWS = 4000
CV_FOLDS = 5
CV_FACTORS = (0.35, 0.5, 0.7, 1.0, 1.4, 2.0, 2.8, 4.0)  # times the scale of sigest


def distance_quantile(x: np.ndarray, quantile: float, *, rng: np.random.Generator) -> float:
    """Return a quantile of the distances between rows x (n, variables), or between a subsample of them.

    Pairs of coincident rows are left out, as in kernlab. Raises InputError where all rows coincide.
    """
    from scipy.spatial.distance import pdist  # slow to import, and only training needs it

    distances = pdist(x[subsample(len(x), DISTANCE_ROWS, rng)])
    distances = distances[distances > 0.0]
    if len(distances) == 0:
        raise InputError("kernel scale: expected rows that differ in some variable, got coincident rows only")
    return float(np.quantile(distances, quantile))


def cross_validate(
    training: Training,
    *,
    predict: Callable[[float, Training, np.ndarray], np.ndarray],
    rng: np.random.Generator,
) -> float:
    """Return the scale of least absolute error on groups held out, from a grid around the scale of sigest.

    training: standardised; weights do not count
    predict: trains at a scale and predicts new rows

    Rows of one estimate stay in one fold. They share all learning variables but the duration, so a scale
    tuned on rows of the same estimate would be too small. Raises InputError with fewer groups than folds.
    """
    from sklearn.model_selection import GroupKFold  # slow to import, and only this rule needs it

    groups = training.groups
    count = 0 if groups is None else len(np.unique(groups))
    if groups is None or count < CV_FOLDS:
        raise InputError(f"kernel_scale: cv: expected at least {CV_FOLDS} estimates to hold out, got {count}")
    base = distance_quantile(training.x, QUANTILES["sigest"], rng=rng)
    rows = subsample(len(training.x), CV_ROWS, rng)
    x, y, groups = training.x[rows], training.y[rows], groups[rows]
    folds = [
        (replace(training, x=x[train], y=y[train], groups=groups[train], weights=None), x[test], y[test])
        for train, test in GroupKFold(CV_FOLDS).split(x, y, groups)
    ]

    def error(scale: float) -> float:
        held_out = (np.sum(np.abs(true - predict(scale, part, new))) for part, new, true in folds)
        return float(sum(held_out))

    return min((base * factor for factor in CV_FACTORS), key=error)
