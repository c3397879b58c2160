"""Sums of Gaussian kernels, by which a support vector machine predicts."""

import numpy as np
from threadpoolctl import threadpool_limits

BLOCK_ENTRIES = 1 << 20  # kernel entries held at once: 8 MiB, about the cache of a core


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
