"""States from which first fits start: the `starts` table, one at the start of each track.

Those of a simulated RSO are true states, perturbed, in the place of an initial orbit determination (paper,
sec. Estimation Models). Those of measured tracks are from `first_orbit`.
"""

import numpy as np
import pandas as pd

from opml.base.seeds import derive
from opml.catalog.fit.estimation_settings import Estimation
from opml.tables import STATE


def perturbed(
    truth: pd.DataFrame, tracking: pd.DataFrame, *, rso: str, settings: Estimation, seed: int
) -> pd.DataFrame:
    """Return the `starts` table of a simulated RSO: true states with noise of the settings' sigmas.

    seed: of the noise; that of each track follows from it, the RSO's name and the track's number
    """
    begins = tracking.groupby("track")["t"].min()
    spread = np.repeat([settings.start_position_sigma_m, settings.start_velocity_sigma_mps], 3)
    noise = [derive(seed, "start", rso, str(track)).normal(size=6) * spread for track in begins.index]
    states = truth.set_index("t")[STATE].loc[begins].to_numpy() + np.array(noise)
    return starts_table(begins, states, known=begins.to_numpy())


def starts_table(begins: pd.Series, states: np.ndarray, *, known: np.ndarray | float) -> pd.DataFrame:
    """Return a `starts` table.

    begins: of the tracks, by number [s]
    states: (tracks, 6) at their beginnings
    known: when the orbits were known [s]; a state before that time is as old as a state equally long after it
    """
    columns = dict(zip(STATE, states.T, strict=True))
    age = np.abs(begins.to_numpy() - known)
    return pd.DataFrame({"track": begins.index, "t": begins.to_numpy(), **columns, "age": age})
