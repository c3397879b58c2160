"""The corrector: what a catalogue teaches of what is left of a density-scaled prediction along the track.

It is gradient boosting with absolute loss, for three groups of bands, all leads together. How much of it is
believed, and how large what it leaves may be, comes from objects and weeks held out.
"""

import os
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing import get_context

import numpy as np
import pandas as pd
from threadpoolctl import threadpool_limits

from opml.base.errors import InputError
from opml.base.seeds import derive
from opml.element_sets.features import BANDS, FEATURES
from opml.element_sets.set_errors import LEADS
from opml.learning.models import boosting
from opml.learning.models.boosting import BoostingModel
from opml.learning.models.contract import Model
from opml.learning.models.training_inputs import subsample

LEVEL = 0.9  # share of the errors that the learned size holds
FEWEST = 2000  # rows below which nothing is learned for a part of the catalogue
NORMAL = 1.6449  # standard deviations within which LEVEL of normal errors lie

Parts = Sequence[tuple[tuple[int, ...], tuple[int, ...]]]  # bands and leads that are learned together

PARTS: Parts = tuple((bands, LEADS) for bands in ((0, 1, 2, 3), (4,), tuple(range(5, len(BANDS) - 1))))
_TREES = {"max_iter": 150, "learning_rate": 0.08, "max_features": 0.5, "early_stopping": False}
_LEAVES, _ROWS_A_LEAF = 31, 300
_MOST_ROWS = 200_000
_SIZE_LEAVES = 15
_SMALLEST = 1e-4  # of what is left, in scales
_BLOCK = 28  # days
_FEWEST_HELD_OUT = 200
_TRIED = np.linspace(0.0, 1.2, 13)
_MEMORY, _LATELY = 40.0, 3.0  # days before a morning whose judged errors tell whether sigmas hold
_FEWEST_RECENT = 200
_SHARE, _POWER = 0.92, 0.75
"""Quantile of errors, and power of the last days' relative to it, by the log score of spring 2026."""

JUMP = 5.0
"""Distance of a set from those before it, in typical ones, beyond which sigmas are too small.

Of 53 360 corrected errors of 2022-23 and 2025, 90 % intervals held 88 to 97 % below, and 60 % above.
"""

_USUAL = {"window": 20, "min_periods": 8}  # earlier mornings that give that typical distance
_WIDER = 0.5  # part of a jump that sigmas are wider by
_BATCH = 100_000  # rows that are corrected at a time: a catalogue's would need a third more memory


Shares = Mapping[tuple[int, int], float]  # shares of learned corrections by band and lead


@dataclass(frozen=True, eq=False)
class BandModels:
    """Models of some bands and leads."""

    bands: tuple[int, ...]
    leads: tuple[int, ...]
    miss: Model  # of what is left of the density-scaled prediction, in scales
    size: BoostingModel  # of the logarithm of the size of what the correction leaves, in scales
    shares: Shares  # by band and lead, how much of the miss is taken off


Corrector = tuple[BandModels, ...]  # of one population


def apply(corrector: Corrector, rows: pd.DataFrame) -> pd.DataFrame:
    """Return what to take off SGP4's position along the track, and its sigma, for rows of features.

    Columns: correction [m], sigma [m]; NaN for rows that cannot be corrected.
    """
    corrections = pd.DataFrame(np.nan, index=rows.index, columns=["correction", "sigma"])
    for part in corrector:
        learned = pd.MultiIndex.from_tuples(part.shares)
        is_own = rows["is_fit"] & pd.MultiIndex.from_frame(rows[["band", "lead"]]).isin(learned)
        members = np.flatnonzero(is_own)
        for batch in (members[begin : begin + _BATCH] for begin in range(0, len(members), _BATCH)):
            own = rows.iloc[batch]
            scale = own["scale"].to_numpy()
            miss = part.miss.predict(own[list(part.miss.variables)].to_numpy())
            size = part.size.predict(own[list(part.size.variables)].to_numpy())
            miss *= _share_of(own, part.shares)
            corrections.iloc[batch, 0] = own["density"].to_numpy() + scale * miss
            corrections.iloc[batch, 1] = scale * np.exp(size) / NORMAL
    return corrections


