"""States from which first fits start: the `starts` table, one at the start of each track.

Of a simulated RSO they are the true ones, perturbed, in the place of an initial orbit determination (paper,
sec. Estimation Models). Of tracks that were measured, `first_orbit` has them.
"""

import numpy as np
import pandas as pd

from opml.base.seeds import derive
from opml.catalog.fit.estimation import Estimation
from opml.tables import STATE


def chosen(
    given: pd.DataFrame, tracking: pd.DataFrame, *, rso: str, settings: Estimation, seed: int
) -> pd.DataFrame:
    """The `starts` table of an RSO's tracks: the one that is given, or the truth that is given, perturbed."""
    if "track" in given:
        return given
    return perturbed(given, tracking, rso=rso, settings=settings, seed=seed)


def perturbed(
    truth: pd.DataFrame, tracking: pd.DataFrame, *, rso: str, settings: Estimation, seed: int
) -> pd.DataFrame:
    """The `starts` table of a simulated RSO: true states with noise of the settings' sigmas.

    seed: of the noise, from which each track's own follows by the RSO's name and its number.
    """
    begins = tracking.groupby("track")["t"].min()
    spread = np.repeat([settings.start_position_sigma_m, settings.start_velocity_sigma_mps], 3)
    noise = [derive(seed, "start", rso, str(track)).normal(size=6) * spread for track in begins.index]
    states = truth.set_index("t")[STATE].loc[begins].to_numpy() + np.array(noise)
    return table(begins, states, known=begins.to_numpy())


def table(begins: pd.Series, states: np.ndarray, *, known: np.ndarray | float) -> pd.DataFrame:
    """The `starts` table of the tracks' beginnings [s] by number, and states (tracks, 6) there.

    known: when the orbits were [s]; a state before it is as old as one that long after it.
    """
    columns = dict(zip(STATE, states.T, strict=True))
    age = np.abs(begins.to_numpy() - known)
    return pd.DataFrame({"track": begins.index, "t": begins.to_numpy(), **columns, "age": age})
