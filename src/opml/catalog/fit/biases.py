"""Constant errors of instruments: how fits bear them, and what residuals show of them and of the noise.

An instrument is one observable of a station. Its constant error b within a window has a standard deviation of
s beforehand, in those of its noise. To estimate all b besides the orbit, or to let them correlate the noise,
comes to the same: the weights of the n numbers of an instrument are (I + s^2 11')^-1, whose root takes from
residuals and derivatives a part of their mean, 1 - 1 / sqrt(1 + n s^2).
Source: Tapley, Schutz & Born 2004, Statistical Orbit Determination, sec. 6.2 (consider parameters); Sherman &
Morrison 1950, Annals of Mathematical Statistics 21, 124-127.
"""

import logging
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pandas as pd

from opml.base.files import FilePath
from opml.catalog.fit.estimate import Estimate
from opml.catalog.fit.least_squares import Evaluation
from opml.catalog.fit.measurements import Measurements
from opml.tables import read_metadata

_KEY = "instruments"
_COLUMNS = ["instrument", "numbers", "sigma", "rms", "mean"]
_log = logging.getLogger(__name__)


def whiten(evaluation: Evaluation, instruments: np.ndarray, sigma: float) -> Evaluation:
    """Return an evaluation whose residuals do not correlate, where each instrument has a constant error.

    instruments: (numbers,) of each residual, from 0 on
    sigma: standard deviation of a constant error, in those of the noise
    """
    columns = np.column_stack([evaluation.residuals, evaluation.jacobian])
    count = np.bincount(instruments)
    sums = np.stack([np.bincount(instruments, column) for column in columns.T], axis=-1)
    # The covariance of n residuals of an instrument is I + sigma^2 11^T. Its inverse root takes from each of
    # them the same part of their sum: along 1 it scales by 1 / sqrt(1 + n sigma^2), across it by 1.
    part = (1.0 - 1.0 / np.sqrt(1.0 + count * sigma**2)) / np.maximum(count, 1)
    columns -= (part[:, None] * sums)[instruments]
    return Evaluation(columns[:, 0], columns[:, 1:])


def summary(instruments: np.ndarray, weighted: np.ndarray, sigmas: np.ndarray) -> pd.DataFrame:
    """Return what residuals show about the instruments that they are of, one a row.

    instruments: (numbers,) names
    weighted: (numbers,) residuals in standard deviations of the noise
    sigmas: (numbers,) these deviations [rad, m, m/s]

    Columns instrument, numbers; sigma, the root mean square of its deviations [rad, m, m/s]; rms and mean of
    the residuals in them: an rms of 2 says that the noise is twice what was given, a mean of 1 that a
    constant error as large as the noise is left.
    """
    squares = {"sigma": sigmas**2, "rms": weighted**2}
    rows = pd.DataFrame({"instrument": instruments, "mean": weighted, **squares})
    by_name = rows.groupby("instrument", sort=False)
    summary = by_name["mean"].agg(numbers="size", mean="mean")
    summary[list(squares)] = np.sqrt(by_name[list(squares)].mean())
    return summary.reset_index()[_COLUMNS]


def instrument_residuals(
    measured: Measurements,
    estimates: Sequence[Estimate],
    residuals: Callable[[Sequence[Estimate]], list[np.ndarray]],
) -> pd.DataFrame:
    """Return what residuals show about each instrument, as `summary`, from all numbers that count; log it.

    They are of the newest estimates that converged and have no track in common.

    residuals: of estimates, weighted
    """
    disjoint: list[Estimate] = []
    for one in reversed(estimates):
        if one.fit.converged and (not disjoint or one.window.last < disjoint[-1].window.first):
            disjoint.append(one)
    kept = [slice(None) if one.kept is None else one.kept for one in disjoint]
    counting = [(one.window.rows, use) for one, use in zip(disjoint, kept, strict=True)]
    numbers = [measured.instruments(rows)[use] for rows, use in counting]
    sigmas = [measured.deviations(rows)[use] for rows, use in counting]
    left = [one[use] for one, use in zip(residuals(disjoint) if disjoint else [], kept, strict=True)]
    names = np.array(measured.instrument_names())[np.concatenate([*numbers, []]).astype(int)]
    table = summary(names, np.concatenate([*left, []]), np.concatenate([*sigmas, []]))
    shares = table[["instrument", "numbers", "rms", "mean"]].round(2)
    _log.info("residuals in sigmas of the noise:\n%s", shares.to_string(index=False))
    return table


def facts(noise: pd.DataFrame) -> dict[str, Any]:
    """Return what `instrument_residuals` found as a table's metadata hold it."""
    return {_KEY: noise.to_dict("records")}


def read_noise(path: FilePath) -> pd.DataFrame:
    """Read what a table's metadata hold of instruments, an empty table where they hold nothing.

    Raises InputError as `read_metadata` does.
    """
    return pd.DataFrame(read_metadata(path).get(_KEY, []), columns=_COLUMNS)
