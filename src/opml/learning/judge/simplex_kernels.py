"""Quantile regression of sizes of errors, by the simplex of Nelder & Mead 1965, Comput. J. 7, compiled.

A loss takes less time than a call of scipy's minimiser, whose steps and constants these are.
"""

import numpy as np

from opml.base.compiled import decorators

compiled, entry = decorators(nogil=True)

_LONGER, _START_AT_ZERO = 0.05, 0.00025  # first steps: a part of a coordinate, and of one that is 0
_XATOL, _FATOL, _MOST = 1e-2, 1e-6, 399
_PENALTY = 1e-5  # keeps parameters at their start that the past does not determine


@compiled
def _loss(logarithms, units, errors, inside, level):
    size, duration, drag, still, weight = errors
    a2 = (units[0] * np.exp(logarithms[0])) ** 2
    b, c = units[1] * np.exp(logarithms[1]), units[2] * np.exp(logarithms[2])
    total = 0.0
    for k in range(len(size)):
        above = size[k] - inside * np.sqrt(a2 + (b * duration[k]) ** 2 + (c * drag[k]) ** 2 + still[k])
        total += weight[k] * (level * above if above > 0.0 else (level - 1.0) * above)
    return total + _PENALTY * np.sum(logarithms**2)


@entry
def minimum(start, units, errors, inside, level):
    """Return logarithms (3,) of a, b and c in `units`, from a start (3,), and their loss.

    errors: size, duration, drag, known part of the variance and weight (n,) of each
    inside, level: half the width [sigma] of the interval that is to hold so large a part of them
    """
    count = len(start)
    points, losses = np.empty((count + 1, count)), np.empty(count + 1)
    for row in range(count + 1):
        points[row] = start
        if row:
            at = points[row, row - 1]
            points[row, row - 1] = (1.0 + _LONGER) * at if at != 0.0 else _START_AT_ZERO
        losses[row] = _loss(points[row], units, errors, inside, level)
    for _ in range(_MOST):
        order = np.argsort(losses, kind="mergesort")
        points, losses = points[order], losses[order]
        near = np.abs(points[1:] - points[0]).max() <= _XATOL
        if near and np.abs(losses[1:] - losses[0]).max() <= _FATOL:
            break
        middle = points[:-1].sum(axis=0) / count
        # The worst point goes through the middle of the others: as far, twice as far, or half as far.
        tried = 2.0 * middle - points[-1]
        loss = _loss(tried, units, errors, inside, level)
        if loss < losses[0]:
            further = 3.0 * middle - 2.0 * points[-1]
            better = _loss(further, units, errors, inside, level)
            if better < loss:
                tried, loss = further, better
        elif not loss < losses[-2]:
            outside = loss < losses[-1]
            limit = loss if outside else losses[-1]
            tried = 1.5 * middle - 0.5 * points[-1] if outside else 0.5 * middle + 0.5 * points[-1]
            loss = _loss(tried, units, errors, inside, level)
            if not (loss <= limit if outside else loss < limit):
                for row in range(1, count + 1):
                    points[row] = points[0] + 0.5 * (points[row] - points[0])
                    losses[row] = _loss(points[row], units, errors, inside, level)
                continue
        points[-1], losses[-1] = tried, loss
    best = np.argmin(losses)
    return points[best], losses[best]
