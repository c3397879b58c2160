"""Many arcs of orbits advanced together on one clock.

All arcs share a grid of times: the epochs at which any state is wanted, the jumps of the force
model, and even steps between them that are no longer than the integrator's ceiling. So what depends
on time alone is looked up once for all, and nothing is interpolated. An arc joins the grid at its
first epoch and leaves it at its last. An arc whose error is too large in a step repeats that step
alone in smaller ones; an arc that decays or loses its numbers is retired with its reason. So no
arc's result depends on the others.

Where the force model has outlooks, each arc is propagated under the newest at its first epoch, so that no arc
knows what was measured later. Arcs under several outlooks share blocks: only their density differs.
"""

import logging
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from opml.base.constants import DAY
from opml.dynamics.kernels.block import REASONS as REASONS, advance, workspace
from opml.dynamics.kernels.lanes import WIDTH, rows
from opml.dynamics.kernels.surroundings import ForceModel
from opml.dynamics.settings import Integrator

_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Departures:
    """Arcs as they begin, and how far they go."""

    states: ArrayLike  # (arcs, 6) GCRF [m, m/s]
    first: ArrayLike  # (arcs,) index of the epoch at which an arc begins
    last: ArrayLike  # (arcs,) index of that at which it ends, first or later
    ballistic: ArrayLike  # (arcs,) Cd A/m [m2/kg]
    reflection: ArrayLike  # (arcs,) Cr A/m [m2/kg]
    outlook: np.ndarray | None = None  # (arcs,) index, -1: the model's activity; None: the newest it knows

    def __len__(self) -> int:
        """Return the number of the arcs."""
        return len(np.asarray(self.first))

    def outlooks(self, model: ForceModel, epochs: np.ndarray) -> np.ndarray:
        """Return the outlook (arcs,) of a model that each arc is propagated under; epochs: (n,) [s]."""
        newest = model.newest_outlook(epochs[np.asarray(self.first)])
        return newest if self.outlook is None else self.outlook


@dataclass(frozen=True)
class Arcs:
    """States of propagated arcs: arc k passes its epochs in states[start[k]:start[k + 1]]."""

    states: np.ndarray  # (total, 6) GCRF [m, m/s], not finite past an arc's retirement
    start: np.ndarray  # (arcs + 1,)
    status: np.ndarray  # (arcs,) an index into REASONS

    def path(self, arc: int) -> np.ndarray:
        """Return the states (epochs, 6) of one arc, from the epoch after its first to its last."""
        return self.states[self.start[arc] : self.start[arc + 1]]


def propagate(
    model: ForceModel,
    epochs: ArrayLike,
    departures: Departures,
    *,
    integrator: Integrator,
    threads: int = 1,
    progress: Callable[[float], None] | None = None,
) -> Arcs:
    """Propagate arcs between epochs that they share, and return their states there.

    epochs: (n,) times at which states are wanted [s], all ascending, or all descending for arcs backward in
    time
    progress: called with the share of arcs done
    """
    epochs = np.asarray(epochs, float)
    first, last = np.asarray(departures.first, np.int64), np.asarray(departures.last, np.int64)
    if np.array_equal(first, last):
        return Arcs(np.empty((0, 6)), np.zeros(len(first) + 1, np.int64), np.zeros(len(first), np.int64))
    times, index = _grid(epochs, model.jumps(epochs[0], epochs[-1]), integrator.max_step_s)
    is_wanted = np.zeros(len(times), np.bool_)
    is_wanted[index] = True
    states = np.asarray(departures.states, float)
    coefficients = np.array([departures.ballistic, departures.reflection], float)
    start = np.concatenate([[0], np.cumsum(last - first)])
    arcs = Arcs(np.full((start[-1], 6), np.nan), start, np.zeros(len(first), np.int64))
    outlook = departures.outlooks(model, epochs)
    if not is_loaded() and not any(Path(advance.stats.cache_path).glob("*.nbi")):
        _log.warning("the force model is compiled, once for each version: ten seconds")

    def propagate(members: np.ndarray) -> int:
        """Propagate one block; spare lanes repeat its first arc and leave where they join."""
        kinds, kind = np.unique(outlook[members], return_inverse=True)
        block, spare = model.for_block(kinds), WIDTH - len(members)
        lanes = np.concatenate([members, np.repeat(members[:1], spare)])
        is_used = np.arange(WIDTH) < len(members)
        state, own, status = rows(6), rows(3), np.zeros(WIDTH, np.int64)
        state[:], own[:2] = states[lanes].T, coefficients[:, lanes]
        own[2] = np.concatenate([kind, np.repeat(kind[:1], spare)])
        advance(
            block,
            times,
            is_wanted,
            state,
            own,
            index[first[lanes]],
            index[np.where(is_used, last[lanes], first[lanes])],
            start[lanes],
            arcs.states,
            status,
            integrator.position_tolerance_m,
            integrator.min_step_s,
            workspace(block),
        )
        arcs.status[members] = status[: len(members)]
        return len(members)

    done = 0
    with ThreadPoolExecutor(threads) as pool:
        # Arcs of a block are about as long, under few outlooks, and of the same time, so that few lanes idle.
        order = np.lexsort((last, first, outlook, np.abs(epochs[last] - epochs[first]) // DAY))
        for count in pool.map(propagate, (order[k : k + WIDTH] for k in range(0, len(order), WIDTH))):
            done += count
            if progress:
                progress(done / len(first))
    return arcs


def is_loaded() -> bool:
    """Return whether the kernels are compiled, or read, by an earlier call."""
    return bool(advance.signatures)


def _grid(epochs: np.ndarray, jumps: np.ndarray, max_step: float) -> tuple[np.ndarray, np.ndarray]:
    """Return times [s] from the first epoch to the last, and the index (n,) of each epoch among them.

    They are in even steps of at most max_step between nodes: the epochs, and the times about the force
    model's jumps, so that no step has a jump in it.
    """
    nodes = np.concatenate([epochs, np.setdiff1d(jumps, epochs)])
    order = np.argsort(nodes if epochs[0] <= epochs[-1] else -nodes, kind="stable")
    gaps = np.diff(nodes[order])
    counts = np.maximum(np.ceil(np.abs(gaps) / max_step - 1e-9), 1).astype(np.int64)
    at = np.concatenate([[0], np.cumsum(counts)])
    within = np.arange(at[-1]) - np.repeat(at[:-1], counts)
    times = np.repeat(nodes[order[:-1]], counts) + within * np.repeat(gaps / counts, counts)
    return np.append(times, epochs[-1]), at[np.argsort(order)[: len(epochs)]]
