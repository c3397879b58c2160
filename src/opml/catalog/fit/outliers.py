"""Measured numbers that no orbit explains, which fits leave out."""

from collections.abc import Callable, Sequence

import numpy as np

from opml.catalog.fit.estimate import Estimate
from opml.catalog.fit.least_squares import Fit
from opml.catalog.fit.measurements import Measurements, Window

_EDITS = 10  # times that outliers are looked for in a fit at most
_NORMAL = 0.6745  # median of the size of a normal deviate


def fit_without_outliers(
    estimates: Sequence[Estimate],
    measured: Measurements,
    limit: float,
    *,
    fit: Callable[[Sequence[Estimate]], None],
    residuals: Callable[[Sequence[Estimate]], list[np.ndarray]],
) -> list[Estimate]:
    """Return estimates fitted without outliers, first those from the start, until these stay the same.

    Each time all numbers are judged again, so that one that a bad orbit made an outlier comes back.

    limit: size of a residual beyond which it is an outlier, in standard deviations
    fit: runs the fits of estimates to their ends
    residuals: of estimates, weighted
    """

    def judge(estimate: Estimate, weighted: np.ndarray) -> Estimate:
        """Return an estimate that goes on from its best; as it is where its arc has no residuals."""
        if not np.isfinite(weighted).all():
            return estimate
        again = Fit(estimate.fit.best, estimate.fit.method)
        return Estimate(estimate.window, again, are_no_outliers(measured, estimate.window, weighted, limit))

    estimates_so_far = [judge(*pair) for pair in zip(estimates, residuals(estimates), strict=True)]
    changed = estimates_so_far
    for _ in range(_EDITS):
        fit(changed)
        begun = [k for k, one in enumerate(estimates_so_far) if one.fit.started]
        left = residuals([estimates_so_far[k] for k in begun])
        judged = {k: judge(estimates_so_far[k], one) for k, one in zip(begun, left, strict=True)}
        judged = {k: one for k, one in judged.items() if not _have_same_numbers(one, estimates_so_far[k])}
        if not judged:
            break
        changed = list(judged.values())
        estimates_so_far = [judged.get(k, one) for k, one in enumerate(estimates_so_far)]
    return estimates_so_far


def are_no_outliers(measured: Measurements, window: Window, weighted: np.ndarray, limit: float) -> np.ndarray:
    """Return which weighted residuals (numbers,) of a window are no outliers.

    Each observable has a scale of its own, its residuals' scatter by their median, but 1 at least.
    """
    _, observables = measured.layout(window.rows)
    kept = np.ones(len(weighted), bool)
    for observable in np.unique(observables):
        size = np.abs(weighted[observables == observable])
        kept[observables == observable] = size <= limit * max(1.0, float(np.median(size)) / _NORMAL)
    return kept


def _have_same_numbers(one: Estimate, other: Estimate) -> bool:
    if one.kept is None or other.kept is None:
        return one.kept is other.kept
    return bool(np.array_equal(one.kept, other.kept))
