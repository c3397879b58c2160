"""The edges of umbra and penumbra, and the light between them."""

from collections.abc import Callable, Iterator
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd
from scipy.interpolate import CubicHermiteSpline

from opml.base.constants import HOUR
from opml.catalog.simulate.truth import initial_state
from opml.dynamics.kernels.surroundings import ForceModel
from opml.tables import STATE
from validation import ours
from validation.case import Case

if TYPE_CHECKING:
    from validation.orekit import Orekit

STEP = 20.0
LENGTH = 4.0 * HOUR
"""Grid [s] on which edges are looked for, and how long after each start; a LAGEOS goes round in 3.8 h."""

_PRECISION = 1e-4
_WITHIN = (0.25, 0.5, 0.75)
"""Where in the penumbra the light is compared, from sunlight to umbra."""

SAMPLES = len(_WITHIN) + 2
"""Times at which the light of one penumbra is kept: also a second outside it on either side."""


def crossings(
    orekit: "Orekit", case: Case, truth: ForceModel, starts: np.ndarray
) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Return penumbras crossed within LENGTH after times `starts`, as each side sees them on the same path.

    Returns the edges (rso, edge, t_orekit, t_ours [s]) and the light in between and a second outside
    (rso, t, GCRF state, lit_orekit, lit_ours).
    """
    grid = np.concatenate([start + np.arange(0.0, LENGTH, STEP) for start in starts])
    rsos = list(case.rsos.values())
    first = np.array([initial_state(rso, truth.gm) for rso in rsos])
    flown = ours.fly(truth, rsos, first, grid, case.integrator)
    edges, light = [], []
    for rso, states in zip(rsos, flown, strict=True):
        for piece in np.split(np.arange(len(grid)), len(starts)):
            stretch = _Stretch(orekit, truth, rso, grid[piece], states[piece])
            for sunlight, umbra in stretch.penumbras():
                edges += [
                    {"rso": rso.name, "edge": "sunlight", **sunlight},
                    {"rso": rso.name, "edge": "umbra", **umbra},
                ]
                light += stretch.light(sunlight["t_orekit"], umbra["t_orekit"])
    return pd.DataFrame(edges), pd.DataFrame(light)


class _Stretch:
    """One stretch of an orbit, and the light on it by either side."""

    def __init__(self, orekit, truth, rso, t, states):
        self.orekit, self.truth, self.rso, self.t = orekit, truth, rso, t
        self.path = CubicHermiteSpline(t, states[:, :3], states[:, 3:])
        self.pressure = orekit.radiation_pressure(rso)

    def state(self, t: float) -> np.ndarray:
        """Return the GCRF state (6,) on the path."""
        return np.append(self.path(t), self.path(t, 1))

    def by_orekit(self, t: float) -> float:
        """Return the part of the Sun in sight, by Orekit."""
        return self.pressure.getLightingRatio(self.orekit.spacecraft(t, self.state(t), self.truth.gm))

    def by_opml(self, t: float) -> float:
        """Return the part of the Sun in sight, by opml."""
        return ours.terms(self.truth, t, self.state(t), self.rso)["lit"]

    def penumbras(self) -> Iterator[tuple[dict, dict]]:
        """Return the edges towards sunlight and the umbra of each penumbra that is crossed to its end."""
        lit = np.array([self.by_opml(t) for t in self.t])
        whole = np.flatnonzero((lit >= 1.0) | (lit <= 0.0))
        for one, other in pairwise(whole):
            if lit[one] != lit[other]:
                bright, dark = self.t[[one, other] if lit[one] > lit[other] else [other, one]]
                yield self._edge(_is_dimmed, bright, dark), self._edge(_is_dark, bright, dark)

    def _edge(self, is_past: Callable[[float], bool], bright: float, dark: float) -> dict[str, float]:
        """Return when each side sees `is_past` of the light come true between two times [s]."""
        return {
            "t_orekit": _change(lambda t: is_past(self.by_orekit(t)), bright, dark),
            "t_ours": _change(lambda t: is_past(self.by_opml(t)), bright, dark),
        }

    def light(self, sunlight: float, umbra: float) -> list[dict]:
        """Return the light within a penumbra and a second outside it, by either side."""
        outwards = np.sign(sunlight - umbra)
        times = [
            sunlight + outwards,
            *(sunlight + part * (umbra - sunlight) for part in _WITHIN),
            umbra - outwards,
        ]
        return [
            {
                "rso": self.rso.name,
                "t": t,
                **dict(zip(STATE, self.state(t), strict=True)),
                "lit_orekit": self.by_orekit(t),
                "lit_ours": self.by_opml(t),
            }
            for t in times
        ]


def _is_dimmed(lit: float) -> bool:
    return lit < 1.0


def _is_dark(lit: float) -> bool:
    return lit <= 0.0


def _change(holds: Callable[[float], bool], low: float, high: float) -> float:
    """Return the time [s] at which `holds` turns true between low and high, by bisection."""
    while abs(high - low) > _PRECISION:
        middle = 0.5 * (low + high)
        if holds(middle):
            high = middle
        else:
            low = middle
    return 0.5 * (low + high)
