"""Rules for the scale s of the Gaussian kernel k(x, z) = exp(-|x - z|^2 / s^2), on standardised variables.

The paper leaves s to fitrsvm's 'auto' heuristic, a subsampling procedure that is not public. The nearest
public rule is kernlab's `sigest` (Karatzoglou, Smola, Hornik & Zeileis 2004, J. Stat. Softw. 11(9), and the
package's manual; after Caputo et al. 2002): with kernlab's k = exp(-sigma |x - z|^2), values of 1/sigma
between the 0.1 and the 0.9 quantile of |x - z|^2 serve well. As sigma = 1/s^2, s runs from the 0.1 to the 0.9
quantile of the distance |x - z|. Here `sigest` is the lower end of that range.
"""

import numpy as np

from opml.base.errors import InputError
from opml.learning.models.training_inputs import subsample

QUANTILES = {"sigest": 0.1, "median": 0.5}

DISTANCE_ROWS = 2000  # two million pairs: the sampling error of the quantile is far below what matters of s


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
