"""The ephemeris that leaves: the path of the model that is flown, with covariances, on a message's epochs."""

import numpy as np
import pandas as pd
from scipy.interpolate import make_interp_spline

from opml.ephemerides.along_track_shift import check_smooth, corrected, through
from opml.ephemerides.corrected import interpolate_spread
from opml.ephemerides.task import ephemeris_table
from opml.mornings.issued import Flown
from opml.orbits.rsw_covariance import rates, rsw_covariances
from opml.tables import STATE

_DEGREE = 5  # of the correction between the epochs of a path


def ephemeris(paths: pd.DataFrame, flown: Flown, *, step: float) -> pd.DataFrame:
    """Return the `corrected` table of the model that is flown.

    paths: the table of a morning
    step: between the epochs [s]

    Between the epochs of a path stand splines: of degree 7 through its states, millimetres off. Raises
    InputError as `check_smooth` does.
    """
    t, along = paths["t_j"].to_numpy(), paths[f"e_y_{flown.model}"].to_numpy()
    check_smooth(t, along)
    at = np.arange(np.ceil(t[0] / step), np.floor(t[-1] / step) + 1.0) * step
    predicted = through(t, np.ascontiguousarray(paths[STATE]))(at)
    states = corrected(at, predicted, make_interp_spline(t, along, _DEGREE)(at))
    rows = pd.DataFrame(dict(zip(STATE, predicted.T, strict=True))).assign(
        i=paths["i"].iloc[0], t_i=paths["t_i"].iloc[0], t_j=at
    )
    rate = rates(states)
    caused = interpolate_spread(rows, paths).assign(rate=rate, duration=at - rows["t_i"])
    return ephemeris_table(rows, states, rsw_covariances(flown.sizes.sigmas(caused), rate))
