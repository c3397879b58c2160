"""Orbits from the same start under the same forces: converged, and at the paper's settings."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from opml.catalog.truth import STATE, initial_state
from opml.constants import DAY
from opml.dynamics.ensemble import Integrator
from opml.dynamics.surroundings import Tables
from validation import ours
from validation.case import OREKITS_CONVERGED, Case

if TYPE_CHECKING:
    from validation.orekit import Orekit

DAYS = {"assumed": [1, 2, 7], "truth": [1, 2, 7, 20, 50]}
"""Days after the epoch at which the states are taken, by force model."""

CONVERGED, PAPER = "converged", "paper"
KEYS = ["rso", "model", "integrator", "day"]


@dataclass(frozen=True)
class Bound:
    """How far the two sides may be apart [m]."""

    model: str
    day: int
    metres: float


BOUNDS = [Bound("assumed", 7, 1.0), Bound("truth", 7, 1.0), Bound("truth", 50, 100.0)]


def orekits(orekit: "Orekit", case: Case, gm: float, *, progress: Callable[[str], None]) -> pd.DataFrame:
    """Orekit's states (KEYS, GCRF state) of every RSO."""
    rows = []
    for name, rso in case.rsos.items():
        for model, settings in case.force_models.items():
            for kind, integrator in {CONVERGED: OREKITS_CONVERGED, PAPER: case.integrator}.items():
                progress(f"Orekit flies {name}, {model} model, {kind} settings")
                t = DAY * np.array(DAYS[model])
                forces = orekit.forces(settings, rso)
                flown = orekit.propagate(initial_state(rso, gm), gm, t, forces, integrator)
                rows += _rows(name, model, kind, flown)
    return pd.DataFrame(rows)


def opmls(case: Case, models: Mapping[str, Tables], integrators: Mapping[str, Integrator]) -> pd.DataFrame:
    """Our states (KEYS, GCRF state) of every RSO under force models by name, with integrators by name."""
    rsos = list(case.rsos.values())
    rows = []
    for model, tables in models.items():
        starts = np.array([initial_state(rso, tables.gm) for rso in rsos])
        for kind, integrator in integrators.items():
            flown = ours.fly(tables, rsos, starts, DAY * np.array(DAYS[model]), integrator)
            for rso, states in zip(rsos, flown, strict=True):
                rows += _rows(rso.name, model, kind, states)
    return pd.DataFrame(rows)


def _rows(rso, model, kind, states):
    return [
        {**dict(zip(KEYS, [rso, model, kind, day], strict=True)), **dict(zip(STATE, state, strict=True))}
        for day, state in zip(DAYS[model], states, strict=True)
    ]


def apart(one: pd.DataFrame, other: pd.DataFrame, keys: list[str]) -> pd.Series:
    """Distance [m] between the states of two tables that share `keys`, by these."""
    both = one.merge(other, on=keys, suffixes=("", "_other"))
    across = both[STATE[:3]].to_numpy() - both[[f"{axis}_other" for axis in STATE[:3]]].to_numpy()
    return pd.Series(np.linalg.norm(across, axis=1), index=pd.MultiIndex.from_frame(both[keys]))


def own_uncertainty(states: pd.DataFrame) -> pd.Series:
    """Distance [m] of one side's states at the paper's settings from its converged ones."""
    kinds = {kind: part.drop(columns="integrator") for kind, part in states.groupby("integrator")}
    return apart(kinds[PAPER], kinds[CONVERGED], ["rso", "model", "day"])
