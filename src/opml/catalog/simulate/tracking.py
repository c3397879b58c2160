"""Tracks of an RSO: when stations see it, and what they measure with noise."""

from collections.abc import Sequence

import erfa
import numpy as np
import pandas as pd

from opml.base import epochs
from opml.base.constants import WGS84_A
from opml.base.errors import InputError
from opml.base.seeds import derive
from opml.catalog.simulate.observing import (
    QUANTITIES,
    StationStates,
    measured_by,
    observe,
    predicted,
    sigmas,
    site,
    wrapped,
)
from opml.dynamics.frames import gcrf_to_itrf
from opml.orbits.sheets import Station
from opml.tables import SCHEMAS, STATE


def simulate(
    truth: pd.DataFrame,
    earth_orientation: pd.DataFrame,
    stations: Sequence[Station],
    *,
    rso: str,
    seed: int,
    epoch: str = "",
) -> pd.DataFrame:
    """Return the `tracking` table: every measurement of the stations, numbered by track.

    truth: states on an even grid of times, in whose gaps there is no track
    earth_orientation: the environment's table
    rso: name of the RSO
    seed: of the noise; that of each station follows from it, so that others change no measurement
    epoch: UTC text from which times count, where there is a telescope

    A track is a run of grid epochs at which any of the stations sees the RSO. Raises InputError where no
    station ever sees the RSO. Source: paper, sec. Measurement Models.
    """
    t, to_itrf = truth["t"].to_numpy(), gcrf_to_itrf(earth_orientation, truth["t"].to_numpy())
    states = truth[STATE].to_numpy().reshape(-1, 2, 3)
    positions, velocities = (np.einsum("nij,nj->ni", to_itrf, states[:, k]) for k in (0, 1))
    parts = []
    for k, station in enumerate(stations):
        seen = _is_seen(station, positions)
        if station.max_sun_elevation is not None:
            sun = -np.einsum("nij,nj->ni", to_itrf, erfa.epv00(*epochs.tdb(epoch, t))[0]["p"])
            seen &= _is_lit(station, positions, sun)
        stands = StationStates.at(t[seen], [station], np.zeros(seen.sum(), int), earth_orientation)
        true = predicted(measured_by(station), positions[seen], velocities[seen], stands)
        part = _measured(station, true, derive(seed, "noise", rso, station.name))
        parts.append(part.assign(epoch=np.flatnonzero(seen), t=t[seen], order=k))
    if all(part.empty for part in parts):
        names = ", ".join(station.name for station in stations)
        raise InputError(f"{rso}: expected a pass over {names}, but it is never in sight")
    table = pd.concat(parts).sort_values(["epoch", "order"], ignore_index=True)
    step = np.diff(t).min()  # between epochs of the grid, of which some may be missing
    breaks = np.diff(table["t"].to_numpy(), prepend=-np.inf) > 1.5 * step
    table["track"] = np.cumsum(breaks) - 1
    return table[SCHEMAS["tracking"].among(table.columns).names]


def _is_seen(station: Station, positions: np.ndarray) -> np.ndarray:
    _, elevation, distance = observe(positions, *site(station)).T
    high = (elevation >= station.min_elevation) & (elevation <= station.max_elevation)
    return np.asarray(high & (distance <= station.max_range))


def _is_lit(station: Station, positions: np.ndarray, sun: np.ndarray) -> np.ndarray:
    """Return whether a telescope at night sees positions (n, 3) in sunlight: (n,).

    sun: (n, 3) in ITRF, as positions. The shadow is a cylinder as wide as the equator.
    """
    sunwards = sun / np.linalg.norm(sun, axis=1, keepdims=True)
    elevation = np.arcsin(sunwards @ site(station)[1][2])
    along = np.sum(positions * sunwards, axis=1)
    across = np.linalg.norm(positions - along[:, None] * sunwards, axis=1)
    return np.asarray((elevation < station.max_sun_elevation) & ((along > 0.0) | (across > WGS84_A)))


def _measured(station: Station, true: np.ndarray, noise: np.random.Generator) -> pd.DataFrame:
    """Return what a station measures, with noise and without; NaN of radars' quantities that it does not.

    true: (n, observables), of `measured_by`
    """
    names = measured_by(station)
    noisy = wrapped(true + noise.normal(size=true.shape) * sigmas(station, names), names)
    columns = {name: noisy[:, k] for k, name in enumerate(names)}
    columns |= {f"{name}_true": true[:, k] for k, name in enumerate(names)}
    missing = [name for name in QUANTITIES if name not in names]
    columns |= {name + suffix: np.full(len(true), np.nan) for name in missing for suffix in ("", "_true")}
    return pd.DataFrame(columns).assign(station=station.name)
