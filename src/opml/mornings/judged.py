"""How far ephemerides of earlier mornings were off the estimates of this one."""

from collections.abc import Sequence

import numpy as np
import pandas as pd

from opml.catalog.fit import fixes
from opml.catalog.predict import labels
from opml.ephemerides.corrected import interpolate_spread
from opml.ephemerides.replays import missed
from opml.mornings.paths import Paths
from opml.mornings.records import Records
from opml.mornings.tracks import Recent
from opml.orbits.manoeuvres import Manoeuvre, contain_any
from opml.tables import DOUBT, SIGMA_STATE, SIGMAS, STATE


def later_states(estimates: pd.DataFrame, recent: Recent) -> pd.DataFrame:
    """Return what estimates tell of the orbit: j, t_j, t_known, DOUBT and a state of each that converged.

    They are `alike` where mean elements are fitted.
    """
    ends = dict(zip(recent.numbers, recent.ends, strict=True))
    known = labels.with_sigmas(estimates[estimates["converged"].astype(bool)])
    doubt = dict(zip(DOUBT, (known[name] for name in SIGMAS[:3]), strict=True))
    states = known.assign(j=known["track"], t_j=known["t"], t_known=known["track"].map(ends), **doubt)[
        ["j", "t_j", "t_known", *DOUBT, *STATE]
    ]
    return states.assign(alike=True) if fixes.are_of_sets(recent.tracking) else states


def judge(
    paths: Sequence[Paths], later: pd.DataFrame, *, manoeuvres: Sequence[Manoeuvre], window: float
) -> pd.DataFrame:
    """Return rows of the table `judged`: every model of every ephemeris against later states.

    paths: of earlier mornings
    later: from `later_states`
    manoeuvres: which no ephemeris goes across
    window: of the fits that tell the later states [s]
    """
    tables: list[pd.DataFrame] = []
    models: list[str] = []
    for one in paths:
        ahead = _ahead(one.table, later, manoeuvres=manoeuvres, window=window)
        if len(ahead):
            t_i = float(one.table["t_i"].iloc[0])
            tables.append(missed(one.arrivals, ahead, t_i=t_i, now=one.made_at))
            models += [name for name in one.models for _ in range(len(ahead))]
    if not tables:
        return Records.empty().judged
    off = pd.concat(tables, ignore_index=True)
    return off.assign(model=models, **dict.fromkeys(SIGMA_STATE, np.nan))


def _ahead(
    rows: pd.DataFrame, later: pd.DataFrame, *, manoeuvres: Sequence[Manoeuvre], window: float
) -> pd.DataFrame:
    """Return the later states that an ephemeris reaches without a manoeuvre, with its spread there."""
    t_i, t_j = float(rows["t_i"].iloc[0]), later["t_j"].to_numpy()
    reached = (t_j > t_i) & (t_j >= rows["t_j"].iloc[0]) & (t_j <= rows["t_j"].iloc[-1])
    # A fit to tracks from both sides of a manoeuvre tells no orbit.
    across = contain_any(np.full(len(t_j), t_i), t_j, manoeuvres, window=window)
    return interpolate_spread(later[reached & ~across].assign(i=rows["i"].iloc[0]), rows)
