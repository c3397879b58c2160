"""Judgement of earlier ephemerides by the estimates of a morning, and whether to trust the next."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from opml.base.constants import DAY, HOUR
from opml.base.progress import counted
from opml.catalog.predict import labels
from opml.ephemerides.paths import spread_at
from opml.mornings import issued
from opml.mornings.fits import FAR, Recent, sigmas_off
from opml.mornings.outcomes import DO_NOT_USE, GOOD, UNPROVEN, WIDE
from opml.mornings.records import Records
from opml.mornings.watched_object import Watched
from opml.orbits.manoeuvres import Manoeuvre, contain_any
from opml.orbits.rsw_covariance import INSIDE, LEVEL
from opml.tables import DOUBT, SIGMA_STATE, SIGMAS, STATE


def later_states(estimates: pd.DataFrame, recent: Recent) -> pd.DataFrame:
    """Return what estimates tell of the orbit: j, t_j, t_known, DOUBT and a state of each that converged."""
    ends = dict(zip(recent.numbers, recent.ends, strict=True))
    known = labels.with_sigmas(estimates[estimates["converged"].astype(bool)])
    doubt = dict(zip(DOUBT, (known[name] for name in SIGMAS[:3]), strict=True))
    columns = ["j", "t_j", "t_known", *DOUBT, *STATE]
    return known.assign(j=known["track"], t_j=known["t"], t_known=known["track"].map(ends), **doubt)[columns]


def judge(watched: Watched, estimates: pd.DataFrame, recent: Recent, records: Records) -> pd.DataFrame:
    """Return rows of the table `judged`: every model of every earlier ephemeris against new estimates.

    estimates: of a morning
    records: of earlier mornings
    """
    later = {name: column.to_numpy() for name, column in later_states(estimates, recent).items()}
    parts: list[dict[str, np.ndarray]] = []
    models: list[str] = []
    for one in records.paths:
        ahead = _ahead(one.table, later, watched)
        if count := len(ahead["t_j"]):
            parts.append(one.differences(ahead))
            models += [name for name in one.models for _ in range(count)]
    if not parts:
        return Records.empty().judged
    columns = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    off = pd.DataFrame(columns | {"model": models} | dict.fromkeys(SIGMA_STATE, np.nan))
    return issued.with_sigmas(off, records.issued)


def _ahead(rows: pd.DataFrame, later: Mapping[str, np.ndarray], watched: Watched) -> dict[str, np.ndarray]:
    """Return the later states that an ephemeris reaches without a manoeuvre, with its spread there."""
    t_i, t_j = float(rows["t_i"].iloc[0]), later["t_j"]
    reached = (t_j > t_i) & (t_j >= rows["t_j"].iloc[0]) & (t_j <= rows["t_j"].iloc[-1])
    # A fit to tracks from both sides of a manoeuvre tells no orbit.
    begin, window = np.full(len(t_j), t_i), watched.plan.base * HOUR
    reached &= ~contain_any(begin, t_j, watched.manoeuvres, window=window)
    ahead = {name: values[reached] for name, values in later.items()}
    return ahead | {"i": np.full(reached.sum(), rows["i"].iloc[0])} | spread_at(ahead["t_j"], rows)


SGP4 = "sgp4"  # name of SGP4 from the newest public set among models

OLDEST = 1.5 * DAY  # oldest estimate that an ephemeris should start from [s]
FEWEST = 7  # mornings whose ephemerides were judged, below which intervals are hardly known
PAST = 14.0 * DAY  # how far back intervals are looked at [s]
LEAST_INSIDE = 0.85  # share of these that intervals of 90 % have to contain
LEAST_OF_DAY = 0.7
"""Share of these on any day ahead: a fortnight has few independent errors of each, and of seven such shares
the least is below the other by chance on every second morning."""

RARE = 3.0  # standard deviations that one of the newest errors hardly reaches by chance: drag rises, say


@dataclass(frozen=True)
class Verdict:
    """A verdict and its reason."""

    word: str
    reason: str


def verdict(
    judged: pd.DataFrame,
    start: pd.DataFrame,
    *,
    now: float,
    burns: Sequence[Manoeuvre] = (),
    window: float = 0.0,
) -> Verdict:
    """Return the verdict on an ephemeris from an estimate, by what was judged by `now` [s].

    judged: rows of that table of all mornings
    burns: all that anybody knows of
    window: of the fits [s], which is cut short behind one
    """
    begin = float(start["t"].iloc[0])
    age, burned = now - begin, max((one.t for one in burns if one.counts_from <= now), default=-np.inf)
    selected = judged[np.isfinite(judged["sigma_y"].to_numpy(float))]
    off = sigmas_off(selected)
    # On a day without tracks the last ones still have their say.
    last = (selected["t_known"] > selected["t_known"].max() - DAY).to_numpy(bool)
    newest = last & (selected["duration"] < 2.0 * DAY).to_numpy(bool)
    recent = (selected["t_known"] > now - PAST).to_numpy(bool)
    mornings = judged["morning"].nunique()
    if age > OLDEST:
        return Verdict(DO_NOT_USE, f"the newest estimate is {age / DAY:.1f} days old")
    if begin - burned < window:
        return Verdict(DO_NOT_USE, f"a burn {(now - burned) / HOUR:.0f} hours ago, after which fits begin")
    if newest.any() and np.median(off[newest]) > FAR:
        return Verdict(
            DO_NOT_USE,
            f"the newest estimates are {np.median(off[newest]):.0f} sigma off the ephemeris before: "
            "a storm, another object, or a burn that the tracks do not show",
        )
    if mornings < FEWEST:
        return Verdict(UNPROVEN, f"judged so far: {counted(mornings, 'morning')}, fewer than {FEWEST}")
    if not recent.any():
        return Verdict(UNPROVEN, f"nothing was judged in the last {PAST / DAY:.0f} days")
    share, most = float(np.mean(off[recent] < INSIDE)), off[newest].max(initial=0.0)
    least, day = _least_inside(off[recent], selected["duration"].to_numpy(float)[recent])
    intervals = f"its {100 * LEVEL:g} % intervals contained"
    if share < LEAST_INSIDE:
        return Verdict(WIDE, f"{intervals} {100 * share:.0f} % of the last errors")
    if least < LEAST_OF_DAY:
        return Verdict(WIDE, f"{intervals} {100 * least:.0f} % of the last errors on day {day:.0f} ahead")
    if most > RARE:
        return Verdict(WIDE, f"one of the newest estimates is {most:.1f} sigma off the ephemeris before")
    return Verdict(GOOD, f"{intervals} {100 * share:.0f} % of the last errors")


def _least_inside(off: np.ndarray, duration: np.ndarray) -> tuple[float, float]:
    """Return the least share inside intervals of a day ahead, and its number.

    off: (n,) in standard deviations
    duration: (n,) [s]

    Days of few errors count only where no day has many.
    """
    shares = pd.Series(off < INSIDE).groupby(np.ceil(duration / DAY)).agg(["mean", "size"])
    known = shares[shares["size"] >= min(FEWEST, shares["size"].max())]["mean"]
    return float(known.min()), float(known.idxmin())


def medians_with_sgp4(judged: pd.DataFrame) -> list[dict[str, Any]]:
    """Return medians by day ahead [m]: how far the selected model, and SGP4 at the same epochs, were off.

    With the number of mornings that it was judged on.

    judged: rows of that table
    """
    keys = ["morning", "j"]
    sgp4 = judged[judged["model"] == SGP4].set_index(keys)["e_y"].rename("sgp4_m")
    both = judged[np.isfinite(judged["sigma_y"])].join(sgp4, on=keys, how="inner")
    by_day = both.rename(columns={"e_y": "flown_m"}).groupby(
        np.ceil(both["duration"] / DAY).astype(int).rename("day")
    )
    sizes = by_day[["flown_m", "sgp4_m"]].agg(lambda errors: errors.abs().median()).round(1)
    return sizes.assign(mornings=by_day["morning"].nunique()).reset_index().to_dict("records")
