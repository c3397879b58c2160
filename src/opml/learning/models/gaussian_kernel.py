"""The Gaussian kernel k(x, z) = exp(-|x - z|^2 / s^2) of standardised variables, and rules for its scale s.

Functions take rows divided by s. Another kernel begins here: with the exponent, whose exponentials the
compiled loops of `smo_kernels` take, and with `smo_kernels.curvature`, which rests on k(x, x) = 1.

The paper leaves s to fitrsvm's 'auto' heuristic, a subsampling procedure that is not public. The nearest
public rule is kernlab's `sigest` (Karatzoglou, Smola, Hornik & Zeileis 2004, J. Stat. Softw. 11(9), and the
package's manual; after Caputo et al. 2002): with kernlab's k = exp(-sigma |x - z|^2), values of 1/sigma
between the 0.1 and the 0.9 quantile of |x - z|^2 serve well. As sigma = 1/s^2, s runs from the 0.1 to the 0.9
quantile of the distance |x - z|. Here `sigest` is the lower end of that range.
"""

import numpy as np
from threadpoolctl import threadpool_limits

from opml.base.errors import InputError
from opml.learning.models.training_inputs import subsample

BLOCK_ENTRIES = 1 << 20  # kernel entries held at once: 8 MiB, about the cache of a core

QUANTILES = {"sigest": 0.1, "median": 0.5}

DISTANCE_ROWS = 2000  # two million pairs: the sampling error of the quantile is far below what matters of s


def exponent_factors(z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return two matrices whose product (n, n) are the exponents -|z_k - z_l|^2 of rows z (n, variables)."""
    squares, ones = np.sum(z**2, axis=1), np.ones(len(z))
    left = np.column_stack([2.0 * z, -squares, -ones])
    return left, np.ascontiguousarray(np.column_stack([z, ones, squares]).T)


def expansion(z: np.ndarray, vectors: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """Return sum_k weights_k exp(-|z - v_k|^2), (n,), for rows z (n, variables), vectors v (k, variables)."""
    sums = np.empty(len(z))
    rows = max(1, BLOCK_ENTRIES // max(1, len(weights)))
    # |z - v|^2 = |z|^2 - 2 z . v + |v|^2: one matrix product in place of a loop over pairs.
    norms, twice = np.sum(vectors**2, axis=1), 2.0 * vectors.T
    with threadpool_limits(limits=1, user_api="blas"):  # sums in one order, whatever the machine
        for start in range(0, len(z), rows):
            block = z[start : start + rows]
            exponent = block @ twice
            exponent -= np.sum(block**2, axis=1)[:, None]
            exponent -= norms
            np.minimum(exponent, 0.0, out=exponent)  # rounding can lift coincident points above 0
            np.exp(exponent, out=exponent)
            sums[start : start + rows] = exponent @ weights
    return sums


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
