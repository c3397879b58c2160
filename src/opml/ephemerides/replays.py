"""The mornings that are over, run again: ephemerides as they would have been issued, and what came of them.

At the beginning of each day a learner is trained on the errors known by then. The estimates of the day start
ephemerides, made as `opml.ephemerides.corrected` makes those that leave, and later tracks give their
errors. So nothing behind a row was known after its t_i, but the row's own error; and what sizes are learned
from has been through all that the next ephemeris will go through.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from opml.base.constants import DAY, HOUR
from opml.base.errors import InputError
from opml.catalog.predict.prediction import TRUE
from opml.catalog.propagator import Propagator
from opml.ephemerides.corrected import morning
from opml.ephemerides.ephemeris_task import Task
from opml.ephemerides.known_tables import KnownTables
from opml.ephemerides.paths import Paths, paths
from opml.ephemerides.task_part import Grid
from opml.learning.data.splits import known_at
from opml.learning.judge.error_sizes import as_known
from opml.learning.models.daily_training import DailyLearner
from opml.tables import DOUBT, SCHEMAS, SPREAD, STATE

STEP = 120.0
"""Time between the epochs of the ephemerides that are replayed [s]: a centimetre from those of a minute."""


def morning_departures(known: KnownTables, *, every_hours: float, first_day: float = 0.0) -> pd.DataFrame:
    """Return the estimates that mornings start from: the first usable one of every so many hours.

    first_day: estimates before that day are left out
    """
    usable = known.estimates[known.may_depart()]
    first = usable[~np.floor(usable["t"] / (HOUR * every_hours)).duplicated().to_numpy()]
    return first[first["t"] >= DAY * first_day]


def judge(dataset: pd.DataFrame, predictions: pd.DataFrame, later: pd.DataFrame | None) -> pd.DataFrame:
    """Return what ephemerides are compared with: i, j, t_j, t_known and a state for each pair of a dataset.

    Pairs that were dropped are left out.
    predictions: the table, whose true states are taken where `later` is None
    later: the estimates that labels are from, with their standard deviations
    """
    kept = dataset[dataset["keep"]]
    reference = {name: kept.get(f"sigma_e_{name[-1]}", 0.0) for name in DOUBT}
    pairs = kept[["i", "j", "t_j"]].assign(t_known=known_at(kept), **reference)
    if later is not None:
        return pairs.join(later.set_index("track")[STATE], on="j")
    true = predictions.set_index(["i", "j"])[TRUE].set_axis(STATE, axis=1)
    return pairs.join(true, on=["i", "j"])


def at_starts(judge: pd.DataFrame, starts: pd.DataFrame, spread: pd.DataFrame) -> pd.DataFrame:
    """Return the rows of `judge` that ephemerides from the `starts` can be compared with, with their spread.

    spread: the table of these pairs. Raises InputError where there are none.
    """
    rows = judge[judge["i"].isin(starts["track"])].join(spread.set_index(["i", "j"]), on=["i", "j"])
    rows = rows[np.isfinite(rows[[*STATE, *SPREAD]].to_numpy()).all(axis=1)]
    if rows.empty:
        raise InputError("replay: expected later tracks to hold ephemerides against, got none")
    return rows


@dataclass(frozen=True)
class ReplaySeries:
    """The mornings of one learner that are to be run again."""

    daily: DailyLearner  # the learner, retrained each morning
    starts: pd.DataFrame  # the estimates that its ephemerides start from, `morning_departures`
    judge: pd.DataFrame  # rows i, j, t_j, t_known, DOUBT, SPREAD and a state (STATE), `at_starts`


def build(
    propagator: Propagator, known: KnownTables, series: Sequence[ReplaySeries], *, max_days: float
) -> list[pd.DataFrame]:
    """Return the `replay` table of the ephemerides of each learner.

    propagator: under the assumed model
    max_days: length of an ephemeris at most

    Learners with the same mornings share the arcs that they need. Others do not, so that a table is the
    same whatever is replayed with it: arcs share their steps, which end where any of them begins.
    """
    groups: dict[tuple[int, Grid], list[int]] = {}
    for number, one in enumerate(series):
        epochs = Grid(STEP, max_days, float(one.judge["t_j"].max()) + STEP)  # as far as there is a judge
        groups.setdefault((one.starts["track"].iloc[0], epochs), []).append(number)
    tables: dict[int, pd.DataFrame] = {}
    for turn, ((_, epochs), numbers) in enumerate(groups.items()):
        together = [series[number] for number in numbers]
        task = Task(propagator.part(turn, len(groups)), known, together[0].starts, epochs)
        tables |= dict(zip(numbers, _together(task, together), strict=True))
    return [tables[number] for number in range(len(series))]


def _together(task: Task, series: Sequence[ReplaySeries]) -> Iterator[pd.DataFrame]:
    """Yield the tables of learners that have the mornings of one task."""
    by_learner: list[list[pd.DataFrame]] = [[] for _ in series]
    later = [dict(tuple(one.judge.groupby("i"))) for one in series]
    for part in task.parts():
        for tables, one, states in zip(by_learner, series, later, strict=True):
            made = paths(part, {"": one.daily}, made_at=morning)
            tables += [_judged(path, states[path.start]) for path in made if path.start in states]
    for tables in by_learner:
        joined = task.known.marked(task.joined(tables))
        table = as_known(joined, joined["morning"].to_numpy())
        yield table[SCHEMAS["replay"].among(table.columns).names]


def _judged(path: Paths, later: pd.DataFrame) -> pd.DataFrame:
    """Return how far one ephemeris is off the states of later tracks."""
    t = path.table["t_j"].to_numpy()
    reached = later[later["t_j"].between(t[0], t[-1])]
    return pd.DataFrame(path.differences({name: reached[name].to_numpy() for name in reached}))
