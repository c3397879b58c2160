"""Radar tracks of an RSO: when stations see it, and what they measure with noise."""

from collections.abc import Sequence

import numpy as np
import pandas as pd

from opml.base.errors import InputError
from opml.base.seeds import derive
from opml.catalog.simulate.observing import observe, sigmas, site
from opml.dynamics.frames import gcrf_to_itrf
from opml.orbits.elements import wrap_turn
from opml.orbits.sheets import Station

QUANTITIES = ["azimuth", "elevation", "range"]


def simulate(
    truth: pd.DataFrame,
    earth_orientation: pd.DataFrame,
    stations: Sequence[Station],
    *,
    rso: str,
    seed: int,
) -> pd.DataFrame:
    """Return the `tracking` table: every measurement of the stations, numbered by track.

    truth: states on an even grid of times, in whose gaps there is no track
    earth_orientation: the environment's table
    rso: name of the RSO
    seed: of the noise; that of each station follows from it, so that others change no measurement

    A track is a run of grid epochs at which any of the stations sees the RSO. Raises InputError where no
    station ever sees the RSO. Source: paper, sec. Measurement Models.
    """
    t = truth["t"].to_numpy()
    positions = np.einsum("nij,nj->ni", gcrf_to_itrf(earth_orientation, t), truth[["x", "y", "z"]].to_numpy())
    parts = [
        _measured(station, t, positions, derive(seed, "noise", rso, station.name)).assign(order=k)
        for k, station in enumerate(stations)
    ]
    if all(part.empty for part in parts):
        names = ", ".join(station.name for station in stations)
        raise InputError(f"{rso}: expected a pass over {names}, but it is never in sight")
    table = pd.concat(parts).sort_values(["epoch", "order"], ignore_index=True)
    step = np.diff(t).min()  # between epochs of the grid, of which some may be missing
    breaks = np.diff(table["t"].to_numpy(), prepend=-np.inf) > 1.5 * step
    table["track"] = np.cumsum(breaks) - 1
    return table[["track", "t", "station", *QUANTITIES, *(f"{name}_true" for name in QUANTITIES)]]


def _measured(
    station: Station, t: np.ndarray, positions: np.ndarray, noise: np.random.Generator
) -> pd.DataFrame:
    """Return one station's measurements, at the epochs at which it sees the RSO.

    positions: (n, 3) of the RSO in ITRF [m] at t (n,) [s]
    """
    true = observe(positions, *site(station))
    epochs = np.flatnonzero(
        (true[:, 1] >= station.min_elevation)
        & (true[:, 1] <= station.max_elevation)
        & (true[:, 2] <= station.max_range)
    )
    true = true[epochs]
    noisy = true + noise.normal(size=true.shape) * sigmas(station)
    noisy[:, 0] = wrap_turn(noisy[:, 0])
    columns = {"epoch": epochs, "t": t[epochs], "station": station.name}
    for k, name in enumerate(QUANTITIES):
        columns[name], columns[f"{name}_true"] = noisy[:, k], true[:, k]
    return pd.DataFrame(columns)
