"""Propagation of a block of arcs along a grid of times, the kernel below `opml.dynamics.ensemble`."""

from typing import NamedTuple

import numpy as np

from opml.dynamics.kernels import dop853
from opml.dynamics.kernels.acceleration import SCRATCH_ROWS
from opml.dynamics.kernels.dtm2000 import LOWEST_ALTITUDE
from opml.dynamics.kernels.lanes import WIDTH, compiled, entry, lanes_set, load, rows, store
from opml.dynamics.kernels.shadow_edges import RATES
from opml.dynamics.kernels.surroundings import ForceModel, allocate, look_up

REASONS = ("", "decayed below 120 km", "state not finite", "step below the minimum")
"""Reasons for retiring an arc, by its status; the first one stands for an arc in progress."""

_FLYING, _DECAYED, _NOT_FINITE, _STEP_TOO_SMALL = range(4)
_FARTHEST = 1e12  # altitude [m] above which an arc's numbers count as lost


class Workspace(NamedTuple):
    """Memory for the intermediate results of a block's propagation; rows have WIDTH lanes."""

    values: np.ndarray  # of the surroundings
    factors: np.ndarray  # of DTM2000
    scratch: np.ndarray  # (SCRATCH_ROWS, WIDTH)
    new: np.ndarray  # (6, WIDTH) states at the end of a step
    slopes: np.ndarray  # rates of a step's stages and of its end, RATES rows each
    height: np.ndarray  # (1, WIDTH) altitudes [m]
    solo: np.ndarray  # (6, WIDTH) state of an arc that repeats a step alone, in all lanes
    solo_new: np.ndarray  # its state at the end of a step
    solo_slopes: np.ndarray  # its rates
    solo_coefficients: np.ndarray  # (3, WIDTH) its Cd A/m and Cr A/m [m2/kg], kind of activity
    solo_result: np.ndarray  # (2, WIDTH) its altitude [m] and error ratio
    passed: np.ndarray  # (WIDTH,) number of states that each lane has put out


def workspace(model: ForceModel) -> Workspace:
    """Return the memory for one block under a force model."""
    values, factors = allocate(model)
    slopes = RATES * (dop853.STAGES + 1)
    return Workspace(
        values=values,
        factors=factors,
        scratch=rows(SCRATCH_ROWS),
        new=rows(6),
        slopes=rows(slopes),
        height=rows(1),
        solo=rows(6),
        solo_new=rows(6),
        solo_slopes=rows(slopes),
        solo_coefficients=rows(3),
        solo_result=rows(2),
        passed=np.zeros(WIDTH, np.int64),
    )


@entry
def advance(
    model, times, wanted, state, bodies, join, leave, offsets, out, status, tolerance, min_step, work
):
    """Propagate the lanes of a block along the grid, each from where it joins to where it leaves.

    times: (n,) of the grid [s], ascending or descending
    wanted: (n,) whether to put out the states at each time
    state: (6, WIDTH) GCRF [m, m/s], at the lanes' first times; takes those at their last times
    bodies: (3, WIDTH) Cd A/m and Cr A/m [m2/kg], kind of activity
    join: (WIDTH,) indices of the lanes' first times
    leave: (WIDTH,) indices of the lanes' last times; a lane that leaves where it joins stays idle
    offsets: (WIDTH,) first rows of the lanes in `out`
    out: (total, 6) takes the states at the wanted times after the first, GCRF [m, m/s]
    status: (WIDTH,) indices into REASONS, 0 at first; takes the reason of a retired lane
    tolerance: error of a position component over a step [m]
    min_step: shortest step of a lane that repeats a step alone [s]
    work: memory for one block
    """
    _advance(
        model, times, wanted, state, bodies, join, leave, offsets, out, status, tolerance, min_step, work
    )


