"""The ephemerides of all models from the newest estimate of a morning: the table `paths`."""

from dataclasses import replace
from functools import partial

import pandas as pd

from opml.base.constants import DAY, HOUR
from opml.catalog.predict import weather_spread
from opml.catalog.predict.prediction import predict_pairs
from opml.ephemerides.paths import Paths, paths
from opml.ephemerides.start_arcs import StartArcs, grid
from opml.learning.data import dataset
from opml.learning.data.cleaning import Cleaning
from opml.mornings.fits import Recent
from opml.mornings.records import Records
from opml.mornings.watched_object import Watched
from opml.tables import STATE

STEP = 300.0  # time between the epochs of these ephemerides [s]: decimetres from those of a minute
EVERY = 2  # so many epochs are to one that arcs are propagated to for the spread

_LOOKED_AT = 4  # newest estimates among which one is found to start from


def newest_start(now: float, watched: Watched, records: Records, recent: Recent) -> pd.DataFrame:
    """Return the newest estimate that ephemerides may start from at a time [s]: a row, or none.

    records: with the estimates of the morning
    """
    plan, propagator = watched.plan, watched.model.predictions
    estimates = records.of_window(plan.base, watched.known_by(now))
    # Of an object that is seldom seen the newest estimates may be older than all that is read of its tracks.
    rows = estimates[estimates["track"].isin(recent.numbers)].tail(_LOOKED_AT + 1)
    tracking = recent.tracking.assign(track=recent.numbers[recent.tracking["track"]])
    estimated = partial(dataset.of_estimates, tracking=tracking, gm=propagator.model.gm, cleaning=Cleaning())
    nothing = pd.DataFrame(columns=["i", "j", *STATE, "reason"])
    pairs = _from_previous(rows, estimated(rows, nothing), longest=DAY * plan.max_days)
    # Where the newest may start one, nobody asks for the others.
    for asked in (pairs.tail(1), pairs) if len(pairs) else ():
        known = estimated(rows, predict_pairs(propagator, rows, asked))
        usable = dataset.may_depart(rows, known, manoeuvres=watched.manoeuvres, window=HOUR * plan.base)
        if usable.any():
            return rows[usable].tail(1)
    return rows.tail(0)


def _from_previous(estimates: pd.DataFrame, at_estimates: pd.DataFrame, *, longest: float) -> pd.DataFrame:
    """Return the pairs of an estimate before and one that may start an ephemeris, if the first reaches it.

    at_estimates: of `dataset.of_estimates`
    longest: arc [s]
    """
    table = at_estimates.assign(t_i=at_estimates["t_b"], t_j=estimates["t"].to_numpy())
    near = (table["b"] != dataset.NO_PREVIOUS) & (table["t_j"] - table["t_i"] <= longest)
    usable = table["converged"] & table["cd_inside"] & near
    return table[usable].rename_axis("j").reset_index().rename(columns={"b": "i"})[["i", "j", "t_i", "t_j"]]


def of_morning(watched: Watched, records: Records, start: pd.DataFrame, *, now: float) -> Paths:
    """Return the ephemerides of all models of an object from one start, as far as all of them reach.

    records: with the estimates of the morning
    start: the estimate that they start from, a table of one row
    now: when they are made [s]
    """
    plan, burns, models = watched.plan, watched.known_by(now), watched.plan.models
    last = min(float(start["t"].iloc[0]) + DAY * plan.max_days, plan.end)
    arcs = StartArcs.propagate(
        watched.model.predictions,
        start,
        grid(STEP, last),
        fits={hours: records.of_window(hours, burns) for hours in plan.windows},
        models=[*models.values()],
        manoeuvres=watched.manoeuvres,
    )
    path = paths(arcs, models, now=now)
    spreads = partial(
        weather_spread.build,
        watched.model.flattened,
        records.of_window(plan.base, burns),
        weathers=watched.model.weathers,
    )
    # From an estimate on the raster all are multiples of EVERY steps away.
    path = path.with_spread(spreads, slice(EVERY - 1, None, EVERY))
    return replace(path, table=path.table.drop(columns=["j", "reason"]))
