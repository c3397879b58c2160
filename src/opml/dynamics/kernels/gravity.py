"""Acceleration by the harmonics of the Earth's gravity field, without the central term.

Each component of the acceleration is a linear function of the solid harmonics one degree higher (Cunningham
1970; Montenbruck & Gill, Satellite Orbits, 2000, sec. 3.2.5). The factors do not depend on the position, so
they are computed once, for fully normalised harmonics. The kernel sums order by order: one recursion in the
degree and six sums in registers.
"""

import math

import numpy as np

from opml.dynamics.kernels.lanes import compiled, splat

PARTS = 7  # columns of the weights: the factor of the recursion, and those of six sums


def weights(c: np.ndarray, s: np.ndarray) -> np.ndarray:
    """Return the factors of the solid harmonics in the acceleration, order by order.

    c, s: (degree + 1, order + 1) fully normalised coefficients; c[0, 0], the central term, is ignored

    The rows (terms, 7) hold the factor of the recursion to the next degree, then those of the x, y and z sums
    for cosine and sine harmonics, all per GM / radius^2. The kernel's harmonics have no norms, with 1 as the
    factor of the highest power of z, which saves multiplications; so the factors include the norms.
    """
    degree, order = c.shape[0] - 1, c.shape[1] - 1
    c = c.copy()
    c[0, 0] = 0.0
    rows = []
    sectoral = 1.0
    for m in range(order + 2):
        norm = sectoral
        for n in range(m, degree + 2):
            rows.append([_recursion(n, m), *(norm * factor for factor in _sums(c, s, n, m))])
            norm *= math.sqrt((2 * n + 3) * (2 * n + 1) / ((n + 1 - m) * (n + 1 + m)))
        sectoral *= math.sqrt((2 * m + 3) / (2 * m + 2) if m > 0 else 3.0)
    return np.array(rows)


def row(n: int, m: int, degree: int) -> int:
    """Return the row of harmonic (n, m) in the weights of a field of some degree."""
    return m * (degree + 2) - m * (m - 1) // 2 + (n - m)


def _recursion(n, m):
    """Return the factor of harmonic (n - 1, m) in (n + 1, m); (n, m) has 1 (Montenbruck & Gill 3.30)."""
    return (n - m) * (n + m) / ((2 * n + 1) * (2 * n - 1))


def _sums(c, s, n, m):
    """Return the factors of harmonic (n, m) in the six sums (Montenbruck & Gill 3.33, normalised)."""

    def coefficient(part, order):
        inside = 0 <= order < c.shape[1] and order <= n - 1 and n - 1 < c.shape[0]
        return part[n - 1, order] if inside else 0.0

    if n == 0:
        return [0.0] * 6
    norm = (2 * n - 1) / (2 * n + 1)
    below = math.sqrt(norm * (n + m - 1) * (n + m)) / (math.sqrt(2.0) if m == 1 else 2.0) if m > 0 else 0.0
    above = math.sqrt(norm * (n - m - 1) * (n - m) * (2.0 if m == 0 else 1.0)) / 2.0 if n > m else 0.0
    level = math.sqrt(norm * (n + m) * (n - m))
    c_below, s_below = below * coefficient(c, m - 1), below * coefficient(s, m - 1)
    c_above, s_above = above * coefficient(c, m + 1), above * coefficient(s, m + 1)
    return [
        c_above - c_below,
        s_above - s_below,
        s_above + s_below,
        -c_above - c_below,
        -level * coefficient(c, m),
        -level * coefficient(s, m),
    ]


@compiled
def gravity(x, y, z, inverse_r, weights, columns, degree, gm, radius):
    """Return the acceleration [m/s2] without the central term, in the frame of the field (ITRF).

    weights: from `weights`
    columns: number of orders in the weights
    degree: highest degree of a harmonic in the weights
    gm, radius: of the field [m3/s2, m]
    """
    scale = radius * inverse_r * inverse_r
    xs, ys, zs = x * scale, y * scale, z * scale
    q = radius * scale
    # The sectoral harmonic (m, m), the start of the recursion in the degree.
    cosine = radius * inverse_r
    sine = splat(0.0)
    ax, ay, az = splat(0.0), splat(0.0), splat(0.0)
    k = 0
    # All harmonics of an order m have the factor (xs + i ys)^m: sums over degrees get it once, at their end.
    for m in range(columns):
        previous, current = splat(0.0), splat(1.0)
        xc, xs_, yc, ys_ = splat(0.0), splat(0.0), splat(0.0), splat(0.0)
        zc, zs_ = splat(0.0), splat(0.0)
        for _ in range(m, degree + 1):
            xc = xc + weights[k, 1] * current
            xs_ = xs_ + weights[k, 2] * current
            yc = yc + weights[k, 3] * current
            ys_ = ys_ + weights[k, 4] * current
            zc = zc + weights[k, 5] * current
            zs_ = zs_ + weights[k, 6] * current
            following = zs * current - weights[k, 0] * q * previous
            previous = current
            current = following
            k += 1
        ax = ax + cosine * xc + sine * xs_
        ay = ay + cosine * yc + sine * ys_
        az = az + cosine * zc + sine * zs_
        cosine, sine = xs * cosine - ys * sine, xs * sine + ys * cosine
    factor = gm / (radius * radius)
    return factor * ax, factor * ay, factor * az