@compiled  # what an entry itself calls is compiled for it alone, under its own flags
def _advance(
    model, times, wanted, state, bodies, join, leave, offsets, out, status, tolerance, min_step, work
):
    values, factors, scratch, new, slopes = work.values, work.factors, work.scratch, work.new, work.slopes
    # The part of the grid on which any lane is propagated.
    begin, end = join[0], leave[0]
    for lane in range(WIDTH):
        begin, end = min(begin, join[lane]), max(end, leave[lane])
    for g in range(begin, end):
        t, h = times[g], times[g + 1] - times[g]
        # Arrivals: the lanes that are propagated this step, as bits, and whether one of them joins here.
        active = 0
        joining = False
        model.flown[:] = False
        for lane in range(WIDTH):
            if join[lane] <= g < leave[lane] and status[lane] == _FLYING:
                active |= 1 << lane
                joining |= join[lane] == g
                model.flown[int(bodies[2, lane])] = True
        if active == 0:
            continue
        # Refill: rates at the beginning, for lanes that join. Others have theirs from the end of the
        # last step, so the rates of all lanes go to rows that the step will overwrite, and are copied.
        if joining:
            look_up(t, model, values, factors)
            dop853.derivative(state, model, bodies, values, factors, scratch, slopes[RATES:])
            for lane in range(WIDTH):
                if join[lane] == g:
                    for k in range(RATES):
                        slopes[k, lane] = slopes[RATES + k, lane]
        # Step and error, of all lanes at once; those of idle and retired lanes are ignored.
        altitude = dop853.step(t, h, state, new, model, bodies, values, factors, scratch, slopes)
        store(work.height, 0, altitude)
        ratio = dop853.error(h, new, slopes, tolerance, model.gm)
        good = lanes_set(ratio < 1.0)
        for lane in range(WIDTH):
            if not (active >> lane) & 1:
                continue
            # Retirement, for a lane whose error is too large also in smaller steps, or whose orbit is lost.
            # `not ... <` is true of NaN, too.
            if not (good >> lane) & 1:
                status[lane] = _repeat_in_smaller_steps(
                    lane, t, h, state, model, bodies, tolerance, min_step, work
                )
            elif not work.height[0, lane] < _FARTHEST:
                status[lane] = _NOT_FINITE
            elif work.height[0, lane] < LOWEST_ALTITUDE:
                status[lane] = _DECAYED
            if status[lane] != _FLYING:
                continue
            # The end of the step, with its rates, begins the next one.
            for k in range(6):
                state[k, lane] = new[k, lane]
            for k in range(RATES):
                slopes[k, lane] = slopes[RATES * dop853.STAGES + k, lane]
            # Output.
            if wanted[g + 1]:
                for k in range(6):
                    out[offsets[lane] + work.passed[lane], k] = state[k, lane]
                work.passed[lane] += 1


@compiled
def _repeat_in_smaller_steps(lane, t, h, state, model, coefficients, tolerance, min_step, work):
    """Repeat a step of the grid for one lane in smaller steps, and return the lane's status.

    lane: index of the lane
    state, coefficients: of all lanes, as `state` and `bodies` in `advance`
    model, tolerance, min_step, work: as in `advance`

    The arc fills all lanes of a second block. State and rates at its end replace those of the lane in `work`.
    """
    values, factors, scratch = work.values, work.factors, work.scratch
    solo, new, slopes, solo_body = work.solo, work.solo_new, work.solo_slopes, work.solo_coefficients
    # The arc into all lanes.
    for other in range(WIDTH):
        for k in range(6):
            solo[k, other] = state[k, lane]
        for k in range(RATES):
            slopes[k, other] = work.slopes[k, lane]
        for k in range(3):
            solo_body[k, other] = coefficients[k, lane]
    end = t + h
    trial = 0.5 * h
    while True:
        # A step that reaches the end but for rounding ends there.
        last = abs(end - t) <= abs(trial) * (1.0 + 1e-9)
        if last:
            trial = end - t
        altitude = dop853.step(t, trial, solo, new, model, solo_body, values, factors, scratch, slopes)
        store(work.solo_result, 0, altitude)
        store(work.solo_result, 1, dop853.error(trial, new, slopes, tolerance, model.gm))
        high, ratio = work.solo_result[0, 0], work.solo_result[1, 0]
        # The step that would just do, less a margin, as a multiple of this one, from a fifth to five times; a
        # fifth for NaN, which alone differs from itself.
        factor = min(max(0.9 * ratio ** (-1.0 / dop853.ORDER_OF_ERROR), 0.2), 5.0) if ratio == ratio else 0.2
        # Again from the same time, in a shorter step.
        if not ratio < 1.0:
            trial *= factor
            if abs(trial) < min_step:
                return _STEP_TOO_SMALL
            continue
        if not high < _FARTHEST:
            return _NOT_FINITE
        if high < LOWEST_ALTITUDE:
            return _DECAYED
        if last:
            break
        # On to the next step, at most as long as the grid's and in its direction.
        t += trial
        trial = min(abs(trial) * factor, abs(h)) * (1.0 if h > 0.0 else -1.0)
        for k in range(6):
            store(solo, k, load(new, k))
        for k in range(RATES):
            store(slopes, k, load(slopes, RATES * dop853.STAGES + k))
    # Back into the lane.
    for k in range(6):
        work.new[k, lane] = new[k, 0]
    for k in range(RATES):
        work.slopes[RATES * dop853.STAGES + k, lane] = slopes[RATES * dop853.STAGES + k, 0]
    return _FLYING
