"""Constant errors of instruments: how fits bear them, and what residuals tell of them and of the noise.

An instrument is one observable of a station. Its constant error b within a window has a standard deviation of
s beforehand, in those of its noise. To estimate all b besides the orbit, or to let them correlate the noise,
comes to the same: the weights of the n numbers of an instrument are (I + s^2 11')^-1, whose root takes from
residuals and derivatives a part of their mean, 1 - 1 / sqrt(1 + n s^2).
Source: Tapley, Schutz & Born 2004, Statistical Orbit Determination, sec. 6.2 (consider parameters); Sherman &
Morrison 1950, Annals of Mathematical Statistics 21, 124-127.
"""

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from opml.catalog.fit.least_squares import Evaluation
from opml.catalog.fit.measurements import Measurements

if TYPE_CHECKING:
    from opml.catalog.fit.estimation import Estimate


def whitened(evaluation: Evaluation, instruments: np.ndarray, sigma: float) -> Evaluation:
    """Return an evaluation whose residuals do not correlate, where each instrument has a constant error.

    instruments: (numbers,) of each residual, from 0 on
    sigma: standard deviation of a constant error, in those of the noise
    """
    columns = np.column_stack([evaluation.residuals, evaluation.jacobian])
    count = np.bincount(instruments)
    sums = np.stack([np.bincount(instruments, column) for column in columns.T], axis=-1)
    part = (1.0 - 1.0 / np.sqrt(1.0 + count * sigma**2)) / np.maximum(count, 1)
    columns -= (part[:, None] * sums)[instruments]
    return Evaluation(columns[:, 0], columns[:, 1:])


def summary(instruments: np.ndarray, weighted: np.ndarray) -> pd.DataFrame:
    """Return what residuals tell of the instruments that they are of, one a row.

    instruments: (numbers,) names
    weighted: (numbers,) residuals in standard deviations of the noise

    Columns instrument, numbers, rms and mean, both in those deviations: an rms of 2 says that the noise is
    twice what was given, a mean of 1 that a constant error as large as the noise is left.
    """
    rows = pd.DataFrame({"instrument": instruments, "weighted": weighted, "squared": weighted**2})
    by_name = rows.groupby("instrument", sort=False)
    found = by_name["weighted"].agg(numbers="size", mean="mean")
    found["rms"] = np.sqrt(by_name["squared"].mean())
    return found.reset_index()[["instrument", "numbers", "rms", "mean"]]


def shown(
    measured: Measurements,
    estimates: Sequence["Estimate"],
    residuals: Callable[[Sequence["Estimate"]], list[np.ndarray]],
) -> pd.DataFrame:
    """Return what residuals tell of each instrument, as `summary`, from all numbers that count.

    They are of the newest estimates that converged and have no track in common.

    residuals: of estimates, weighted
    """
    apart: list[Estimate] = []
    for one in reversed(estimates):
        if one.fit.converged and (not apart or one.window.last < apart[-1].window.first):
            apart.append(one)
    kept = [slice(None) if one.kept is None else one.kept for one in apart]
    numbers = [measured.instruments(one.window.rows)[use] for one, use in zip(apart, kept, strict=True)]
    left = [one[use] for one, use in zip(residuals(apart) if apart else [], kept, strict=True)]
    names = np.array(measured.instrument_names())
    return summary(names[np.concatenate([*numbers, []]).astype(int)], np.concatenate([*left, []]))