def widen(rows: pd.DataFrame, found: pd.DataFrame) -> pd.DataFrame:
    """Return what `apply` found, sigmas wider where too few of the last errors were inside.

    rows: those of `found`, of several mornings

    Errors count whose judge was known on the morning, of all bands together: those of a lead over _MEMORY
    days, and those of a day over _LATELY days relative to these, which show first what all objects miss. No
    sigma is made smaller.
    """
    off = ((rows["error"] - found["correction"]) / (NORMAL * found["sigma"])).abs()
    known = rows[["lead", "judged"]].assign(off=off).dropna().sort_values("judged")
    mornings = np.unique(rows["morning"])
    of_a_day = known[known["lead"] == LEADS[0]]
    lately = _outermost(of_a_day, mornings, _LATELY) / _outermost(of_a_day, mornings, _MEMORY)
    lately = np.nan_to_num(lately, nan=1.0) ** _POWER
    factor = pd.Series(1.0, index=rows.index)
    for lead, part in rows["morning"].groupby(rows["lead"]):
        wider = lately * _outermost(known[known["lead"] == lead], mornings, _MEMORY)
        factor[part.index] = np.fmax(wider, 1.0)[np.searchsorted(mornings, part)]
    return found.assign(sigma=found["sigma"] * factor)


def _outermost(known: pd.DataFrame, mornings: np.ndarray, days: float) -> np.ndarray:
    """Return how many intervals off _SHARE of the errors are at most that were judged in so many days before
    mornings (n,); NaN where these are few.

    known: errors by the time of their judge
    """
    off, judged = known["off"].to_numpy(), known["judged"].to_numpy()
    spans = np.searchsorted(judged, [mornings - days, mornings], side="right").T
    return np.array([np.quantile(off[a:b], _SHARE) if b - a >= _FEWEST_RECENT else np.nan for a, b in spans])


def jumps(rows: pd.DataFrame) -> pd.Series:
    """Return how many times as far as usual the newest sets of rows miss those before them; NaN if untold.

    rows: of `features.build`, mornings in order; nine in ten of the object's last ones are usual
    """
    # Lead by lead: all at once would take a quarter more memory.
    usual = [
        of_lead.groupby("number")["missed"].rolling(**_USUAL, closed="left").quantile(LEVEL).droplevel(0)
        for _, of_lead in rows[["number", "missed"]].groupby(rows["lead"])
    ]
    return rows["missed"] / pd.concat([rows["missed"][:0], *usual]).reindex(rows.index)


def widen_jumps(found: pd.DataFrame, jump: pd.Series) -> pd.DataFrame:
    """Return corrections with wider sigmas where a set jumped: a burn, or a storm, of unknown consequence."""
    return found.assign(sigma=found["sigma"] * (_WIDER * jump).where(jump > JUMP, 1.0))


Fit = Callable[[pd.DataFrame, int], Model]  # learns the target of rows; the seed is the second argument


def fit_trees(rows: pd.DataFrame, seed: int) -> BoostingModel:
    """Return trees of the target of rows, with absolute loss."""
    return _boosted(rows, rows["target"].to_numpy(), seed, loss="absolute_error", leaves=_LEAVES)


def fit(rows: pd.DataFrame, *, seed: int, parts: Parts = PARTS, learn: Fit = fit_trees) -> Corrector:
    """Learn from the rows of `features.build` that have a target, each part by itself.

    Raises InputError where no part of the catalogue has enough rows.
    """
    known = rows[rows["is_fit"] & np.isfinite(rows["target"])]
    jobs = [
        (drawn_rows(part, _MOST_ROWS, seed), bands, leads, learn, seed)
        for bands, leads in parts
        if len(part := known[known["band"].isin(bands) & known["lead"].isin(leads)]) >= FEWEST
    ]
    if not jobs:
        expected = f"{FEWEST} rows with a later set to learn from"
        raise InputError(f"element sets: expected {expected} in a group of heights, got {len(known)} in all")
    # Each part is learned by one thread, so that sums have one order: several parts side by side.
    with ProcessPoolExecutor(min(len(jobs), os.cpu_count() or 1), mp_context=get_context("spawn")) as pool:
        return tuple(pool.map(_fit_part, *zip(*jobs, strict=True)))


