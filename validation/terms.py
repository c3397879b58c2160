"""Forces, rotation and measurements at single states: one table a side, with the same columns."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from opml.base.constants import BODIES
from opml.catalog.simulate.observing import observe, site
from opml.catalog.simulate.truth import initial_state
from opml.dynamics.kernels.surroundings import ForceModel
from opml.orbits.elements import wrap_half_turn
from opml.orbits.sheets import Rso, Station
from opml.tables import STATE
from validation import ours
from validation.case import PRECISE, Case

if TYPE_CHECKING:
    from validation.orekit import Orekit

TIMES = 32
"""Random times at which the states of all RSOs are taken."""

ITRF = ["itrf_x", "itrf_y", "itrf_z"]
ROTATION = [f"r{i}{j}" for i in range(3) for j in range(3)]
MEASURED = ["azimuth", "elevation", "range"]


def axes(term: str) -> list[str]:
    """Return the columns of a term's acceleration."""
    return [f"{term}_{axis}" for axis in "xyz"]


def states(case: Case, truth: ForceModel, t: np.ndarray) -> pd.DataFrame:
    """Return the GCRF states of every RSO at times t [s], from the true orbit at the paper's settings."""
    rsos = list(case.rsos.values())
    starts = np.array([initial_state(rso, truth.gm) for rso in rsos])
    flown = ours.fly(truth, rsos, starts, t, case.integrator)
    table = pd.DataFrame(flown.reshape(-1, 6), columns=STATE)
    table.insert(0, "t", np.tile(t, len(rsos)))
    table.insert(0, "rso", np.repeat([rso.name for rso in rsos], len(t)))
    return table


def orekits(orekit: "Orekit", case: Case, states: pd.DataFrame, gm: float) -> pd.DataFrame:
    """Return Orekit's terms at the states, and where these are in ITRF."""
    fields = {
        f"gravity_{name}": orekit.gravity(model["degree"], model["order"])
        for name, model in case.force_models.items()
    }
    pulls = {name: orekit.third_body(name) for name in BODIES}
    precise = {
        "solid_tides": orekit.solid_tides(case.degree, case.degree),
        "schwarzschild": orekit.schwarzschild(gm),
        "lense_thirring": orekit.lense_thirring(gm),
    }
    horizons = {name: orekit.topocentric(station) for name, station in case.stations.items()}
    rows = []
    for rso, t, state in _each(case.rsos, states):
        date, spacecraft = orekit.date(t), orekit.spacecraft(t, state, gm)
        rotation = orekit.rotation(t)
        place = orekit.vector(rotation @ state[:3])
        pressure = orekit.radiation_pressure(rso)
        row = dict(zip(ITRF, orekit.array(place), strict=True))
        row |= dict(zip(ROTATION, rotation.ravel(), strict=True))
        for name, field in fields.items():
            row |= _vector(name, np.array(field.gradient(date, place, gm)))
        for name, pull in pulls.items():
            row |= _vector(name, orekit.acceleration(pull, spacecraft))
        row["density"] = orekit.atmosphere.getDensity(date, orekit.vector(state[:3]), orekit.gcrf)
        row |= _vector("drag", orekit.acceleration(orekit.drag(rso), spacecraft))
        row["lit"] = pressure.getLightingRatio(spacecraft)
        row |= _vector("srp", orekit.acceleration(pressure, spacecraft))
        for name, force in precise.items():
            row |= _vector(name, orekit.acceleration(force, spacecraft))
        row |= _vector("de_sitter", orekit.turned_de_sitter(t, state, gm))
        for name, horizon in horizons.items():
            seen = horizon.getTrackingCoordinates(place, orekit.itrf, date)
            row |= _seen(name, [seen.getAzimuth(), seen.getElevation(), seen.getRange()])
        rows.append(row)
    return pd.DataFrame(rows, index=states.index)


