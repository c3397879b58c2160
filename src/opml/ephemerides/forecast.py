"""Forecast ephemerides: nothing is learned; a prediction, and how far the weather ahead may take it off.

From an estimate the assumed model predicts to every epoch of a regular grid under the forecast of t_i, and
under many futures about it (opml.catalog.predict.weather_futures). Positions are known as far as these lie
from the prediction. All of it is known at t_i.
"""

from collections.abc import Callable, Iterator

import numpy as np
import pandas as pd

from opml.base.constants import HOUR
from opml.catalog.predict import weather_futures
from opml.ephemerides.corrected import Flight, Grid, Known, by_parts, reached, rows, table
from opml.orbits.rsw_covariance import AXES, rates, rsw_covariances
from opml.tables import SCHEMAS, STATE

SHIFTS = ["d_x", "d_y", "d_z"]


def build(
    flight: Flight,
    known: Known,
    futures: pd.DataFrame,
    starts: pd.DataFrame,
    grid: Grid,
    *,
    seed: int,
    progress: Callable[[float], None] | None = None,
) -> pd.DataFrame:
    """The `forecast` table: an ephemeris from each of the `starts`.

    starts: rows of the estimates; futures: the table; seed: of the estimates that the futures are flown from,
    drawn from the fit's covariance. Raises InputError where no ephemeris reaches anywhere.
    """

    def some(chosen: pd.DataFrame) -> Iterator[pd.DataFrame]:
        pairs = rows(flight, known, chosen, (), grid)
        sample = weather_futures.sample(
            futures=futures,
            estimates=known.estimates,
            predictions=pairs,
            window=HOUR * known.window_hours,
            seed=seed,
            **flight.options,
        )
        sigmas = dict(zip(AXES, distances(sample, len(pairs)).T, strict=True))
        columns = pairs.assign(**{f"sigma_{axis}": column for axis, column in sigmas.items()})
        for own in reached(columns, (*STATE, *(f"sigma_{axis}" for axis in AXES))):
            states = np.ascontiguousarray(own[STATE])
            position = own[[f"sigma_{axis}" for axis in AXES]].to_numpy()
            rate = rates(states)
            # Beside what follows from its position a velocity errs by the motion of radius and plane.
            velocity = rate[:, None] * position[:, [0, 0, 2]]
            yield table(own, states, rsw_covariances(np.hstack([position, velocity]), rate))

    return by_parts(some, starts, grid, progress=progress)[SCHEMAS["forecast"].names]


def distances(ensemble: pd.DataFrame, count: int) -> np.ndarray:
    """Root mean square distances (n, 3) [m], RSW, of futures from `count` predictions.

    Of an `ensemble` table; about the prediction and not about the futures' mean, as it is the prediction that
    the ephemeris states. Not finite where a future does not reach. Products of two axes are left out: along a
    bent path the futures lie on a curve, and an ellipsoid about it is too thin for the truth.
    """
    shifts = ensemble[SHIFTS].to_numpy().reshape(-1, count, 3)
    found: np.ndarray = np.sqrt(np.mean(shifts**2, axis=0))
    return found
