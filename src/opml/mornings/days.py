"""The mornings of an object up to a day, each with a folder of what it left."""

import json
import logging
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from datetime import date, timedelta
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from opml.base.constants import DAY, HOUR
from opml.base.errors import InputError
from opml.base.provenance import settings_digest
from opml.interop import ccsds, oem
from opml.learning.judge.error_sizes import INSIDE, along_track
from opml.mornings import beside_sgp4
from opml.mornings.calendar import HORIZON, Calendar
from opml.mornings.judged import OLDEST
from opml.mornings.morning import Left, MorningPlan, Watched, morning
from opml.mornings.outcomes import NOTHING
from opml.mornings.records import DONE, Records
from opml.tables import read_metadata

STRIP = 30
"""Mornings whose verdicts the page of a day shows in a row."""

_DATE = len("2016-09-28")
_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Folder:
    """The folder of all days, of one object.

    days: the folder
    rso: name of the object
    """

    days: Path
    rso: str

    def of_day(self, day: date) -> Path:
        """Return where what a morning left of the object is."""
        return self.days / day.isoformat() / self.rso

    def done(self, until: date) -> list[date]:
        """Return the dates up to one of the mornings that are over, ascending."""
        found = self.days.glob(f"[0-9]*/{self.rso}/{DONE}")
        days = (date.fromisoformat(path.parent.parent.name) for path in found)
        return sorted(day for day in days if day <= until)


def since(folder: Folder, calendar: Calendar, plan: MorningPlan, until: date) -> float:
    """Return the time from which measurements count for the mornings up to a date [s]."""
    done = folder.done(until)
    return calendar.time(done[-1]) - plan.reach - DAY if done else -np.inf


def last_known(tracking: pd.DataFrame) -> float:
    """Return when the last of what was measured was known [s]."""
    return float(tracking["t_known" if "t_known" in tracking else "t"].max())


def check_reached(calendar: Calendar, until: date, known: float) -> None:
    """Raise InputError for a date that lies beyond what is known: its morning would be over before its day.

    known: when the last weather or measurement was [s]
    """
    if calendar.time(until) > known + OLDEST:
        (last,) = ccsds.utc_texts(calendar.epoch, np.array([known]))
        raise InputError(
            f"expected tracks or weather until {until} or the day before, got none after {last[:16]}"
        )


def catch_up(
    folder: Folder, watched: Watched, calendar: Calendar, until: date, *, metadata: Mapping[str, Any]
) -> None:
    """Run the mornings of an object up to a date that are not over yet; those before it first.

    Raises InputError where a morning cannot be run.
    """
    done = folder.done(until)
    counting, reach = done[-HORIZON:], DAY * watched.plan.max_days
    _check_whole(folder, counting)
    stations = {station.name: settings_digest(station.row) for station in watched.stations}
    measured = set(watched.tracking.get("station", ()))
    _check_places(folder, counting, {name: one for name, one in stations.items() if name in measured})
    records = Records.read(
        [folder.of_day(day) for day in counting],
        since=calendar.time(done[-1]) - reach if done else 0.0,
        digest=metadata["settings"],
    )
    missing = list(_missing(done, watched, calendar, until))
    for number, day in enumerate(missing, start=1):
        now = calendar.time(day)
        left = morning(watched, records, now=now)
        records = records.and_then(left.records, since=now - reach)
        _write(folder, day, left, records, watched, metadata={**metadata, "stations": stations})
        told = f"{folder.rso}, {day}, morning {number} of {len(missing)}"
        share = {"share": number / len(missing)}
        _log.info("%s: %s, %s", told, left.verdict.word, left.verdict.reason, extra=share)


def _check_whole(folder: Folder, done: list[date]) -> None:
    """Raise InputError where a morning between others is gone: those behind it stand on it."""
    for before, after in pairwise(done):
        if (gone := before + timedelta(days=1)) != after:
            raise InputError(
                f"{folder.of_day(gone)}: expected the morning that later ones stand on, got none; "
                "put it back, or remove those behind it, and all are run again"
            )


def _check_places(folder: Folder, done: list[date], stations: Mapping[str, str]) -> None:
    """Raise InputError where a station that measured is another than at the last of some mornings."""
    for place in map(folder.of_day, done[-1:]):
        before = read_metadata(place / "issued.parquet").get("stations", {})
        for name, digest in stations.items():
            if before.get(name, digest) != digest:
                raise InputError(
                    f"{place}: expected the station {name} as it measured then, got other numbers of it; "
                    "give another folder of results, or remove these"
                )


def _missing(done: list[date], watched: Watched, calendar: Calendar, until: date) -> Iterator[date]:
    """Yield the dates of the mornings to be run: after the last, or from when the first track is over."""
    tracking = watched.tracking
    first = tracking.groupby("track")["t_known" if "t_known" in tracking else "t"].max().min()
    day = done[-1] + timedelta(days=1) if done else min(calendar.first(float(first)), until)
    while day <= until:
        yield day
        day += timedelta(days=1)


