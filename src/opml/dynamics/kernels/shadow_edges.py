"""Correction of a step for the edges of the Earth's shadow within it.

At the edges of penumbra and umbra radiation pressure sets in or ends within seconds. A Runge-Kutta rule of
high order assumes a smooth course between its few stages, and errs by seconds of sunlight. So where the
illumination differs between stages, the light over the step is integrated finely along the path of the step,
and the difference to the light in the rule corrects the end of the step. Light at u, a part of the step,
moves the end by gravity with the Earth as a point (w = 1 - u):

    dv = h int (1 + G h^2 w^2 / 2) f a du        dr = h^2 int (w + G h^2 w^3 / 6) f a du

f is the part of the Sun in sight, a the acceleration in full light and G the gradient of gravity at the end.
"""

from math import factorial

import numpy as np

from opml.dynamics.kernels.coefficients import INNER, OUTER, STAGES
from opml.dynamics.kernels.lanes import WIDTH, compiled, lanes_set, load, splat, sqrt, store
from opml.dynamics.kernels.radiation_pressure import limb, part_in_sight, radiation_pressure
from opml.dynamics.kernels.surroundings import BODIES, ROTATION, sun

RATES = 7  # rows of a stage: the derivatives of the state, then the illumination
LIT = 6  # row of the illumination in a stage
_SAMPLES = 4  # number of places along the step, evenly spaced, with Sun and limb; a cubic joins them

_CELLS = 64
"""Number of cells of the integrals over a step: 1.4 s each of 90 s, where a penumbra takes 8 s or more."""

_LAST = RATES * (STAGES - 1)  # first row of the last stage, which is at the end of the step

_MOMENTS = 4
"""Number of integrals of f w^k over a step, k from 0; they are in the scratch lanes after the samples."""


def _hermite_weights(places):
    """Return the weights (n, 6) of r, h v and h^2 a at both ends of a step in the path at `places` (n,).

    places: parts of the step, 0 to 1
    """
    powers = np.arange(6)
    # A quintic's value and two derivatives at 0 and at 1.
    falling = np.array([powers**0, powers, powers * (powers - 1)])  # of u^k, differentiated 0 to 2 times
    begin = falling * (powers == np.arange(3)[:, None])
    return np.power.outer(places, powers) @ np.linalg.inv(np.vstack([begin, falling]))


# Weights of a stage's light in the rule's own integrals of f w^k: b, b A, 2 b A^2, 6 b A^3.
_COUNTED = np.array([factorial(k) * OUTER @ np.linalg.matrix_power(INNER, k) for k in range(_MOMENTS)])
_PLACES = np.linspace(0.0, 1.0, _SAMPLES)
_PATH = _hermite_weights(_PLACES)
_CUBIC = np.linalg.inv(np.vander(_PLACES, increasing=True))


@compiled
def count_light(t, h, state, new, model, coefficients, values, slopes, scratch):
    """Correct the end of a step for edges of the shadow within it.

    new: (6, WIDTH) at the end; takes the correction
    values: surroundings at the end
    slopes: rates of the stages, RATES rows each
    scratch: eight rows of lanes
    """
    # An edge shows where the stages are neither all in full light nor all in the dark.
    total = splat(0.0)
    for stage in range(STAGES):
        total = total + load(slopes, RATES * stage + LIT)
    crossing = lanes_set((total > 0.0) & (total < float(STAGES)))
    if not crossing:
        return
    # The missing integrals: the fine ones less those of the rule; 0 for lanes without an edge.
    for k in range(_MOMENTS):
        store(scratch, _SAMPLES + k, splat(0.0))
    before, after = sun(t, model), (values[BODIES], values[BODIES + 1], values[BODIES + 2])
    for lane in range(WIDTH):
        if (crossing >> lane) & 1:
            _add_up(lane, h, state, new, before, after, values, slopes, scratch)
            _take_off(lane, slopes, scratch)
    # The acceleration in full light at the end, and the products with the gradient of gravity there.
    x, y, z = load(new, 0), load(new, 1), load(new, 2)
    r2 = x * x + y * y + z * z
    px, py, pz = radiation_pressure(x, y, z, after, splat(1.0), load(coefficients, 1))
    gradient, outward = h * h * model.gm / (r2 * sqrt(r2)), 3.0 * (x * px + y * py + z * pz) / r2
    m0, m1 = load(scratch, _SAMPLES), load(scratch, _SAMPLES + 1)
    m2 = gradient * load(scratch, _SAMPLES + 2) / 2.0
    m3 = gradient * load(scratch, _SAMPLES + 3) / 6.0
    for k, r, push in ((0, x, px), (1, y, py), (2, z, pz)):
        bent = outward * r - push
        store(new, k, r + h * h * (m1 * push + m3 * bent))
        store(new, k + 3, load(new, k + 3) + h * (m0 * push + m2 * bent))


