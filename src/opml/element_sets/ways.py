"""Ways to improve an object's newest set: what each takes off, and which one its own past shows to be best.

An improved set has two new numbers, a mean motion and a B*. Its prediction is off SGP4's by what these do.
"""

from collections.abc import Mapping

import numpy as np
import pandas as pd

from opml.element_sets import corrector
from opml.element_sets.corrector import Corrector

PAST = 20
"""Mornings before the date whose predictions tell which way an object gets."""

BURN = 25.0
"""Scales by which a set misses those before it where the object has burned."""

UNCHANGED, DENSITY, LEARNED = "unchanged", "density", "learned"

_BORROWED = 30.0
"""Rows of its band that count in an object's own past, so that a short one decides little."""

_GROSS = 4.0
"""Largest part of a scale that a miss counts in the choice."""

_MOST_DRAG = 0.9
"""Largest part of its B* that is taken off a set."""

Ways = Mapping[str, pd.DataFrame]
"""By the name of the way, correction and sigma [m] of rows."""


def candidates(rows: pd.DataFrame, correctors: Mapping[str, Corrector]) -> dict[str, pd.DataFrame]:
    """Return correction and sigma [m] of rows by each way: not, by the density, as each population taught.

    A prediction apart from the learned one is as unsure as that, and as they are apart; after a jump of the
    sets all are unsurer.
    """
    learned = {
        f"{LEARNED}: {name}": corrector.widen(rows, one.apply(rows)) for name, one in correctors.items()
    }
    surest = pd.concat(learned.values()).groupby(level=0).mean()
    ways = {UNCHANGED: 0.0 * rows["density"], DENSITY: rows["density"]}
    plain = {
        name: pd.DataFrame(
            {"correction": one, "sigma": np.hypot(surest["sigma"], surest["correction"] - one)}
        )
        for name, one in ways.items()
    }
    jump = corrector.jumps(rows)
    return {name: corrector.widen_jumps(one, jump) for name, one in (plain | learned).items()}


def choice(rows: pd.DataFrame, ways: Ways) -> pd.Series:
    """Return the way by the number of the object: the one that left least of the predictions that are judged.

    Rows of the whole band stand in where an object has few of its own.
    """
    judged = rows["is_fit"] & np.isfinite(rows["error"])
    own = rows[judged]
    left = {name: np.abs(own["error"] - one.loc[judged, "correction"]) for name, one in ways.items()}
    losses = pd.DataFrame(left).div(own["scale"], axis=0).clip(upper=_GROSS).fillna(_GROSS)
    of_band = losses.groupby(own["band"]).mean()
    band = rows.groupby("number")["band"].last()
    usual = of_band.reindex(band).set_axis(band.index)
    sums = losses.groupby(own["number"]).sum().reindex(band.index, fill_value=0.0)
    counts = own.groupby("number").size().reindex(band.index, fill_value=0)
    scores = (sums + _BORROWED * usual).div(counts + _BORROWED, axis=0)
    chosen = scores.fillna(np.inf).idxmin(axis=1)
    return chosen.where(np.isfinite(scores.min(axis=1)), DENSITY)


def choices(rows: pd.DataFrame, ways: Ways) -> pd.Series:
    """Return the way of each row, as `choice` makes it on the row's morning of what was judged by then.

    rows: of objects that can be corrected, on mornings a day apart
    """
    of_row = pd.Series(UNCHANGED, index=rows.index)
    for morning in np.unique(rows["morning"]):
        past = rows[rows["morning"].between(morning - PAST, morning)]
        known = past.assign(error=past["error"].where(past["judged"] <= morning))
        chosen = choice(known, {name: one.loc[past.index] for name, one in ways.items()})
        today = past.loc[past["morning"] == morning, "number"]
        of_row[today.index] = today.map(chosen)
    missed = rows.groupby(["number", "morning"])["missed"].transform("max")
    return of_row.mask(missed > BURN, UNCHANGED)


def of_way(rows: pd.DataFrame, ways: Ways, way: pd.Series) -> pd.DataFrame:
    """Return rows that can be corrected with correction and sigma of their way.

    way: of each row
    """
    parts = [
        rows[["number", "lead", "tau", "response"]].join(one)[rows["is_fit"] & way.eq(name)]
        for name, one in ways.items()
    ]
    return pd.concat(parts).sort_index()


def changes(rows: pd.DataFrame, set_of_row: pd.Series, bstar: pd.Series) -> pd.DataFrame:
    """Return speed [m/d] and B*, by set, whose displacement along the track is nearest to the corrections.

    rows: of `of_way`
    set_of_row: what tells the sets apart
    bstar: B* of each set

    Distances count by the inverse of the time to them to the power of 1.5, as errors grow. Along the track a
    change of the mean motion goes with tau, one of B* with the response. Some of the drag stays: without it
    an orbit would rise.
    """
    tau = rows["tau"]
    rate, sought = rows["response"] / tau, rows["correction"] / tau
    sums = pd.DataFrame({"n": 1.0, "r": rate, "rr": rate**2, "s": sought, "rs": rate * sought}).div(
        tau, axis=0
    )
    n, r, rr, s, rs = (sums.groupby(set_of_row).sum()[name] for name in ("n", "r", "rr", "s", "rs"))
    drag = (n * rs - r * s) / (n * rr - r * r)
    drag = np.minimum(drag, _MOST_DRAG * bstar.reindex(drag.index))
    return pd.DataFrame({"speed": (s - drag * r) / n, "bstar": drag})


def displacement(rows: pd.DataFrame, set_of_row: pd.Series, bstar: pd.Series) -> pd.Series:
    """Return what the two numbers of `changes` take off SGP4's position along the track [m], row by row."""
    of_row = changes(rows, set_of_row, bstar).reindex(set_of_row).set_axis(rows.index)
    return of_row["speed"] * rows["tau"] + of_row["bstar"] * rows["response"]
