"""Forecast ephemerides: nothing is learned; a prediction, and how far the weather ahead may take it off.

From an estimate the assumed model predicts to every epoch of a regular grid under the forecast of t_i, and
under many futures about it (`opml.catalog.predict.weather_futures`). Positions are known as far as these lie
from the prediction. All of it is known at t_i.
"""

from collections.abc import Iterator

import numpy as np
import pandas as pd

from opml.catalog.predict import weather_futures
from opml.ephemerides.ephemeris_task import Task, ephemeris_table, reached
from opml.ephemerides.task_part import TaskPart
from opml.orbits.rsw_covariance import AXES, rates, rsw_covariances
from opml.tables import SCHEMAS, STATE, state_rows

SHIFTS = ["d_x", "d_y", "d_z"]

_SIGMAS = [f"sigma_{axis}" for axis in AXES]


def build(task: Task, futures: pd.DataFrame, *, seed: int) -> pd.DataFrame:
    """Return the `forecast` table.

    futures: the table
    seed: of the estimates that the futures are propagated from, drawn from the fit's covariance

    Raises InputError where no ephemeris reaches anywhere.
    """

    def ephemerides(part: TaskPart) -> Iterator[pd.DataFrame]:
        pairs = part.columns()
        sample = weather_futures.sample(
            part.propagator, futures, part.known.estimates, pairs, window=part.known.window, seed=seed
        )
        pairs[_SIGMAS] = distances(sample, len(pairs))
        for rows in reached(pairs, (*STATE, *_SIGMAS)):
            states = state_rows(rows)
            yield ephemeris_table(rows, states, _covariances(states, rows[_SIGMAS].to_numpy()))

    tables = [table for part in task.parts() for table in ephemerides(part)]
    return task.joined(tables)[SCHEMAS["forecast"].names]


def _covariances(states: np.ndarray, sigma: np.ndarray) -> np.ndarray:
    """Return covariances (n, 6, 6) in RSW of states (n, 6), from deviations (n, 3) of the positions [m]."""
    rate = rates(states)
    # Beside what follows from its position a velocity errs by the motion of radius and plane.
    velocity = rate[:, None] * sigma[:, [0, 0, 2]]
    return rsw_covariances(np.hstack([sigma, velocity]), rate)


def distances(ensemble: pd.DataFrame, count: int) -> np.ndarray:
    """Return root mean square distances (n, 3) [m], RSW, of futures from `count` predictions.

    ensemble: the table. Distances are from the prediction, not from the futures' mean, as the prediction is
    what the ephemeris states. Not finite where a future does not reach. Products of two axes are left out:
    along a bent path the futures lie on a curve, and an ellipsoid about it is too thin for the truth.
    """
    shifts = ensemble[SHIFTS].to_numpy().reshape(-1, count, 3)
    return np.sqrt(np.mean(shifts**2, axis=0))
