"""Many arcs of orbits advanced together on one clock.

All arcs share a grid of times: the epochs at which any state is wanted, and even steps between
them that are no longer than the integrator's ceiling. So what depends on time alone is looked up
once for all, and nothing is interpolated. An arc joins the grid at its first epoch and leaves it at
its last. One whose own error estimate fails a step repeats that step alone in smaller ones; one
that decays or loses its numbers is retired with its reason. So no arc's result depends on the others.
"""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import NamedTuple

import numba
import numpy as np

from opml.dynamics import dop853
from opml.dynamics.dtm2000 import LOWEST_ALTITUDE
from opml.dynamics.forces import SCRATCH_ROWS
from opml.dynamics.lanes import OPTIONS, WIDTH, compiled, lanes_set, load, rows, store
from opml.dynamics.surroundings import Tables, blank, look_up

REASONS = ("", "decayed below 120 km", "state not finite", "step below the minimum")
"""Why an arc was retired, by its status; the first says that it was not."""

_FLYING, _DECAYED, _NOT_FINITE, _STEP_TOO_SMALL = range(4)
_FARTHEST = 1e12
"""Distance [m] beyond which an arc's numbers are taken as lost."""


@dataclass(frozen=True)
class Integrator:
    """Settings of the Dormand-Prince 8(5,3) method: tolerance [m] and step limits [s]."""

    position_tolerance: float = 0.1
    min_step: float = 0.001
    max_step: float = 90.0


@dataclass(frozen=True)
class Arcs:
    """States of propagated arcs: arc k passes its epochs in states[start[k]:start[k + 1]].

    states: (total, 6) GCRF [m, m/s], not finite past an arc's retirement; start: (arcs + 1,);
    status: (arcs,) an index into REASONS.
    """

    states: np.ndarray
    start: np.ndarray
    status: np.ndarray

    def of(self, arc: int) -> np.ndarray:
        """States of one arc, from the epoch after its first to its last: (epochs, 6)."""
        return self.states[self.start[arc] : self.start[arc + 1]]


def propagate(
    tables: Tables,
    epochs: np.ndarray,
    states: np.ndarray,
    *,
    first: np.ndarray,
    last: np.ndarray,
    ballistic: np.ndarray,
    reflection: np.ndarray,
    integrator: Integrator,
    threads: int = 1,
    progress: Callable[[float], None] | None = None,
) -> Arcs:
    """Propagate arcs between epochs that they share.

    tables: the force model, from `forces.build`; epochs: (n,) times at which states are wanted [s],
    all ascending, or all descending for arcs backward in time; states: (arcs, 6) GCRF [m, m/s];
    first, last: (arcs,) index of the epoch at which an arc begins and ends, first <= last;
    ballistic: (arcs,) Cd A/m, reflection: (arcs,) Cr A/m [m2/kg]; progress: called with the share
    of arcs done. Returns Arcs with the states at epochs first + 1 to last of each arc.
    """
    first, last = np.asarray(first, np.int64), np.asarray(last, np.int64)
    times, index_of_epoch = _grid(np.asarray(epochs, float), integrator.max_step)
    start = np.concatenate([[0], np.cumsum(last - first)])
    out = np.full((start[-1], 6), np.nan)
    status = np.zeros(len(first), np.int64)
    wanted = np.zeros(len(times), np.bool_)
    wanted[index_of_epoch] = True
    # Arcs that fly at the same time share a block, so that few of its lanes stand idle.
    order = np.lexsort((last, first))
    blocks = [order[k : k + WIDTH] for k in range(0, len(order), WIDTH)]

    def run(members):
        block = _Block(members, states, ballistic, reflection)
        join, leave = index_of_epoch[first[block.lanes]], index_of_epoch[last[block.lanes]]
        offsets = start[block.lanes]
        found = np.zeros(WIDTH, np.int64)
        _advance(
            tables,
            times,
            wanted,
            block.state,
            block.coefficients,
            join,
            np.where(block.used, leave, join),
            offsets,
            out,
            found,
            integrator.position_tolerance,
            integrator.min_step,
            _workspace(tables),
        )
        status[members] = found[: len(members)]
        return len(members)

    done = 0
    with ThreadPoolExecutor(threads) as pool:
        for count in pool.map(run, blocks):
            done += count
            if progress:
                progress(done / len(first))
    return Arcs(out, start, status)


