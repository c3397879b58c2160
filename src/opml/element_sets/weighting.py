"""Ways to improve an object's newest set: what each takes off, and how much each counts by its own past.

An improved set has two new numbers, a mean motion and a B*. Its prediction is off SGP4's by what these do.
"""

from collections.abc import Mapping

import numpy as np
import pandas as pd

from opml.element_sets import corrector
from opml.element_sets.corrector import Corrector
from opml.element_sets.set_errors import LEADS

PAST = 40  # mornings before the date whose predictions weight each candidate
BURN = 25.0  # distance of a set from those before it, in scales, that shows a burn

UNCHANGED, DENSITY, LEARNED = "unchanged", "density", "learned"

_BORROWED = 30.0  # rows of its band that count in an object's own past, so that a short one decides little
_GROSS = 4.0  # scales that a miss counts at most in the weights
_MOST_DRAG = 0.9  # largest part of its B* that is taken off a set
Candidates = Mapping[str, pd.DataFrame]  # correction and sigma [m] of rows, by the name of the candidate


def candidates(
    rows: pd.DataFrame, correctors: Mapping[str, Corrector], jump: pd.Series
) -> dict[str, pd.DataFrame]:
    """Return correction and sigma [m] of rows: none, by the density, by the corrector of each population.

    jump: of `corrector.jumps`

    The variance of an unlearned candidate is that of the learned one plus their squared difference; all are
    inflated after a jump of the sets.
    """
    learned = {
        f"{LEARNED}: {name}": corrector.widen(rows, corrector.apply(one, rows))
        for name, one in correctors.items()
    }
    surest = pd.concat(learned.values()).groupby(level=0).mean()
    unlearned = {UNCHANGED: 0.0 * rows["density"], DENSITY: rows["density"]}
    plain = {
        name: pd.DataFrame(
            {"correction": one, "sigma": np.hypot(surest["sigma"], surest["correction"] - one)}
        )
        for name, one in unlearned.items()
    }
    return {name: corrector.widen_jumps(one, jump) for name, one in (plain | learned).items()}


def weights(rows: pd.DataFrame, tried: Candidates) -> pd.DataFrame:
    """Return the weight of each candidate, a column, by the number of the object.

    rows: of mornings up to the date; those that are judged have an error

    Weights are exp(-n (l / l_min - 1) / 4), l the mean of min(|error left| / scale, 4) over n rows, l_min
    that of the best candidate; 30 rows of the band are added to the object's own. Without any the density
    counts alone.
    """
    judged = rows["is_fit"] & np.isfinite(rows["error"])
    own = rows[judged]
    left = {name: np.abs(own["error"] - one.loc[judged, "correction"]) for name, one in tried.items()}
    # A candidate without a correction of a row has the largest loss there.
    losses = pd.DataFrame(left).div(own["scale"], axis=0).clip(upper=_GROSS).fillna(_GROSS)
    of_band = losses.groupby(own["band"]).mean()
    band = rows.groupby("number")["band"].last()
    usual = of_band.reindex(band).set_axis(band.index)
    sums = losses.groupby(own["number"]).sum().reindex(band.index, fill_value=0.0)
    counts = own.groupby("number").size().reindex(band.index, fill_value=0) + _BORROWED
    # The mean loss, with rows of the band added to those of the object.
    means = (sums + _BORROWED * usual).div(counts, axis=0)
    best = means.min(axis=1)
    more = means.sub(best, axis=0).div(best, axis=0).fillna(0.0)
    likely = np.exp(-more.mul(counts / len(LEADS), axis=0))
    share = likely.div(likely.sum(axis=1), axis=0)
    return replaced(share, sole(pd.Series(DENSITY, band.index)), ~np.isfinite(means).all(axis=1))


def sole(candidate: pd.Series) -> pd.DataFrame:
    """Return weights, a column a candidate, where one counts alone."""
    return pd.get_dummies(candidate, dtype=float)


def replaced(weights: pd.DataFrame, others: pd.DataFrame, where: pd.Series) -> pd.DataFrame:
    """Return weights, but others where a condition holds."""
    kept = weights.fillna(0.0).mul(~where, axis=0)
    return kept.add(others.mul(where, axis=0), fill_value=0.0)


def of_objects(weights: pd.DataFrame, rows: pd.DataFrame) -> pd.DataFrame:
    """Return for each row the weights of its object."""
    return weights.reindex(rows["number"]).set_axis(rows.index)


def combined(rows: pd.DataFrame, tried: Candidates, weights: pd.DataFrame) -> pd.DataFrame:
    """Return rows that can be corrected with the means of correction and sigma of their candidates.

    weights: of each row; a candidate that cannot correct a row has none there

    The deviation of a mean is at most the mean of the deviations.
    """
    fit = rows.loc[rows["is_fit"], ["number", "lead", "tau", "response"]]
    corrections, sigmas = (
        np.column_stack([one.loc[fit.index, name] for one in tried.values()])
        for name in ("correction", "sigma")
    )
    weight = weights.reindex(index=fit.index, columns=[*tried]).to_numpy()
    weight = np.where(np.isfinite(corrections), np.nan_to_num(weight), 0.0)
    with np.errstate(invalid="ignore"):  # of rows without a candidate
        weight /= weight.sum(axis=1, keepdims=True)
    means = [np.where(weight == 0.0, 0.0, weight * part).sum(axis=1) for part in (corrections, sigmas)]
    return fit.assign(correction=means[0], sigma=means[1])


def changes(rows: pd.DataFrame, set_of_row: pd.Series, bstar: pd.Series) -> pd.DataFrame:
    """Return speed [m/d] and B*, by set, whose displacement along the track is nearest to the corrections.

    rows: of `combined`
    set_of_row: a label of its set
    bstar: B* of each set

    Distances count by the inverse of the time to them to the power of 1.5, as errors grow. Along the track a
    change of the mean motion goes with tau, one of B* with the response. Some of the drag stays: without it
    an orbit would rise.
    """
    # correction = speed tau + B* response, divided by tau: a line whose two normal equations, by set, are
    # solved by their determinant. Weights 1 / tau of these quotients are tau^-3 of the distances' squares.
    tau = rows["tau"]
    rate, sought = rows["response"] / tau, rows["correction"] / tau
    sums = pd.DataFrame({"n": 1.0, "r": rate, "rr": rate**2, "s": sought, "rs": rate * sought}).div(
        tau, axis=0
    )
    n, r, rr, s, rs = (sums.groupby(set_of_row).sum()[name] for name in ("n", "r", "rr", "s", "rs"))
    drag = (n * rs - r * s) / (n * rr - r * r)
    # The speed is fitted again to the drag that is allowed.
    drag = np.minimum(drag, _MOST_DRAG * bstar.reindex(drag.index))
    return pd.DataFrame({"speed": (s - drag * r) / n, "bstar": drag})
