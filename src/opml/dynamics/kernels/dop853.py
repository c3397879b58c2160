"""A step of the Dormand-Prince 8(5,3) method for a block of arcs.

Source: Hairer, Norsett & Wanner, Solving Ordinary Differential Equations I, 1993, sec. II.5 and II.10. A
block's rates are rows of one array, `slopes`, seven per stage.
"""

from opml.dynamics.kernels.acceleration import acceleration
from opml.dynamics.kernels.coefficients import ERROR_3, ERROR_5, INNER, NODES, OUTER, STAGES
from opml.dynamics.kernels.lanes import absolute, compiled, load, splat, sqrt, store
from opml.dynamics.kernels.shadow_edges import LIT, RATES, count_light
from opml.dynamics.kernels.surroundings import look_up

ORDER_OF_ERROR = 8.0  # power of the step's length to which the estimated error is proportional


@compiled
def derivative(state, model, coefficients, values, factors, scratch, rates):
    """Write the rates of states, and return the geodetic altitude [m].

    state: (6, WIDTH) position [m] and velocity [m/s] in GCRF
    values, factors: surroundings at the time of the states
    rates: (RATES, WIDTH) takes velocity, acceleration and illumination
    """
    x, y, z = load(state, 0), load(state, 1), load(state, 2)
    vx, vy, vz = load(state, 3), load(state, 4), load(state, 5)
    ballistic, reflection, kind = load(coefficients, 0), load(coefficients, 1), load(coefficients, 2)
    ax, ay, az, altitude, lit = acceleration(
        x, y, z, vx, vy, vz, ballistic, reflection, kind, model, values, factors, scratch
    )
    for k, rate in enumerate((vx, vy, vz, ax, ay, az)):
        store(rates, k, rate)
    store(rates, LIT, lit)
    return altitude


@compiled
def step(t, h, state, new, model, coefficients, values, factors, scratch, slopes):
    """Advance states from t to t + h, and return the geodetic altitude [m] at the end.

    new: (6, WIDTH) takes the states at the end
    values, factors: take the surroundings at the end
    slopes: (91, WIDTH), rates of the stages; the first seven rows hold those at the beginning, the last seven
        take those at the end
    """
    # Each inner stage: a state from the rates so far, the surroundings at its time, its rates.
    for stage in range(1, STAGES):
        for k in range(6):
            total = splat(0.0)
            for j in range(stage):
                if INNER[stage, j] != 0.0:
                    total = total + INNER[stage, j] * load(slopes, RATES * j + k)
            store(new, k, load(state, k) + h * total)
        look_up(t + NODES[stage] * h, model, values, factors)
        derivative(new, model, coefficients, values, factors, scratch, slopes[RATES * stage :])
    # The end of the step from the rates of all stages, then the light at edges of the shadow.
    for k in range(6):
        total = splat(0.0)
        for j in range(STAGES):
            if OUTER[j] != 0.0:
                total = total + OUTER[j] * load(slopes, RATES * j + k)
        store(new, k, load(state, k) + h * total)
    count_light(t, h, state, new, model, coefficients, values, slopes, scratch)
    # The last stage was at t + h, so the surroundings are those of the end already.
    return derivative(new, model, coefficients, values, factors, scratch, slopes[RATES * STAGES :])


@compiled
def error(h, new, slopes, tolerance, gm):
    """Return the estimated error of a step relative to its tolerance; below 1 the step is good.

    new: (6, WIDTH) states at the end, GCRF [m, m/s]
    slopes: rates of the stages and of the end
    tolerance: of each position component [m]
    gm: the Earth's [m3/s2]

    The tolerance of the velocity follows from the energy of a circular orbit, dv = GM dr / (v r^2) (paper,
    sec. 'Building the SVM model'; Orekit's rule).
    """
    x, y, z = load(new, 0), load(new, 1), load(new, 2)
    vx, vy, vz = load(new, 3), load(new, 4), load(new, 5)
    r2 = x * x + y * y + z * z
    speed_tolerance = (tolerance * gm) / (r2 * sqrt(vx * vx + vy * vy + vz * vz))
    # Squared sums over the six components, each in units of its tolerance.
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
    # The method's blend of both estimates; 1e-300 keeps it finite where both are 0.
    return absolute(h * fifth / sqrt(6.0 * (fifth + 0.01 * third) + 1e-300))
