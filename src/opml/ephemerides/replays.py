"""The mornings that are over, run again: ephemerides as they would have been issued, and what came of them.

At the beginning of each day a learner is trained on the errors known by then. The estimates of the day start
ephemerides, made as `opml.ephemerides.corrected` makes those that leave, and later tracks give their
errors. So nothing behind a row was known after its t_i, but the row's own error; and what sizes are learned
from has been through all that the next ephemeris will go through.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from opml.base.constants import DAY, HOUR
from opml.base.errors import InputError
from opml.catalog.predict.prediction import TRUE
from opml.catalog.propagator import Propagator
from opml.ephemerides.along_track_shift import corrected_by_each, through
from opml.ephemerides.corrected import expected, morning
from opml.ephemerides.ephemeris_task import Task, reached
from opml.ephemerides.known_tables import KnownTables
from opml.ephemerides.task_part import Grid, TaskPart
from opml.learning.data.splits import known_at
from opml.learning.judge.error_sizes import as_known
from opml.learning.models.daily_training import DailyLearner
from opml.learning.models.learners import needed_tables
from opml.orbits.elements import in_rsw
from opml.orbits.rsw_covariance import rates
from opml.tables import COMPONENTS, DOUBT, SCHEMAS, SPREAD, STATE, state_rows

STEP = 120.0
"""Time between the epochs of the ephemerides that are replayed [s]: a centimetre from those of a minute."""

_NEAR = 64
"""Epochs to both sides of a time that give its state: others move splines by less than 1 um."""


def morning_departures(known: KnownTables, *, every_hours: float, first_day: float = 0.0) -> pd.DataFrame:
    """Return the estimates that mornings start from: the first usable one of every so many hours.

    first_day: estimates before that day are left out
    """
    first = first_of_each(known.estimates[known.may_depart()], every_hours=every_hours)
    return first[first["t"] >= DAY * first_day]


def first_of_each(estimates: pd.DataFrame, *, every_hours: float) -> pd.DataFrame:
    """Return the first estimate of every so many hours since the epoch."""
    return estimates[~np.floor(estimates["t"] / (HOUR * every_hours)).duplicated().to_numpy()]


def first_day(daily: DailyLearner, known: KnownTables, *, train_days: Sequence[float]) -> float:
    """Return the day of the first morning.

    A learner that learns waits until half of the days to train on are over, any other until a window of
    tracks is full.
    """
    begin, end = train_days
    if daily.learns:
        return float(np.ceil(begin + 0.5 * (end - begin)))
    hours = [known.window_hours]
    if "mechanism" in needed_tables(daily.variables):
        hours.append(known.long_window_hours)
    if daily.arc:
        hours.append(daily.arc[0])
    return begin + max(hours) / 24.0


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


def grid(judge: pd.DataFrame, *, max_days: float) -> Grid:
    """Return the epochs of replayed ephemerides, as far as there is a judge, `at_starts`."""
    return Grid(STEP, max_days, float(judge["t_j"].max()) + STEP)


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
        mornings = one.starts["track"].iloc[0], grid(one.judge, max_days=max_days)
        groups.setdefault(mornings, []).append(number)
    tables: dict[int, pd.DataFrame] = {}
    for turn, ((_, epochs), numbers) in enumerate(groups.items()):
        together = [series[number] for number in numbers]
        task = Task(propagator.part(turn, len(groups)), known, together[0].starts, epochs)
        tables |= dict(zip(numbers, _together(task, together), strict=True))
    return [tables[number] for number in range(len(series))]


def _together(task: Task, series: Sequence[ReplaySeries]) -> Iterator[pd.DataFrame]:
    """Yield the tables of learners that have the mornings of one task."""
    by_learner: list[list[pd.DataFrame]] = [[] for _ in series]
    for part in task.parts():
        for tables, one in zip(by_learner, series, strict=True):
            tables += _ephemerides(part, one)
    for tables in by_learner:
        joined = task.known.marked(task.joined(tables))
        table = as_known(joined, joined["morning"].to_numpy())
        yield table[SCHEMAS["replay"].among(table.columns).names]


def _ephemerides(part: TaskPart, series: ReplaySeries) -> Iterator[pd.DataFrame]:
    """Yield how far a learner's ephemerides are off the states of later tracks."""
    daily, by_start = series.daily, dict(tuple(series.judge.groupby("i")))
    columns = part.columns(daily.variables, arc=daily.arc)
    for rows in reached(columns, (*STATE, *daily.variables)):
        track = rows["i"].iloc[0]
        if track in by_start:
            yield _judged(rows, by_start[track], daily)


def _judged(rows: pd.DataFrame, later: pd.DataFrame, daily: DailyLearner) -> pd.DataFrame:
    """Return how far one ephemeris is off the states of later tracks."""
    t, t_i = rows["t_j"].to_numpy(), float(rows["t_i"].iloc[0])
    now = morning(t_i)
    corrections = np.array([expected(rows, daily(now))])
    reached = later[later["t_j"].between(t[0], t[-1])]
    columns = {name: reached[name].to_numpy() for name in reached}
    return pd.DataFrame(differences(rows, corrections, columns, now=now))


def differences(
    rows: pd.DataFrame, corrections: np.ndarray, later: Mapping[str, np.ndarray], *, now: float
) -> dict[str, np.ndarray]:
    """Return how far an ephemeris is off later states by each correction in turn, but for SIGMA_STATE.

    It is columns of a table, as tables of few rows take longer to make than what is in them.

    rows: of one estimate: t_i, and t_j and a state (STATE) at each epoch of the ephemeris
    corrections: (k, epochs) e_y that are taken from it [m]
    later: columns of the table that `judge` returns, with SPREAD, at times that the ephemeris has
    now: when it was made [s]
    """
    at, states = later["t_j"], np.column_stack([later[name] for name in STATE])
    off = (_arrived(rows, corrections, at) - states).reshape(-1, len(STATE))
    before, *after = in_rsw(off, np.tile(states, (1 + len(corrections), 1))).reshape(-1, *states.shape)
    t_i = float(rows["t_i"].iloc[0])
    known = {name: values for name, values in later.items() if name not in STATE}
    known |= {"t_i": np.full(len(at), t_i), "morning": np.full(len(at), now), "duration": at - t_i}
    known |= {"rate": rates(states), "before": before[:, 1]}
    each = {name: np.tile(values, len(after)) for name, values in known.items()}
    return each | dict(zip(COMPONENTS, np.concatenate(after).T, strict=True))


def _arrived(rows: pd.DataFrame, corrections: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Return where an ephemeris is at times (m,), and where each correction has it: (1 + k, m, 6) GCRF."""
    t, predicted = rows["t_j"].to_numpy(), state_rows(rows)
    first, last = np.searchsorted(t, [at.min(initial=t[-1]), at.max(initial=t[0])])
    near = slice(max(0, min(first, last) - _NEAR), max(first, last) + _NEAR)
    paths = [predicted[near], *corrected_by_each(t, predicted, corrections, near)]
    return np.moveaxis(through(t[near], np.stack(paths, axis=1))(at), 1, 0)
