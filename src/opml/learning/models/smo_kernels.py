"""The compiled inner loops of the solver of the SVR: kernel entries, gradients, and steps on a dense block.

A variable beta in [-c, c] has the gradient g of the smooth part of the dual. The slope of the objective is
g + epsilon or g - epsilon, by the sign of beta; it has a kink at 0. `up` is the slope when beta grows, `down`
when beta shrinks. A variable at its limit has no slope in that direction (+inf, -inf).
"""

from typing import Any

import numpy as np

from opml.base.compiled import decorators

_OPTIONS: dict[str, Any] = {
    "error_model": "numpy",
    "nogil": True,
    # No NaN gets here, as inputs are finite: without that promise the compiler vectorises no minimum.
    "fastmath": {"contract", "nsz", "nnan"},
}
compiled, entry = decorators(**_OPTIONS)

_LANES = 64  # running minima kept side by side: one alone would wait for itself at each element
LEAST_CURVATURE = 1e-12  # along a pair of coincident rows, as in libsvm

_SINGLE = np.float32
_LOWEST = _SINGLE(-87.0)  # exp of less is no normal number in single precision
_PER_LN2 = _SINGLE(1.4426950408889634)
_LN2_HIGH = _SINGLE(0.693145751953125)  # few enough bits that a whole multiple of it is exact
_LN2_LOW = _SINGLE(1.42860682030941723e-6)
_ROUNDING = _SINGLE(12582912.0)  # 1.5 * 2^23: a number added to it is rounded to an integer


@compiled
def _exponentials(x):
    """Replace x by exp(x), for x up to 0, in single precision.

    exp(x) = 2^k exp(r) with |r| up to ln(2) / 2; the polynomial is Moshier's (Cephes, expf). It is written
    out because the compiler vectorises this loop, but no call of a library's exp.
    """
    for j in range(len(x)):
        at = min(max(x[j], _LOWEST), _SINGLE(0.0))
        shifted = at * _PER_LN2 + _ROUNDING
        k = shifted - _ROUNDING
        r = at - k * _LN2_HIGH
        r = r - k * _LN2_LOW
        p = _SINGLE(1.9875691500e-4)
        p = p * r + _SINGLE(1.3981999507e-3)
        p = p * r + _SINGLE(8.3334519073e-3)
        p = p * r + _SINGLE(4.1665795894e-2)
        p = p * r + _SINGLE(1.6666665459e-1)
        p = p * r + _SINGLE(5.0000001201e-1)
        p = p * r * r + r + _SINGLE(1.0)
        # The lowest bits of `shifted` are k; added to the exponent's bits of p they multiply it by 2^k.
        power = np.float32(shifted).view(np.int32) << np.int32(23)
        x[j] = np.int32(np.float32(p).view(np.int32) + power).view(np.float32)


@entry
def exponentiate(exponents, out, places, start):
    """Write exp(exponents), (a, b) of doubles, into rows `places` (a,) of out, from column `start` on."""
    count = exponents.shape[1]
    for a in range(len(places)):
        row = out[places[a], start : start + count]
        for j in range(count):
            row[j] = exponents[a, j]
        _exponentials(row)


@entry
def accumulate(rows, places, weights, total):
    """Add sum_a weights_a rows[places_a] to total (n,): rows in single precision, sums in double."""
    tile = 2048  # of total, which stays in the nearest cache while all rows pass
    for start in range(0, len(total), tile):
        stop = min(len(total), start + tile)
        part = total[start:stop]
        whole = len(places) // 4 * 4
        for a in range(0, whole, 4):
            r0, r1 = rows[places[a], start:stop], rows[places[a + 1], start:stop]
            r2, r3 = rows[places[a + 2], start:stop], rows[places[a + 3], start:stop]
            w0, w1, w2, w3 = weights[a], weights[a + 1], weights[a + 2], weights[a + 3]
            for j in range(stop - start):
                part[j] += w0 * r0[j] + w1 * r1[j] + w2 * r2[j] + w3 * r3[j]
        for a in range(whole, len(places)):
            row = rows[places[a], start:stop]
            for j in range(stop - start):
                part[j] += weights[a] * row[j]


@compiled
def _above(beta, limit, epsilon):
    """Return the slope `up` less the gradient."""
    if beta >= limit:
        return np.inf
    return epsilon if beta >= 0.0 else -epsilon


@compiled
def _below(beta, limit, epsilon):
    """Return the slope `down` less the gradient."""
    if beta <= -limit:
        return -np.inf
    return epsilon if beta > 0.0 else -epsilon


