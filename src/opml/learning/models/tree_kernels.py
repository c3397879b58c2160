"""Compiled walk of rows through regression trees."""

import numpy as np

from opml.base.compiled import decorators

_, entry = decorators(nogil=True)


@entry
def add_leaves(
    x: np.ndarray,
    roots: np.ndarray,
    feature: np.ndarray,
    threshold: np.ndarray,
    left: np.ndarray,
    right: np.ndarray,
    value: np.ndarray,
    totals: np.ndarray,
) -> None:
    """Add to the totals (n,) of rows x (n, variables) the leaves that they reach, tree by tree."""
    for row in range(x.shape[0]):
        for tree in range(roots.shape[0]):
            node = roots[tree]
            while feature[node] >= 0:
                node = left[node] if x[row, feature[node]] <= threshold[node] else right[node]
            totals[row] += value[node]