def opmls(
    models: Mapping[str, ForceModel],
    rsos: Mapping[str, Rso],
    stations: Mapping[str, Station],
    states: pd.DataFrame,
    places: np.ndarray,
) -> pd.DataFrame:
    """Return our terms at the states; gravity and measurements at ITRF positions `places` (n, 3)."""
    sites = {name: site(station) for name, station in stations.items()}
    rows = []
    for (rso, t, state), place in zip(_each(rsos, states), places, strict=True):
        found = ours.terms(models["truth"], t, state, rso)
        row = dict(zip(ITRF, found["rotation"] @ state[:3], strict=True))
        row |= dict(zip(ROTATION, found["rotation"].ravel(), strict=True))
        for name in models.keys() - {PRECISE}:
            row |= _vector(f"gravity_{name}", ours.gravity_beyond_central(models[name], place))
        for name, pull in zip(BODIES, found["bodies"], strict=True):
            row |= _vector(name, pull)
        row |= {"density": found["density"], "lit": found["lit"]}
        row |= _vector("drag", found["drag"]) | _vector("srp", found["srp"])
        for name, acceleration in ours.precise_terms(models[PRECISE], t, state).items():
            row |= _vector(name, acceleration)
        for name, (position, to_horizon) in sites.items():
            row |= _seen(name, observe(place, position, to_horizon))
        rows.append(row)
    return pd.DataFrame(rows, index=states.index)


def _each(rsos, states):
    for name, t, *state in states[["rso", "t", *STATE]].itertuples(index=False):
        yield rsos[name], t, np.array(state)


def _vector(term, values):
    return dict(zip(axes(term), values, strict=True))


def _seen(station, values):
    return {f"{station}_{name}": value for name, value in zip(MEASURED, values, strict=True)}


@dataclass(frozen=True)
class Difference:
    """How far the two sides are apart in one term, over all states, and how far they may be."""

    term: str
    values: np.ndarray
    bound: float
    unit: str = ""

    @property
    def largest(self) -> float:
        """The largest difference."""
        return float(self.values.max())

    @property
    def median(self) -> float:
        """The median difference."""
        return float(np.median(self.values))


def differences(case: Case, theirs: pd.DataFrame, mine: pd.DataFrame) -> list[Difference]:
    """Return the terms of both tables, side by side."""
    found = [
        Difference(
            f"gravity beyond the central term, {model['degree']}x{model['order']}",
            _relative(theirs, mine, axes(f"gravity_{name}")),
            1e-11,
        )
        for name, model in case.force_models.items()
    ]
    found.append(Difference("GCRF to ITRF rotation", _turn(theirs, mine), 1e-9, "rad"))
    found += [Difference(name.capitalize(), _relative(theirs, mine, axes(name)), 1e-9) for name in BODIES]
    lit = theirs["lit"] > 0.0
    found += [
        Difference("DTM2000 density", _relative(theirs, mine, ["density"]), 1e-9),
        Difference("drag", _relative(theirs, mine, axes("drag")), 1e-8),
        Difference("radiation pressure, in the light", _relative(theirs[lit], mine[lit], axes("srp")), 1e-7),
        Difference("light, in the dark", np.abs(mine["lit"][~lit].to_numpy()), 0.0),
        Difference("solid Earth tides", _relative(theirs, mine, axes("solid_tides")), 1e-9),
        Difference("Schwarzschild", _relative(theirs, mine, axes("schwarzschild")), 1e-11),
        Difference("Lense-Thirring", _relative(theirs, mine, axes("lense_thirring")), 1e-8),
        Difference("de Sitter", _relative(theirs, mine, axes("de_sitter")), 1e-6),
    ]
    return found + measured(case.stations, theirs, mine)


def measured(stations: Sequence[str], theirs: pd.DataFrame, mine: pd.DataFrame) -> list[Difference]:
    """Return the measurements of all stations."""
    found = []
    for name, bound, unit in zip(MEASURED, [1e-10, 1e-10, 1e-3], ["rad", "rad", "m"], strict=True):
        columns = [f"{station}_{name}" for station in stations]
        apart = mine[columns].to_numpy() - theirs[columns].to_numpy()
        found.append(Difference(name, np.abs(wrap_half_turn(apart) if unit == "rad" else apart), bound, unit))
    return found


def _relative(theirs, mine, columns):
    a, b = theirs[columns].to_numpy(), mine[columns].to_numpy()
    return np.linalg.norm(b - a, axis=1) / np.linalg.norm(a, axis=1)


def _turn(theirs, mine):
    """Return the angle of the rotation between the two sides' rotations [rad]."""
    a, b = (side[ROTATION].to_numpy().reshape(-1, 3, 3) for side in (theirs, mine))
    between = np.einsum("nij,nkj->nik", b, a)
    axis = [between[:, 2, 1] - between[:, 1, 2], between[:, 0, 2] - between[:, 2, 0]]
    return 0.5 * np.linalg.norm([*axis, between[:, 1, 0] - between[:, 0, 1]], axis=0)
