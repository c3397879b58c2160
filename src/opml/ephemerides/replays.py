"""The mornings that are over, run again: ephemerides as they would have been issued, and what came of them.

At the beginning of each day a learner is trained on the errors known by then. The estimates of the day start
ephemerides, made as `opml.ephemerides.corrected` makes those that leave, and later tracks tell what they were
off by. So nothing behind a row was known after its t_i, but the row's own error; and what sizes are learned
from has been through all that the next ephemeris will go through.
"""

from collections.abc import Callable, Iterator, Sequence

import numpy as np
import pandas as pd

from opml.base.constants import DAY, HOUR
from opml.base.errors import InputError
from opml.catalog.predict.prediction import TRUE
from opml.ephemerides import corrected
from opml.ephemerides.along_track_shift import through
from opml.ephemerides.corrected import Flight, Grid, Known
from opml.learning.data.dataset import may_depart
from opml.learning.data.splits import known_at
from opml.learning.judge.error_sizes import as_known
from opml.learning.models.daily_training import Lessons
from opml.orbits.elements import in_rsw
from opml.orbits.rsw_covariance import rates
from opml.tables import COMPONENTS, DOUBT, SCHEMAS, SIGMA_STATE, SPREAD, STATE

STEP = 120.0
"""Time between the epochs of the ephemerides that are replayed [s]: a centimetre from those of a minute."""


def departures(known: Known, *, every_hours: float, first_day: float = 0.0) -> pd.DataFrame:
    """The estimates that mornings start from: the first usable one of every so many hours, from a day on."""
    usable = may_depart(
        known.estimates, known.at_estimates, manoeuvres=known.manoeuvres, window=HOUR * known.window_hours
    )
    found = known.estimates[usable]
    found = found[~np.floor(found["t"] / (HOUR * every_hours)).duplicated().to_numpy()]
    return found[found["t"] >= DAY * first_day]


def judge(dataset: pd.DataFrame, predictions: pd.DataFrame, later: pd.DataFrame | None) -> pd.DataFrame:
    """What ephemerides are held against, for each kept pair of a dataset: i, j, t_j, t_known and a state.

    predictions: the table, whose true states it is; later: in its place, the estimates that labels are from,
    with their doubt.
    """
    kept = dataset[dataset["keep"]]
    doubt = {name: kept.get(f"sigma_e_{name[-1]}", 0.0) for name in DOUBT}
    pairs = kept[["i", "j", "t_j"]].assign(t_known=known_at(kept), **doubt)
    if later is not None:
        return pairs.join(later.set_index("track")[STATE], on="j")
    true = predictions.set_index(["i", "j"])[TRUE].set_axis(STATE, axis=1)
    return pairs.join(true, on=["i", "j"])


def first_day(lessons: Lessons, known: Known, *, train_days: Sequence[float]) -> float:
    """Day of the first morning.

    A learner that learns waits until half of the days to train on are over, any other until a window of
    tracks is full.
    """
    begin, end = train_days
    if lessons.learns:
        return float(np.ceil(begin + 0.5 * (end - begin)))
    longer = [one.window_hours for one in (known.long, known.arc) if one is not None]
    return begin + max([known.window_hours, *longer]) / 24.0


def build(
    flight: Flight,
    known: Known,
    lessons: Lessons,
    starts: pd.DataFrame,
    judge: pd.DataFrame,
    spread: pd.DataFrame,
    *,
    max_days: float,
    progress: Callable[[float], None] | None = None,
) -> pd.DataFrame:
    """The `replay` table of ephemerides from the `starts`, rows of the estimates.

    judge: rows i, j, t_j, t_known, DOUBT and a state (STATE) that the ephemeris is held against, of each pair
    that may be; spread: the table of these pairs. Raises InputError where there is nothing to hold against.
    """
    judge = judge[judge["i"].isin(starts["track"])].join(spread.set_index(["i", "j"]), on=["i", "j"])
    judge = judge[np.isfinite(judge[[*STATE, *SPREAD]].to_numpy()).all(axis=1)]
    if judge.empty:
        raise InputError("replay: expected later tracks to hold ephemerides against, got none")
    by_start = dict(tuple(judge.groupby("i")))
    grid = Grid(STEP, max_days, float(judge["t_j"].max()) + STEP)

    def some(chosen: pd.DataFrame) -> Iterator[pd.DataFrame]:
        columns = corrected.rows(flight, known, chosen, lessons.variables, grid)
        for own in corrected.reached(columns, (*STATE, *lessons.variables)):
            if own["i"].iloc[0] in by_start:
                yield _held(own, by_start[own["i"].iloc[0]], lessons)

    found = corrected.by_parts(some, starts, grid, progress=progress)
    sigma = as_known(found, found["morning"].to_numpy())
    return found.assign(**dict(zip(SIGMA_STATE, sigma.T, strict=True)))[SCHEMAS["replay"].names]


def _held(own: pd.DataFrame, later: pd.DataFrame, lessons: Lessons) -> pd.DataFrame:
    """What one ephemeris is off from the states of later tracks."""
    t, t_i = own["t_j"].to_numpy(), float(own["t_i"].iloc[0])
    now = corrected.morning(t_i)
    model = lessons(now)
    later = later[later["t_j"].between(t[0], t[-1])]
    at, states = later["t_j"].to_numpy(), np.ascontiguousarray(later[STATE])
    before, after = (
        in_rsw(through(t, path)(at) - states, states)
        for path in (np.ascontiguousarray(own[STATE]), corrected.moved(own, corrected.said(own, model)))
    )
    return later[["i", "j", "t_j", "t_known", *DOUBT, *SPREAD]].assign(
        t_i=t_i,
        morning=now,
        duration=at - t_i,
        rate=rates(states),
        before=before[:, 1],
        **dict(zip(COMPONENTS, after.T, strict=True)),
    )
