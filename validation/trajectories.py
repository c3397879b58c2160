"""Orbits from the same start under the same forces: converged, and at the paper's settings."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from opml.base.constants import DAY
from opml.catalog.simulate.truth import initial_state
from opml.dynamics.kernels.surroundings import ForceModel
from opml.dynamics.settings import Integrator
from opml.tables import STATE
from validation import ours
from validation.case import OREKITS_CONVERGED, PRECISE, Case

if TYPE_CHECKING:
    from concurrent.futures import Future

    from validation.workers import Workers

DAYS = {"assumed": [1, 2, 7], "truth": [1, 2, 7, 20, 50], PRECISE: [1, 2, 7]}
"""Days after the epoch at which the states are taken, by force model."""

CONVERGED, HALVED, PAPER = "converged", "halved", "paper"
"""Settings of the integrator; `halved` says how far the converged ones are from the limit."""

CHECKED = "iss"
"""The RSO of which Orekit flies the halved steps, too: the lowest, hence the most sensitive."""

KEYS = ["rso", "model", "integrator", "day"]


@dataclass(frozen=True)
class Bound:
    """How far the two sides may be apart [m]."""

    model: str
    day: int
    metres: float


BOUNDS = [
    Bound("assumed", 7, 1.0),
    Bound(PRECISE, 7, 1.0),
    Bound("truth", 7, 1.0),
    Bound("truth", 50, 100.0),
]


def orekits(workers: "Workers", case: Case, gm: float) -> list["Future[list[dict]]"]:
    """Have Orekit fly every RSO, the longest arcs first; `collected` makes a table of them."""
    models = sorted(DAYS, key=lambda model: -DAYS[model][-1])
    orbits = [(HALVED, model, CHECKED) for model in models]
    orbits += [(kind, model, name) for kind in (CONVERGED, PAPER) for model in models for name in case.rsos]
    integrators = {CONVERGED: OREKITS_CONVERGED, HALVED: halved(OREKITS_CONVERGED), PAPER: case.integrator}
    return [
        workers.submit(
            f"Orekit's {name}, {model} model, {kind}",
            _orekits,
            case.rsos[name],
            case.models[model],
            gm,
            [name, model, kind],
            integrators[kind],
        )
        for kind, model, name in orbits
    ]


def _orekits(orekit, rso, settings, gm, keys, integrator):
    name, model, kind = keys
    t = DAY * np.array(DAYS[model])
    propagate = orekit.propagate if kind == PAPER else orekit.propagate_by_edges
    flown = propagate(initial_state(rso, gm), gm, t, orekit.forces(settings, rso), integrator)
    return _rows(name, model, kind, flown)


def collected(orbits: Sequence["Future[list[dict]]"]) -> pd.DataFrame:
    """Return the states (KEYS, GCRF state) of all orbits."""
    return pd.DataFrame([row for orbit in orbits for row in orbit.result()])


def opmls(
    case: Case, models: Mapping[str, ForceModel], integrators: Mapping[str, Integrator]
) -> pd.DataFrame:
    """Fly every RSO under force models and integrators by name; return our states (KEYS, GCRF state)."""
    rsos = list(case.rsos.values())
    rows = []
    for name, model in models.items():
        starts = np.array([initial_state(rso, model.gm) for rso in rsos])
        for kind, integrator in integrators.items():
            flown = ours.fly(model, rsos, starts, DAY * np.array(DAYS[name]), integrator)
            for rso, states in zip(rsos, flown, strict=True):
                rows += _rows(rso.name, name, kind, states)
    return pd.DataFrame(rows)


def _rows(rso, model, kind, states):
    return [
        {**dict(zip(KEYS, [rso, model, kind, day], strict=True)), **dict(zip(STATE, state, strict=True))}
        for day, state in zip(DAYS[model], states, strict=True)
    ]


def apart(one: pd.DataFrame, other: pd.DataFrame, keys: list[str]) -> pd.Series:
    """Return the distance [m] between the states of two tables that share `keys`, by these."""
    both = one.merge(other, on=keys, suffixes=("", "_other"))
    across = both[STATE[:3]].to_numpy() - both[[f"{axis}_other" for axis in STATE[:3]]].to_numpy()
    return pd.Series(np.linalg.norm(across, axis=1), index=pd.MultiIndex.from_frame(both[keys]))


def halved(integrator: Integrator) -> Integrator:
    """Return settings of half the longest step and a tenth of the tolerance."""
    return integrator.evolve(
        position_tolerance_m=integrator.position_tolerance_m / 10,
        max_step_s=integrator.max_step_s / 2,
    )


def moved(states: pd.DataFrame, settings: str) -> pd.Series:
    """Return how far [m] one side's states at other settings of the integrator are from converged ones."""
    kinds = {kind: part.drop(columns="integrator") for kind, part in states.groupby("integrator")}
    return apart(kinds[settings], kinds[CONVERGED], ["rso", "model", "day"])