def _write(
    folder: Folder, day: date, left: Left, records: Records, watched: Watched, *, metadata: Mapping[str, Any]
) -> None:
    """Write what a morning left: the message first, the records behind it."""
    place, plan = folder.of_day(day), watched.plan
    if left.ephemeris is not None:
        identity = replace(watched.identity, name=folder.rso)
        segments = oem.segments_of(left.ephemeris, "corrected", identity)
        oem.write(place / f"{folder.rso}.oem", segments, epoch=plan.epoch, comment=left.basis)
    found = outcome(folder.rso, day, left, plan) | {
        "past": past(records),
        "mornings": strip(records, plan),
        "beside_sgp4": beside_sgp4.medians(records.judged),
    }
    left.records.write(place, found, metadata=metadata)


def outcome(rso: str, day: date, left: Left, plan: MorningPlan) -> dict[str, Any]:
    """Return what became of an object on a morning, as JSON values."""
    row, made = left.records.issued.iloc[0], left.records.estimates
    base = made[made["window_hours"] == plan.base]
    return {
        "object": rso,
        "date": day.isoformat(),
        "verdict": left.verdict.word,
        "reason": left.verdict.reason,
        "model": row["model"] or None,
        "message": f"{rso}.oem" if left.ephemeris is not None else None,
        "newest_estimate": _utc(plan.epoch, row["t_i"]),
        "age_hours": _age(row["morning"] - row["t_i"]),
        "burn": _utc(plan.epoch, row["burn_t"]),
        "tracks": len(base),
        "converged": int(base["converged"].sum()),
        "late": left.recent.late,
        "expected": [] if left.ephemeris is None else expected(left.ephemeris),
        "scores": scores(_flown(left.records.judged)),
    }


def _age(seconds: float) -> float | None:
    """Return an age in hours, None where nothing has one."""
    return round(seconds / HOUR, 1) if np.isfinite(seconds) else None


def _utc(epoch: str, t: float) -> str | None:
    """Return a time as UTC text, None where there is none."""
    return ccsds.utc_texts(epoch, np.array([t]))[0] if np.isfinite(t) else None


def expected(ephemeris: pd.DataFrame) -> list[dict[str, float]]:
    """Return the standard deviations of an ephemeris in RSW [m], days after its estimate.

    ephemeris: table `corrected`
    """
    t, begin = ephemeris["t"].to_numpy(), float(ephemeris["t_i"].iloc[0])
    leads = np.arange(1.0, np.round((t[-1] - begin) / DAY, 2) + 1e-9)
    at = [np.interp(begin + DAY * leads, t, np.sqrt(ephemeris[f"cov_{axis}_{axis}"])) for axis in "yxz"]
    names = ("day", "along_track_sigma_m", "radial_sigma_m", "cross_track_sigma_m")
    rows = zip(leads.astype(int).tolist(), *(map(_rounded, sigma) for sigma in at), strict=True)
    return [dict(zip(names, row, strict=True)) for row in rows]


def strip(records: Records, plan: MorningPlan) -> list[dict[str, str]]:
    """Return date and verdict of the last mornings, at most STRIP."""
    last = records.issued.tail(STRIP)
    dates = (text[:_DATE] for text in ccsds.utc_texts(plan.epoch, last["morning"].to_numpy()))
    return [{"date": day, "verdict": word} for day, word in zip(dates, last["verdict"], strict=True)]


def past(records: Records) -> dict[str, list[dict[str, Any]]]:
    """Return how all that was flown on the mornings that count was off later estimates, by its verdict."""
    verdicts = records.issued.set_index("morning")["verdict"]
    flown = _flown(records.judged)
    by_verdict = flown.groupby(flown["morning"].map(verdicts))
    return {"all": scores(flown)} | {str(word): scores(rows) for word, rows in by_verdict}


def _flown(judged: pd.DataFrame) -> pd.DataFrame:
    """Return the rows of models that were flown: of these alone standard deviations were stated."""
    return judged[np.isfinite(judged["sigma_y"])]


def scores(flown: pd.DataFrame) -> list[dict[str, Any]]:
    """Return how ephemerides were off along the track, by day of their duration."""
    size, lead = flown["e_y"].abs().to_numpy(), np.ceil(flown["duration"].to_numpy() / DAY).astype(int)
    inside = size < INSIDE * along_track(flown)
    by_day = {day: lead == day for day in np.unique(lead).tolist()}
    return [
        {
            "day": day,
            "predictions": int(rows.sum()),
            "along_track_m": _rounded(np.quantile(size[rows], 0.5)),
            "along_track_95_m": _rounded(np.quantile(size[rows], 0.95)),
            "inside": float(np.mean(inside[rows])),
        }
        for day, rows in by_day.items()
    ]


def _rounded(length: float) -> float:
    """Return a length to a decimetre [m]."""
    return round(float(length), 1)


def failed(rso: str, day: date, verdict: str, reason: str) -> dict[str, Any]:
    """Return what became of an object whose morning could not be run, as `outcome` does."""
    told = {"object": rso, "date": day.isoformat(), "verdict": verdict, "reason": reason}
    return told | NOTHING


def read_outcome(path: Path) -> dict[str, Any]:
    """Return what became of an object on a morning."""
    return json.loads(path.read_text(encoding="utf-8"))
