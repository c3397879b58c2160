"""Scores of answers to a task: errors in RSW of the truth, proper scores, coverage, by blocks.

Log score and CRPS are those of normal distributions, axis by axis; smaller is better. Source: Gneiting &
Raftery 2007, Strictly proper scoring rules, prediction, and estimation, J. Am. Stat. Assoc. 102.

Predictions of one week share its weather, and those of one object its drag. Intervals of 95 % therefore come
from drawing whole weeks and whole objects, each with replacement and independently; a prediction counts as
often as its week and its object were drawn together (Owen 2007, 'The pigeonhole bootstrap').
"""

from collections.abc import Iterator

import numpy as np
import pandas as pd
from scipy.special import ndtr

from opml.base import epochs
from opml.base.constants import WGS84_A
from opml.base.seeds import derive
from opml.benchmark.answers import Answers
from opml.benchmark.tasks import SIGMAS, STATE, BenchmarkTask
from opml.element_sets import corrector
from opml.orbits.elements import bent_rsw
from opml.orbits.rsw_covariance import half_width

AXES = {"s": "along_track", "r": "radial", "w": "cross_track"}
"""Names of the axes, in the order in which they are printed."""

LEVEL = corrector.LEVEL  # share of the errors that intervals are to hold
STORM = 30  # daily Ap from which a day is a storm, NOAA's minor one
DRAWS = 400  # draws of weeks and objects

_SEED = 1
_WEEK = 7
_INTERVAL = (2.5, 97.5)


def errors(task: BenchmarkTask, answers: Answers, truth: pd.DataFrame) -> pd.DataFrame:
    """Return the errors of what was answered: number, morning (modified Julian day), lead [d], height,
    r, s, w and sigma_r, sigma_s, sigma_w [m], NaN without a covariance; the truth's are part of them.

    truth: of `tasks.read_truth`
    """
    answered = answers.is_answered
    questions, true = task.questions[answered], truth[[*STATE]].to_numpy()[answered]
    bent = bent_rsw(answers.states[answered, :3], true)
    variances = np.diagonal(answers.covariances[answered], axis1=1, axis2=2)
    sigmas = np.sqrt(variances + truth[[*SIGMAS]].fillna(0.0).to_numpy()[answered] ** 2)
    mornings = {t: epochs.mjd(t) for t in questions["t"].unique()}
    table = pd.DataFrame(
        {"number": questions["object"], "morning": questions["t"].map(mornings), "lead": questions["lead"]}
    )
    table["height"] = np.linalg.norm(true[:, :3], axis=1) - WGS84_A
    for k, axis in enumerate("rsw"):
        table[axis], table[f"sigma_{axis}"] = bent[:, k], sigmas[:, k]
    return table


def crps(error: np.ndarray, sigma: np.ndarray) -> np.ndarray:
    """Return the CRPS (n,) [m] of normal distributions: of errors of their means, and deviations [m]."""
    z = error / sigma
    density = np.exp(-0.5 * z**2) / np.sqrt(2.0 * np.pi)
    return np.asarray(sigma * (z * (2.0 * ndtr(z) - 1.0) + 2.0 * density - 1.0 / np.sqrt(np.pi)))


def log_score(error: pd.Series, sigma: pd.Series) -> float:
    """Return the mean negative logarithm of the density [1/m] of normal distributions at the truth.

    Burns count whole: an answer says how sure it is of what it cannot know.
    """
    return float((np.log(sigma) + 0.5 * (error / sigma) ** 2).mean()) + 0.5 * float(np.log(2.0 * np.pi))


def scores(task: BenchmarkTask, table: pd.DataFrame) -> pd.DataFrame:
    """Return a row for each lead: questions, answered [%], and by axis median, p95 and crps [m], log_score,
    inside [%] of intervals of LEVEL, each of the last with its interval for the median along the track and
    what is inside there, `_low` and `_high`.

    table: of `errors`
    """
    rows = []
    for lead, questions in task.questions.groupby("lead").size().items():
        part = table[table["lead"] == lead]
        row = {"lead": lead, "questions": questions, "answered": 100.0 * len(part) / questions}
        for axis, name in AXES.items():
            row |= {f"{name}_{key}": value for key, value in _of_axis(part, axis).items()}
        rows.append(row | _intervals(part, int(str(lead))))
    return pd.DataFrame(rows)


