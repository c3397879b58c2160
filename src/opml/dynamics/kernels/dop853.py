"""One step of the Dormand-Prince 8(5,3) method for a block of arcs.

Hairer, Norsett & Wanner, Solving Ordinary Differential Equations I, 1993, sec. II.5 and II.10. A block's
rates are rows of one array, seven per stage.
"""

from opml.dynamics.kernels.acceleration import acceleration
from opml.dynamics.kernels.coefficients import ERROR_3, ERROR_5, INNER, NODES, OUTER, STAGES
from opml.dynamics.kernels.lanes import absolute, compiled, load, splat, sqrt, store
from opml.dynamics.kernels.shadow_edges import LIT, RATES, count_light
from opml.dynamics.kernels.surroundings import look_up

ORDER_OF_ERROR = 8.0
"""A step h errs in proportion to h**8, by the method's own estimate."""


@compiled
def derivative(state, row, model, coefficients, values, factors, scratch, slopes, at):
    """Write the rates of state rows row..row+5 to rows at..at+6 of slopes; returns the altitude [m]."""
    x, y, z = load(state, row), load(state, row + 1), load(state, row + 2)
    vx, vy, vz = load(state, row + 3), load(state, row + 4), load(state, row + 5)
    ballistic, reflection = load(coefficients, 0), load(coefficients, 1)
    ax, ay, az, altitude, lit = acceleration(
        x, y, z, vx, vy, vz, ballistic, reflection, model, values, factors, scratch
    )
    store(slopes, at, vx)
    store(slopes, at + 1, vy)
    store(slopes, at + 2, vz)
    store(slopes, at + 3, ax)
    store(slopes, at + 4, ay)
    store(slopes, at + 5, az)
    store(slopes, at + LIT, lit)
    return altitude


@compiled
def step(t, h, state, new, model, coefficients, values, factors, scratch, slopes):
    """Advance `state` (6, WIDTH) by h [s] into `new`; returns the altitude [m] at its end.

    slopes: (91, WIDTH), the first seven rows holding the rates at t; the last seven will hold those at
    t + h, and `values` and `factors` the surroundings there.
    """
    for stage in range(1, STAGES):
        for k in range(6):
            total = splat(0.0)
            for j in range(stage):
                if INNER[stage, j] != 0.0:
                    total = total + INNER[stage, j] * load(slopes, RATES * j + k)
            store(new, k, load(state, k) + h * total)
        look_up(t + NODES[stage] * h, model, values, factors)
        derivative(new, 0, model, coefficients, values, factors, scratch, slopes, RATES * stage)
    for k in range(6):
        total = splat(0.0)
        for j in range(STAGES):
            if OUTER[j] != 0.0:
                total = total + OUTER[j] * load(slopes, RATES * j + k)
        store(new, k, load(state, k) + h * total)
    count_light(t, h, state, new, model, coefficients, values, slopes, scratch)
    # The last stage stands at t + h already, so the surroundings there are at hand.
    return derivative(new, 0, model, coefficients, values, factors, scratch, slopes, RATES * STAGES)


@compiled
def error(h, new, slopes, tolerance, gm):
    """Estimated error of a step over its tolerance: at most 1 where the step is good.

    tolerance: of each position component [m]; that of the velocity follows from a circular orbit's
    energy, dv = GM dr / (v r^2) (paper, sec. 'Building the SVM model'; Orekit's rule).
    """
    x, y, z = load(new, 0), load(new, 1), load(new, 2)
    vx, vy, vz = load(new, 3), load(new, 4), load(new, 5)
    r2 = x * x + y * y + z * z
    speed_tolerance = (tolerance * gm) / (r2 * sqrt(vx * vx + vy * vy + vz * vz))
    fifth, third = splat(0.0), splat(0.0)
    for k in range(6):
        e5, e3 = splat(0.0), splat(0.0)
        for j in range(STAGES + 1):
            slope = load(slopes, RATES * j + k)
            e5 = e5 + ERROR_5[j] * slope
            e3 = e3 + ERROR_3[j] * slope
        if k < 3:
            e5, e3 = e5 / tolerance, e3 / tolerance
        else:
            e5, e3 = e5 / speed_tolerance, e3 / speed_tolerance
        fifth = fifth + e5 * e5
        third = third + e3 * e3
    # Both estimates vanish together only where there is no motion to speak of.
    return absolute(h * fifth / sqrt(6.0 * (fifth + 0.01 * third) + 1e-300))
