"""Corrected ephemerides: predictions on a regular grid of epochs, less the errors that a model expects.

The along-track error that the model predicts at each epoch moves the orbit
(`opml.ephemerides.along_track_shift`). Covariances are the sizes of past errors.
"""

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import pandas as pd

from opml.base.constants import DAY
from opml.catalog.predict import weather_spread
from opml.catalog.predict.labels import with_sigmas
from opml.catalog.predict.weather_spread import Weathers
from opml.catalog.propagator import Propagator, PropagatorSettings
from opml.ephemerides.along_track_shift import through
from opml.ephemerides.ephemeris_task import Task
from opml.ephemerides.known_tables import KnownTables
from opml.ephemerides.paths import paths
from opml.learning.data.splits import are_over
from opml.learning.judge.error_sizes import Sizes
from opml.learning.models.daily_training import DailyLearner
from opml.orbits.elements import in_rsw
from opml.tables import SIGMAS, STATE, read_table, state_rows

Spreads = Callable[[pd.DataFrame], pd.DataFrame]  # returns the `spread` table of pairs

SPREAD_STEP = 600.0
"""Time between the epochs of an ephemeris at which arcs give its spread [s], linear between them."""


def spreading(files: Any, settings: PropagatorSettings, known: KnownTables, *, threads: int = 1) -> Spreads:
    """Return how a job makes the `spread` of pairs; futures of the weather are optional among its files."""
    propagator = Propagator.read(
        files, settings.model_copy(update={"force_model": weather_spread.FLATTENED}), threads=threads
    )
    futures = read_table(files.futures, "futures") if files.futures else None
    return partial(
        weather_spread.build, propagator, known.own(), weathers=Weathers.of(propagator.model, futures)
    )


def build(
    task: Task, daily: DailyLearner, replay: pd.DataFrame, *, spreads: Spreads, now: float
) -> pd.DataFrame:
    """Return the `corrected` table.

    daily: the learner, retrained each morning
    replay: the table of the same learner, from which sizes are learned
    spreads: how far drag and weather may take pairs
    now: when ephemerides are made [s]

    An ephemeris ends where an arc that it needs does. Raises InputError where none reaches anywhere, where a
    size has no past, and as `along_track_shift.check_smooth` does.
    """
    sizes = Sizes.learned(replay, now=now)
    sparse = slice(None, None, max(1, round(SPREAD_STEP / task.grid.step)))
    made = (path for part in task.parts() for path in paths(part, {"": daily}, made_at=lambda _: now))
    return task.joined([path.with_spread(spreads, sparse).ephemeris("", sizes) for path in made])


def basis(replay: pd.DataFrame, now: float) -> str:
    """Return what the covariances of ephemerides as of `now` [s] rest on, in words; replay: that table."""
    past = replay[are_over(replay, now)]
    mornings, longest = past["morning"].nunique(), past["duration"].max() / DAY
    return (
        f"covariances from {len(past)} predictions of {mornings} mornings that were over by "
        f"day {now / DAY:g}, up to {longest:.1f} days long"
    )


def morning(t: float) -> float:
    """Return when an ephemeris from an estimate at `t` [s] learns last: at its day's beginning."""
    return max(0.0, DAY * float(np.floor(t / DAY)))


def errors_at_estimates(ephemeris: pd.DataFrame, estimates: pd.DataFrame) -> pd.DataFrame:
    """Return how far one ephemeris, rows of a `corrected` table, is off the estimates of later tracks.

    Columns: duration [s]; before_*, after_*: predicted and corrected less estimated position in RSW of the
    estimate [m]; sigma_*: standard deviations by the ephemeris [m]; sigma_e_*: by the estimate's own fit
    [m]. Estimates that did not converge are left out.
    """
    t = ephemeris["t"].to_numpy()
    later = estimates[estimates["converged"] & estimates["t"].between(t[0], t[-1])]
    at, known = later["t"].to_numpy(), state_rows(later)
    columns = {"duration": at - ephemeris["t_i"].iloc[0]}
    for when, suffix in (("before", "_predicted"), ("after", "")):
        states = through(t, ephemeris[[f"{name}{suffix}" for name in STATE]].to_numpy())(at)
        off = in_rsw(states - known, known)
        columns |= {f"{when}_{axis}": off[:, k] for k, axis in enumerate("xyz")}
    for axis in "xyz":
        columns[f"sigma_{axis}"] = np.interp(at, t, np.sqrt(ephemeris[f"cov_{axis}_{axis}"].to_numpy()))
    return pd.DataFrame(columns).join(with_sigmas(later)[SIGMAS[:3]].reset_index(drop=True))