def by_weather(table: pd.DataFrame) -> pd.DataFrame:
    """Return what `_of_axis` has along the track by lead and weeks, quiet, stormy, or other: of unknown
    weather; nothing where all are.

    table: of `errors`, with highest_ap of the week after the morning
    """
    highest = table["highest_ap"].to_numpy(float)
    weeks = np.select([highest >= STORM, highest < STORM], ["stormy", "quiet"], "other")
    known = table if np.isfinite(highest).any() else table[:0]
    rows = [
        {"weeks": of, "lead": lead, "answers": len(part), **_of_axis(part, "s")}
        for (of, lead), part in known.groupby([weeks[: len(known)], known["lead"].to_numpy()])
    ]
    return pd.DataFrame(rows, columns=None if rows else ["weeks", "lead", "answers", "median"])


def _of_axis(part: pd.DataFrame, axis: str) -> dict[str, float]:
    error = part[axis].to_numpy()
    if not len(error):
        return dict.fromkeys(("median", "p95", "crps", "log_score", "inside"), np.nan)
    statistics = {"median": np.median(np.abs(error)), "p95": np.percentile(np.abs(error), 95.0)}
    sure = part[np.isfinite(part[f"sigma_{axis}"])]
    error, sigma = sure[axis].to_numpy(), sure[f"sigma_{axis}"].to_numpy()
    if not len(sure):
        return statistics | dict.fromkeys(("crps", "log_score", "inside"), np.nan)
    return statistics | {
        "crps": crps(error, sigma).mean(),
        "log_score": log_score(sure[axis], sure[f"sigma_{axis}"]),
        "inside": 100.0 * _inside(error, sigma).mean(),
    }


def _inside(error: np.ndarray, sigma: np.ndarray) -> np.ndarray:
    return np.asarray(np.abs(error) <= half_width(LEVEL) * sigma)


def _intervals(part: pd.DataFrame, lead: int) -> dict[str, float]:
    """Return the intervals of the median along the track [m], and of what is inside there [%]."""
    names = ("along_track_median", "along_track_inside")
    draws = np.array(list(_draws(part, lead))).reshape(-1, len(names))
    known = [column[np.isfinite(column)] for column in draws.T]
    bounds = [np.percentile(values, _INTERVAL) if len(values) else (np.nan, np.nan) for values in known]
    return {
        f"{name}_{end}": float(bounds[n][k])
        for n, name in enumerate(names)
        for k, end in enumerate(("low", "high"))
    }


def _draws(part: pd.DataFrame, lead: int) -> Iterator[tuple[float, float]]:
    """Yield the median and the share inside [%] of draws of weeks and objects."""
    if part.empty:
        return
    size = part["s"].abs().to_numpy()
    order = np.argsort(size, kind="stable")
    sure = np.isfinite(part["sigma_s"]).to_numpy()
    inside = sure & _inside(part["s"].to_numpy(), part["sigma_s"].to_numpy())
    for weights in drawn_weights(part, derive(_SEED, "weeks and objects", str(lead))):
        median, counted = weighted_median(size[order], weights[order]), weights @ sure
        yield median, 100.0 * (weights @ inside) / counted if counted else np.nan


def drawn_weights(part: pd.DataFrame, rng: np.random.Generator) -> Iterator[np.ndarray]:
    """Yield how often each row (n,) counts in draws of weeks and objects; one without any is passed over.

    part: with columns number and morning (modified Julian day)
    """
    places = [np.unique(of, return_inverse=True)[1] for of in (weeks_of(part), part["number"].to_numpy())]
    drawn = 0
    while drawn < DRAWS:
        weights = np.prod([_times_drawn(place, rng) for place in places], axis=0)
        if weights.any():
            drawn += 1
            yield weights


def weeks_of(table: pd.DataFrame) -> np.ndarray:
    """Return the number of the week (n,) of each morning."""
    return np.asarray(np.floor(table["morning"].to_numpy() / _WEEK).astype(int))


def _times_drawn(place: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Return how often the member of each row (n,) is drawn, of as many draws as there are members."""
    count = int(place.max()) + 1
    return np.asarray(np.bincount(rng.integers(count, size=count), minlength=count)[place])


def weighted_median(ascending: np.ndarray, weights: np.ndarray) -> float:
    """Return the median of values that count by whole weights; the lower one of two in the middle."""
    totals = np.cumsum(weights)
    return float(ascending[np.searchsorted(totals, 0.5 * totals[-1])])
