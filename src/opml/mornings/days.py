"""The mornings of objects up to a day, day by day."""

import logging
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import date, timedelta
from itertools import pairwise
from pathlib import Path
from typing import Any, Self

import numpy as np
import pandas as pd

from opml.base.constants import DAY, HOUR
from opml.base.errors import InputError
from opml.base.progress import counted
from opml.element_sets import station_passes
from opml.interop import ccsds
from opml.mornings import verdicts
from opml.mornings.calendar import Calendar
from opml.mornings.fits import sigmas_off
from opml.mornings.kept.batch_day import FinishedMorning, MorningMark
from opml.mornings.kept.store import Store
from opml.mornings.outcomes import NOTHING, rounded
from opml.mornings.records import Records
from opml.mornings.verdicts import OLDEST, Verdict
from opml.mornings.watched_object import MorningPlan
from opml.orbits.rsw_covariance import INSIDE

STRIP = 30  # mornings whose verdicts the page of a day shows in a row

AGAIN = 7
"""Newest mornings that can be run again: as many days ephemerides are kept after they were judged last."""

Together = Callable[[Mapping[str, Callable[[], FinishedMorning]]], Mapping[str, FinishedMorning]]
"""Runs calls by name, and returns what they return by name, without those that failed."""

_DATE = len("2016-09-28")
_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class MorningResult:
    """Result of a morning.

    figures: what its ephemeris starts from, its orbit, and its errors to expect, as JSON values
    write: writes the ephemeris as a message at a path, of an object of a name; None where none goes
    """

    records: Records  # tables of this morning alone
    verdict: Verdict
    figures: Mapping[str, Any]
    write: Callable[[Path, str], None] | None


@dataclass(frozen=True)
class WatchedObject:
    """An object of whose mornings each leaves something: of what tracks it, or of its public sets.

    judged_for: days after a morning for which what it predicted may be judged
    first_known, last_known: when the first and the last of what tells of it was known [s]
    stations: digests of those that measured it, by name
    morning: returns what the morning at a time [s] leaves, by the records of earlier ones
    """

    plan: MorningPlan
    judged_for: float
    first_known: float
    last_known: float
    stations: Mapping[str, str]
    morning: Callable[[Records, float], MorningResult]


@dataclass
class UnderWay:
    """An object on its way through its mornings."""

    rso: str
    watched: WatchedObject
    calendar: Calendar
    store: Store
    settings: str  # digest of those that its mornings are made with
    next: date
    records: Records = field(default_factory=Records.empty)  # of the mornings before

    @classmethod
    def begin(
        cls,
        rso: str,
        watched: WatchedObject,
        calendar: Calendar,
        store: Store,
        settings: str,
        *,
        done: Sequence[date],
        until: date,
    ) -> Self:
        """Return an object before the first of its mornings that are not over.

        done: dates of those that are; until: date of the last

        Raises InputError where a morning between others is gone, and where settings or stations changed.
        """
        shared = rso, watched, calendar, store, settings
        if not done:
            return cls(*shared, min(calendar.first(watched.first_known), until))
        for before, after in pairwise(done):
            store.check_next(before, after, rso)
        store.check_made(done[-1], rso, settings, watched.stations)
        longest = timedelta(days=_days_ahead(watched))
        records = store.records(rso, done, since=done[-1] - longest)
        return cls(*shared, done[-1] + timedelta(days=1), records)

    def run(self) -> FinishedMorning:
        """Run the next morning."""
        rso, day, plan = self.rso, self.next, self.watched.plan
        now = self.calendar.time(day)
        left = self.watched.morning(self.records, now)
        self.records = self.records.and_then(left.records, since=now - DAY * self.watched.judged_for)
        message = self.store.message(day, rso)
        write = left.write if plan.has_message else None
        if write:
            write(message, rso)
            if plan.passes:
                station_passes.write_beside(message, plan.passes)
        whole = outcome(rso, day, left, plan) | {
            "message": message.name if write else None,
            "past": past(self.records),
            "mornings": strip(self.records, plan),
            "beside_sgp4": verdicts.medians_with_sgp4(self.records.judged),
        }
        self.next = day + timedelta(days=1)
        _log.info("%s, %s: %s, %s", rso, day, left.verdict.word, left.verdict.reason)
        models = [model for paths in left.records.paths for model in paths.models]
        return left.records, whole, MorningMark(self.settings, self.watched.stations, models)


def since(done: Sequence[date], calendar: Calendar, plan: MorningPlan) -> float:
    """Return the time from which measurements count for mornings after those that are over [s]."""
    return calendar.time(done[-1]) - plan.reach - DAY if done else -np.inf


def _days_ahead(watched: WatchedObject) -> int:
    """Return how many days before a morning the oldest one is whose ephemerides may be judged."""
    return math.ceil(watched.judged_for) - 1


