"""One block of arcs flown along a grid of times: the kernel under `ensemble`."""

from typing import NamedTuple

import numpy as np

from opml.dynamics.kernels import dop853
from opml.dynamics.kernels.acceleration import SCRATCH_ROWS
from opml.dynamics.kernels.dtm2000 import LOWEST_ALTITUDE
from opml.dynamics.kernels.lanes import WIDTH, compiled, entry, lanes_set, load, rows, store
from opml.dynamics.kernels.shadow_edges import RATES
from opml.dynamics.kernels.surroundings import ForceModel, blank, look_up

REASONS = ("", "decayed below 120 km", "state not finite", "step below the minimum")
"""Why an arc was retired, by its status; the first says that it was not."""

_FLYING, _DECAYED, _NOT_FINITE, _STEP_TOO_SMALL = range(4)
_FARTHEST = 1e12
"""Distance [m] beyond which an arc's numbers are taken as lost."""


class Workspace(NamedTuple):
    """Room for what the kernels put down while they fly a block."""

    values: np.ndarray  # of the surroundings
    factors: np.ndarray
    scratch: np.ndarray
    new: np.ndarray  # state at the end of a step
    slopes: np.ndarray
    height: np.ndarray  # altitude [m]
    solo: np.ndarray  # the same for an arc that flies a step alone
    solo_new: np.ndarray
    solo_slopes: np.ndarray
    solo_coefficients: np.ndarray
    solo_result: np.ndarray  # altitude [m] and error ratio
    passed: np.ndarray  # epochs that each lane has passed


def workspace(model: ForceModel) -> Workspace:
    """Room for one block under a force model."""
    values, factors = blank(model)
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
        solo_coefficients=rows(2),
        solo_result=rows(2),
        passed=np.zeros(WIDTH, np.int64),
    )


@entry
def advance(
    model, times, wanted, state, coefficients, join, leave, offsets, out, status, tolerance, min_step, work
):
    """Fly one block along the grid from its first lane's joining to its last one's leaving."""
    values, factors, scratch, new, slopes = work.values, work.factors, work.scratch, work.new, work.slopes
    begin, end = join[0], leave[0]
    for lane in range(WIDTH):
        begin, end = min(begin, join[lane]), max(end, leave[lane])
    for g in range(begin, end):
        t, h = times[g], times[g + 1] - times[g]
        active = 0
        joining = False
        for lane in range(WIDTH):
            if join[lane] <= g < leave[lane] and status[lane] == _FLYING:
                active |= 1 << lane
                joining |= join[lane] == g
        if active == 0:
            continue
        if joining:
            look_up(t, model, values, factors)
            # Through rows that the step will overwrite: the lanes in flight keep the slopes they have.
            dop853.derivative(state, 0, model, coefficients, values, factors, scratch, slopes, RATES)
            for lane in range(WIDTH):
                if join[lane] == g:
                    for k in range(RATES):
                        slopes[k, lane] = slopes[RATES + k, lane]
        altitude = dop853.step(t, h, state, new, model, coefficients, values, factors, scratch, slopes)
        store(work.height, 0, altitude)
        ratio = dop853.error(h, new, slopes, tolerance, model.gm)
        good = lanes_set(ratio < 1.0)
        for lane in range(WIDTH):
            if not (active >> lane) & 1:
                continue
            if not (good >> lane) & 1:
                status[lane] = _repeat_in_smaller_steps(
                    lane, t, h, state, model, coefficients, tolerance, min_step, work
                )
            elif not work.height[0, lane] < _FARTHEST:
                status[lane] = _NOT_FINITE
            elif work.height[0, lane] < LOWEST_ALTITUDE:
                status[lane] = _DECAYED
            if status[lane] != _FLYING:
                continue
            for k in range(6):
                state[k, lane] = new[k, lane]
            for k in range(RATES):
                slopes[k, lane] = slopes[RATES * dop853.STAGES + k, lane]
            if wanted[g + 1]:
                for k in range(6):
                    out[offsets[lane] + work.passed[lane], k] = state[k, lane]
                work.passed[lane] += 1


@compiled
def _repeat_in_smaller_steps(lane, t, h, state, model, coefficients, tolerance, min_step, work):
    """Fly one arc over a grid step in steps of its own; its end replaces the lane in new and slopes.

    The arc fills all lanes of a block of its own. Returns the arc's status.
    """
    values, factors, scratch = work.values, work.factors, work.scratch
    solo, new, slopes, own = work.solo, work.solo_new, work.solo_slopes, work.solo_coefficients
    for other in range(WIDTH):
        for k in range(6):
            solo[k, other] = state[k, lane]
        for k in range(RATES):
            slopes[k, other] = work.slopes[k, lane]
        own[0, other], own[1, other] = coefficients[0, lane], coefficients[1, lane]
    end = t + h
    trial = 0.5 * h
    while True:
        last = abs(end - t) <= abs(trial) * (1.0 + 1e-9)
        if last:
            trial = end - t
        altitude = dop853.step(t, trial, solo, new, model, own, values, factors, scratch, slopes)
        store(work.solo_result, 0, altitude)
        store(work.solo_result, 1, dop853.error(trial, new, slopes, tolerance, model.gm))
        high, ratio = work.solo_result[0, 0], work.solo_result[1, 0]
        factor = min(max(0.9 * ratio ** (-1.0 / dop853.ORDER_OF_ERROR), 0.2), 5.0) if ratio == ratio else 0.2
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
        t += trial
        trial = min(abs(trial) * factor, abs(h)) * (1.0 if h > 0.0 else -1.0)
        for k in range(6):
            store(solo, k, load(new, k))
        for k in range(RATES):
            store(slopes, k, load(slopes, RATES * dop853.STAGES + k))
    for k in range(6):
        work.new[k, lane] = new[k, 0]
    for k in range(RATES):
        work.slopes[RATES * dop853.STAGES + k, lane] = slopes[RATES * dop853.STAGES + k, 0]
    return _FLYING
