"""The part of the prediction error that a model leaves.

Source: the paper, sections 'Validation of the Trained SVM Model' (P_ML) and 'Results on Simulated RSO'
(p_ML).
"""

import math

import numpy as np
import pandas as pd

from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.base.seeds import derive

DRAWS = 2000
PERCENTILES = (5.0, 95.0)
LONGEST = 0.5 * DAY


def p_ml(true: np.ndarray, predicted: np.ndarray) -> float:
    """Return the performance metric P_ML [%]: 100 sum |e - e_ML| / sum |e| over all points.

    0 is a perfect correction, 100 no correction. Raises InputError where there is no error to correct.
    """
    total = float(np.sum(np.abs(true)))
    if not (np.isfinite(total) and total > 0.0):
        raise InputError(f"P_ML: expected a positive, finite sum of true errors, got {total}")
    return 100.0 * float(np.sum(np.abs(true - predicted))) / total


def individual_p_ml(true: np.ndarray, predicted: np.ndarray) -> np.ndarray:
    """Return the individual metric p_ML [%] of each point: 100 |e - e_ML| / |e|.

    It is infinite where a zero error became larger, 0 where it stayed zero.
    """
    residual, error = np.abs(true - predicted), np.abs(true)
    ratio = np.divide(residual, error, out=np.where(residual > 0.0, np.inf, 0.0), where=error > 0.0)
    return 100.0 * ratio


def fraction_reduced(true: np.ndarray, predicted: np.ndarray) -> float:
    """Return the fraction (0 to 1) of the points whose error becomes smaller: p_ML below 100 %."""
    return float(np.mean(np.abs(true - predicted) < np.abs(true)))


def against_labels(evaluation: pd.DataFrame, labelled: pd.DataFrame, *, component: str) -> float:
    """Return P_ML [%] of the rows of an `evaluation` table, with labels from later estimates as true errors.

    labelled: the dataset with the labels; rows that it dropped do not count

    P_ML is NaN where the dataset holds true errors, or none of the rows.
    """
    if "t_known" not in labelled:
        return math.nan
    known = labelled.loc[labelled["keep"], ["i", "j", component]]
    rows = evaluation.merge(known, on=["i", "j"])
    return p_ml(rows[component].to_numpy(), rows["predicted"].to_numpy()) if len(rows) else math.nan


def bootstrap_interval(evaluation: pd.DataFrame, *, seed: int) -> tuple[float, float]:
    """Return 5th and 95th percentile of P_ML [%] over resampled estimates, for an `evaluation` table.

    Whole estimates are drawn with replacement, because the rows of an estimate are no independent evidence
    (cluster bootstrap; Davison & Hinkley 1997, Bootstrap Methods and their Application, sec. 3.8). Raises
    InputError where there is no error to correct.
    """
    p_ml(evaluation["true"].to_numpy(), evaluation["predicted"].to_numpy())
    sums = evaluation[["residual", "true"]].abs().groupby(evaluation["i"], sort=True).sum().to_numpy()
    count = len(sums)
    drawn = derive(seed, "bootstrap").integers(count, size=(DRAWS, count))
    times = np.stack([np.bincount(row, minlength=count) for row in drawn])
    residual, true = (np.einsum("dk,k->d", times, column) for column in sums.T)
    low, high = np.percentile(100.0 * residual / true, PERCENTILES)
    return float(low), float(high)


def longest_errors(evaluation: pd.DataFrame) -> tuple[float, float]:
    """Return mean absolute error and residual [m or m/s] of rows within LONGEST of the longest duration."""
    longest = evaluation[evaluation["duration"] >= evaluation["duration"].max() - LONGEST]
    return float(longest["true"].abs().mean()), float(longest["residual"].abs().mean())


def summary(
    evaluation: pd.DataFrame,
    *,
    seed_noise: int,
    seed_split: int,
    kernel_scale: float,
    p_ml_later: float = math.nan,
    **experiment: str,
) -> pd.DataFrame:
    """Return the one-row `metrics` table of an `evaluation` table.

    seed_split: of the draws of the bootstrap, too
    kernel_scale: of the model, NaN for one without
    p_ml_later: from `against_labels`
    experiment: its name, part by part
    """
    low, high = bootstrap_interval(evaluation, seed=seed_split)
    true, predicted = evaluation["true"].to_numpy(), evaluation["predicted"].to_numpy()
    before, after = longest_errors(evaluation)
    row = experiment | {
        "seed_noise": seed_noise,
        "seed_split": seed_split,
        "kernel_scale": kernel_scale,
        "rows": len(evaluation),
        "estimates": evaluation["i"].nunique(),
        "p_ml": p_ml(true, predicted),
        "p_ml_low": low,
        "p_ml_high": high,
        "fraction_reduced": fraction_reduced(true, predicted),
        "p_ml_later": p_ml_later,
        "last_before": before,
        "last_after": after,
    }
    return pd.DataFrame([row])