class _Block:
    """Arcs side by side in the lanes of one block; spare lanes repeat the first arc and do not fly."""

    def __init__(self, members, states, ballistic, reflection):
        self.lanes = np.concatenate([members, np.repeat(members[:1], WIDTH - len(members))])
        self.used = np.arange(WIDTH) < len(members)
        self.state, self.coefficients = rows(6), rows(2)
        self.state[:] = np.asarray(states, float)[self.lanes].T
        self.coefficients[0] = np.asarray(ballistic, float)[self.lanes]
        self.coefficients[1] = np.asarray(reflection, float)[self.lanes]


class _Workspace(NamedTuple):
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


def _workspace(tables):
    values, factors = blank(tables)
    slopes = 6 * (dop853.STAGES + 1)
    return _Workspace(
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


def _grid(epochs, max_step):
    """Times from the first epoch to the last, in even steps of at most max_step between epochs [s]."""
    gaps = np.diff(epochs)
    counts = np.maximum(np.ceil(np.abs(gaps) / max_step - 1e-9), 1).astype(np.int64)
    index = np.concatenate([[0], np.cumsum(counts)])
    within = np.arange(index[-1]) - np.repeat(index[:-1], counts)
    times = np.repeat(epochs[:-1], counts) + within * np.repeat(gaps / counts, counts)
    return np.append(times, epochs[-1]), index


@numba.njit(cache=True, **OPTIONS)
def _advance(
    tables, times, wanted, state, coefficients, join, leave, offsets, out, status, tolerance, min_step, work
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
            look_up(t, tables, values, factors)
            # Through rows that the step will overwrite: the lanes in flight keep the slopes they have.
            dop853.derivative(state, 0, tables, coefficients, values, factors, scratch, slopes, 6)
            for lane in range(WIDTH):
                if join[lane] == g:
                    for k in range(6):
                        slopes[k, lane] = slopes[6 + k, lane]
        altitude = dop853.step(t, h, state, new, tables, coefficients, values, factors, scratch, slopes)
        store(work.height, 0, altitude)
        ratio = dop853.error(h, new, slopes, tolerance, tables.gm)
        good = lanes_set(ratio < 1.0)
        for lane in range(WIDTH):
            if not (active >> lane) & 1:
                continue
            if not (good >> lane) & 1:
                status[lane] = _repeat_in_smaller_steps(
                    lane, t, h, state, tables, coefficients, tolerance, min_step, work
                )
            elif not work.height[0, lane] < _FARTHEST:
                status[lane] = _NOT_FINITE
            elif work.height[0, lane] < LOWEST_ALTITUDE:
                status[lane] = _DECAYED
            if status[lane] != _FLYING:
                continue
            for k in range(6):
                state[k, lane] = new[k, lane]
                slopes[k, lane] = slopes[6 * dop853.STAGES + k, lane]
            if wanted[g + 1]:
                for k in range(6):
                    out[offsets[lane] + work.passed[lane], k] = state[k, lane]
                work.passed[lane] += 1


@compiled
def _repeat_in_smaller_steps(lane, t, h, state, tables, coefficients, tolerance, min_step, work):
    """Fly one arc over a grid step in steps of its own; its end replaces the lane in new and slopes.

    The arc fills all lanes of a block of its own. Returns the arc's status.
    """
    values, factors, scratch = work.values, work.factors, work.scratch
    solo, new, slopes, own = work.solo, work.solo_new, work.solo_slopes, work.solo_coefficients
    for other in range(WIDTH):
        for k in range(6):
            solo[k, other] = state[k, lane]
            slopes[k, other] = work.slopes[k, lane]
        own[0, other], own[1, other] = coefficients[0, lane], coefficients[1, lane]
    end = t + h
    trial = 0.5 * h
    while True:
        last = abs(end - t) <= abs(trial) * (1.0 + 1e-9)
        if last:
            trial = end - t
        altitude = dop853.step(t, trial, solo, new, tables, own, values, factors, scratch, slopes)
        store(work.solo_result, 0, altitude)
        store(work.solo_result, 1, dop853.error(trial, new, slopes, tolerance, tables.gm))
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
            store(slopes, k, load(slopes, 6 * dop853.STAGES + k))
    for k in range(6):
        work.new[k, lane] = new[k, 0]
        work.slopes[6 * dop853.STAGES + k, lane] = slopes[6 * dop853.STAGES + k, 0]
    return _FLYING