def _fit_part(
    rows: pd.DataFrame, bands: tuple[int, ...], leads: tuple[int, ...], fit: Fit, seed: int
) -> BandModels:
    """Learn the miss from rows of a part, and from rows held out how far to believe it and what it leaves."""
    held_out = _held_out(rows, fit, seed)
    shares = _shares(rows, held_out)
    # Sizes are of what would have been left of rows held out: of rows that were learned from less is left.
    left = (rows["error"] - rows["density"]) / rows["scale"] - _share_of(rows, shares) * held_out
    size = np.log(np.maximum(np.abs(left.to_numpy()), _SMALLEST))
    sizes = _boosted(rows, size, seed, loss="quantile", leaves=_SIZE_LEAVES)
    return BandModels(bands, leads, fit(rows, seed), sizes, shares)


def _held_out(rows: pd.DataFrame, fit: Fit, seed: int) -> np.ndarray:
    """Return predictions (n,) by models that saw neither the object of a row nor its weeks.

    Objects fall into two halves, and so do blocks of four weeks, by turns.
    """
    half = drawn_halves(rows["number"].to_numpy(), "half", seed=seed)
    block = np.floor(rows["morning"].to_numpy() / _BLOCK).astype(int) % 2
    predicted = np.zeros(len(rows))
    for own in (0, 1):
        for weeks in (0, 1):
            seen, wanted = (half != own) & (block != weeks), (half == own) & (block == weeks)
            if np.count_nonzero(seen) >= _FEWEST_HELD_OUT and wanted.any():
                model = fit(rows[seen], seed)
                predicted[wanted] = model.predict(rows.loc[wanted, list(model.variables)].to_numpy())
    return predicted


def drawn_halves(numbers: np.ndarray, name: str, *, seed: int) -> np.ndarray:
    """Return 0 or 1 for each catalogue number (n,), by the number, the draw's name and the seed alone."""
    objects, place = np.unique(numbers, return_inverse=True)
    draws = [int(derive(seed, name, str(one)).integers(2)) for one in objects]
    return np.array(draws, dtype=int)[place]


def _shares(rows: pd.DataFrame, held_out: np.ndarray) -> Shares:
    """Return by band and lead the share of the held-out predictions that leaves least of the targets."""
    target = rows["target"].to_numpy()
    shares = {}
    for key, members in rows.groupby(["band", "lead"]).indices.items():
        losses = [np.abs(target[members] - share * held_out[members]).sum() for share in _TRIED]
        shares[key] = float(_TRIED[int(np.argmin(losses))])
    return shares


def _share_of(rows: pd.DataFrame, shares: Shares) -> np.ndarray:
    """Return the shares (n,) of rows of bands and leads that have one."""
    return np.array([shares[key] for key in zip(rows["band"], rows["lead"], strict=True)])


def drawn_rows(rows: pd.DataFrame, most: int, seed: int) -> pd.DataFrame:
    """Return at most so many rows, drawn at random, in their order."""
    return rows.iloc[subsample(len(rows), most, derive(seed, "rows"))]


def _boosted(rows: pd.DataFrame, target: np.ndarray, seed: int, *, loss: str, leaves: int) -> BoostingModel:
    """Return trees of a target; rows count by the inverse of the median target of their band and lead."""
    from sklearn.ensemble import HistGradientBoostingRegressor  # imported only to train: it takes a second

    sizes = np.abs(rows["target"]).groupby([rows["band"], rows["lead"]]).transform("median")
    machine = HistGradientBoostingRegressor(
        **_TREES,
        loss=loss,
        quantile=LEVEL if loss == "quantile" else None,
        max_leaf_nodes=leaves,
        min_samples_leaf=min(_ROWS_A_LEAF, max(20, len(rows) // 50)),
        random_state=int(derive(seed, "trees").integers(2**31)),
    )
    # An object alone in its band is its own median: it has nothing to teach.
    weights = np.divide(1.0, sizes, out=np.zeros(len(rows)), where=sizes.to_numpy() > 0.0)
    with threadpool_limits(limits=1):  # sums in one order, whatever the machine
        machine.fit(rows[list(FEATURES)].to_numpy(), target, weights)
    return boosting.from_machine(machine, FEATURES)