@entry
def slopes(beta, gradient, limits, epsilon, up, down):
    """Write the slopes `up` and `down` of each variable."""
    for k in range(len(beta)):
        up[k] = gradient[k] + _above(beta[k], limits[k], epsilon)
        down[k] = gradient[k] + _below(beta[k], limits[k], epsilon)


@compiled
def _move(up, down, step, first, second, least, most):
    """Add step (first - second) to all slopes; return the least `up` and the largest `down`."""
    least[:] = np.inf
    most[:] = -np.inf
    whole = len(up) // _LANES * _LANES
    for start in range(0, whole, _LANES):
        for lane in range(_LANES):
            k = start + lane
            change = step * (first[k] - second[k])
            up[k] += change
            down[k] += change
            least[lane] = min(least[lane], up[k])
            most[lane] = max(most[lane], down[k])
    for k in range(whole, len(up)):
        change = step * (first[k] - second[k])
        up[k] += change
        down[k] += change
        least[0] = min(least[0], up[k])
        most[0] = max(most[0], down[k])
    return least.min(), most.max()


@compiled
def curvature(entry, two, least):
    """Return K_ii + K_kk - 2 K_ik of a pair with the entry K_ik, as K(x, x) = 1, in the precision of 2."""
    return max(two - two * entry, least)


@compiled
def _largest_gain(down, lowest, row, gains, largest):
    """Write the gain of a free step of each variable against that of `row`; return the largest gain."""
    for k in range(len(gains)):
        gains[k] = down[k] - lowest
    for k in range(len(gains)):
        slope = max(gains[k], _SINGLE(0.0))
        gains[k] = slope * slope / curvature(row[k], _SINGLE(2.0), _SINGLE(LEAST_CURVATURE))
    largest[:] = _SINGLE(0.0)
    whole = len(gains) // _LANES * _LANES
    for start in range(0, whole, _LANES):
        for lane in range(_LANES):
            largest[lane] = max(largest[lane], gains[start + lane])
    for k in range(whole, len(gains)):
        largest[0] = max(largest[0], gains[k])
    return largest.max()


@compiled
def _find(values, value):
    """Return the first place of a value, -1 where there is none."""
    for k in range(len(values)):
        if values[k] == value:
            return k
    return -1


@compiled
def _room(beta, limit):
    """Return how far beta may grow before its slope changes: to 0 from below, else to its limit."""
    return -beta if beta < 0.0 else limit - beta


@compiled
def _grown(beta, limit, step):
    """Return beta after a step up, exactly 0 or the limit where it gets there."""
    if step < _room(beta, limit):
        return beta + step
    return 0.0 if beta < 0.0 else limit


@entry
def descend(kernel, beta, gradient, limits, epsilon, tol, most_steps):
    """Move pairs of beta, in place, until no two slopes differ by tol or more; return the number of steps.

    kernel: (q, q) all entries of the block
    gradient: (q,) at the start

    Pairs are chosen by second-order information (Fan, Chen & Lin 2005, J. Mach. Learn. Res. 6, 1889), as in
    libsvm.
    """
    count = len(beta)
    up, down, gains = np.empty(count), np.empty(count), np.empty(count, _SINGLE)
    least, most, largest = np.empty(_LANES), np.empty(_LANES), np.empty(_LANES, _SINGLE)
    slopes(beta, gradient, limits, epsilon, up, down)
    i = j = 0
    step = 0.0
    for taken in range(most_steps):
        lowest, highest = _move(up, down, step, kernel[i], kernel[j], least, most)
        if highest - lowest < tol:
            return taken
        i = _find(up, lowest)
        j = _find(gains, _largest_gain(down, lowest, kernel[i], gains, largest))
        bend = curvature(kernel[i, j], 2.0, LEAST_CURVATURE)
        step = min((down[j] - lowest) / bend, _room(beta[i], limits[i]), _room(-beta[j], limits[j]))
        for k, sign in ((i, 1.0), (j, -1.0)):
            if k == i:
                bare = up[k] - _above(beta[k], limits[k], epsilon)
            else:
                bare = down[k] - _below(beta[k], limits[k], epsilon)
            beta[k] = sign * _grown(sign * beta[k], limits[k], step)
            up[k] = bare + _above(beta[k], limits[k], epsilon)
            down[k] = bare + _below(beta[k], limits[k], epsilon)
    return most_steps