@compiled
def _add_up(lane, h, state, new, before, after, values, slopes, scratch):
    """Write the integrals of f w^k over the step of one lane into its scratch.

    before, after: positions of the Sun at both ends of the step, GCRF [m]
    """
    # The angle of the Sun above the Earth's limb [rad] at a few places.
    earth = disc = 0.0
    for place in range(_SAMPLES):
        u = place / (_SAMPLES - 1)
        x = _on_the_way(place, 0, lane, h, state, new, slopes)
        y = _on_the_way(place, 1, lane, h, state, new, slopes)
        z = _on_the_way(place, 2, lane, h, state, new, slopes)
        # The Earth's rotation is that at the end of the step: a turn about its axis changes no shadow.
        x, y, z = _turned(values, x, y, z)
        towards = _turned(
            values,
            before[0] + u * (after[0] - before[0]),
            before[1] + u * (after[1] - before[1]),
            before[2] + u * (after[2] - before[2]),
        )
        separation, earth, disc = limb(x, y, z, towards)
        scratch[place, lane] = separation - earth
    # Its cubic.
    c0 = c1 = c2 = c3 = 0.0
    for place in range(_SAMPLES):
        above = scratch[place, lane]
        c0, c1 = c0 + _CUBIC[0, place] * above, c1 + _CUBIC[1, place] * above
        c2, c3 = c2 + _CUBIC[2, place] * above, c3 + _CUBIC[3, place] * above
    # The integrals by the midpoint rule.
    m0 = m1 = m2 = m3 = 0.0
    for cell in range(_CELLS):
        u = (cell + 0.5) / _CELLS
        above = c0 + u * (c1 + u * (c2 + u * c3))
        lit, w = part_in_sight(earth + above, earth, disc), 1.0 - u
        m0, m1, m2, m3 = m0 + lit, m1 + w * lit, m2 + w * w * lit, m3 + w * w * w * lit
    scratch[_SAMPLES, lane], scratch[_SAMPLES + 1, lane] = m0 / _CELLS, m1 / _CELLS
    scratch[_SAMPLES + 2, lane], scratch[_SAMPLES + 3, lane] = m2 / _CELLS, m3 / _CELLS


@compiled
def _take_off(lane, slopes, scratch):
    """Subtract from a lane's light integrals what the Runge-Kutta stages have already counted."""
    for stage in range(STAGES):
        light = slopes[RATES * stage + LIT, lane]
        for k in range(_MOMENTS):
            scratch[_SAMPLES + k, lane] -= _COUNTED[k, stage] * light


@compiled
def _on_the_way(place, k, lane, h, state, new, slopes):
    """Return coordinate `k` of a lane's path at one of the places [m]."""
    w = _PATH[place]
    return (
        (w[0] * state[k, lane] + w[3] * new[k, lane])
        + h * (w[1] * state[k + 3, lane] + w[4] * new[k + 3, lane])
        + h * h * (w[2] * slopes[k + 3, lane] + w[5] * slopes[_LAST + k + 3, lane])
    )


@compiled
def _turned(values, x, y, z):
    r = values[ROTATION : ROTATION + 9]
    return (
        r[0] * x + r[1] * y + r[2] * z,
        r[3] * x + r[4] * y + r[5] * z,
        r[6] * x + r[7] * y + r[8] * z,
    )