def check_reached(calendar: Calendar, until: date, known: float) -> None:
    """Raise InputError for a date that lies beyond what is known: its morning would be over before its day.

    known: when the last weather or measurement was [s]
    """
    if calendar.time(until) > known + OLDEST:
        (last,) = ccsds.utc_texts(calendar.epoch, np.array([known]))
        raise InputError(
            f"expected tracks or weather until {until} or the day before, got none after {last[:16]}"
        )


def one_by_one(calls: Mapping[str, Callable[[], FinishedMorning]]) -> dict[str, FinishedMorning]:
    """Run calls one after the other."""
    return {name: call() for name, call in calls.items()}


def catch_up(
    store: Store,
    objects: Sequence[UnderWay],
    until: date,
    *,
    together: Together = one_by_one,
    metadata: Mapping[str, Any],
) -> None:
    """Run the mornings of objects up to a date, day by day; one that fails goes no further.

    metadata: of tables
    """
    store.let_go()
    under_way = [one for one in objects if one.next <= until]
    first = min((one.next for one in under_way), default=until)
    while under_way:
        day = min(one.next for one in under_way)
        if made := together({one.rso: one.run for one in under_way if one.next == day}):
            store.write(day, made, metadata=metadata)
            _drop_paths(store, objects, day)
        under_way = [one for one in under_way if day < one.next <= until]
        share = ((day - first).days + 1) / ((until - first).days + 1)
        _log.info("%s: %s", day, counted(len(made), "object"), extra={"share": share})
    _drop_paths(store, objects, until)


def _drop_paths(store: Store, objects: Sequence[UnderWay], day: date) -> None:
    """Remove ephemerides that no morning after AGAIN days before a day judges."""
    longest = max((_days_ahead(one.watched) for one in objects), default=0)
    store.drop_paths(day - timedelta(days=longest + AGAIN), until=day)


def outcome(rso: str, day: date, left: MorningResult, plan: MorningPlan) -> dict[str, Any]:
    """Return what became of an object on a morning, as JSON values."""
    row = left.records.issued.iloc[0]
    age = (row["morning"] - row["t_i"]) / HOUR
    return {
        "object": rso,
        "date": day.isoformat(),
        "verdict": left.verdict.word,
        "reason": left.verdict.reason,
        "model": row["model"] or None,
        "newest_estimate": _utc(plan.epoch, row["t_i"]),
        "age_hours": round(age, 1) if np.isfinite(age) else None,
        "burn": _utc(plan.epoch, row["burn_t"]),
        **left.figures,
        "scores": scores(_selected(left.records.judged)),
    }


def _utc(epoch: str, t: float) -> str | None:
    """Return a time as UTC text, None where there is none."""
    return ccsds.utc_texts(epoch, np.array([t]))[0] if np.isfinite(t) else None


def strip(records: Records, plan: MorningPlan) -> list[dict[str, str]]:
    """Return date and verdict of the last mornings, at most STRIP."""
    last = records.issued.tail(STRIP)
    dates = (text[:_DATE] for text in ccsds.utc_texts(plan.epoch, last["morning"].to_numpy()))
    return [{"date": day, "verdict": word} for day, word in zip(dates, last["verdict"], strict=True)]


def past(records: Records) -> dict[str, list[dict[str, Any]]]:
    """Return how far all that was issued on mornings that count was off later estimates, by its verdict."""
    verdicts = records.issued.set_index("morning")["verdict"]
    selected = _selected(records.judged)
    by_verdict = selected.groupby(selected["morning"].map(verdicts))
    return {"all": scores(selected)} | {str(word): scores(rows) for word, rows in by_verdict}


def _selected(judged: pd.DataFrame) -> pd.DataFrame:
    """Return the rows of models that were selected: of these alone standard deviations were stated."""
    return judged[np.isfinite(judged["sigma_y"])]


def scores(selected: pd.DataFrame) -> list[dict[str, Any]]:
    """Return how ephemerides were off along the track, by day of their duration."""
    size, lead = selected["e_y"].abs().to_numpy(), np.ceil(selected["duration"].to_numpy() / DAY).astype(int)
    inside = sigmas_off(selected) < INSIDE
    by_day = {day: lead == day for day in np.unique(lead).tolist()}
    return [
        {
            "day": day,
            "predictions": int(rows.sum()),
            "along_track_m": rounded(np.quantile(size[rows], 0.5)),
            "along_track_95_m": rounded(np.quantile(size[rows], 0.95)),
            "inside": float(np.mean(inside[rows])),
        }
        for day, rows in by_day.items()
    ]


def failed(rso: str, day: date, verdict: str, reason: str) -> dict[str, Any]:
    """Return what became of an object whose morning could not be run, as `outcome` does."""
    return {"object": rso, "date": day.isoformat(), "verdict": verdict, "reason": reason} | NOTHING
