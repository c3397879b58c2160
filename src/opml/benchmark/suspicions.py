"""Signs that answers are wrong: cut short, at other times, in another frame, of other objects.

Each check yields a sentence, or none.
"""

from collections.abc import Iterator

import erfa
import numpy as np
import pandas as pd

from opml.base import epochs
from opml.benchmark import tasks
from opml.benchmark.answers import Answers
from opml.benchmark.tasks import BenchmarkTask
from opml.interop.element_sets.teme import teme_to_gcrf

_LEAST_SHIFT = 0.5  # [s] along the track
_ALIKE = 0.15  # of a shift: how far half of the answers may be from it
_BETTER = 0.1  # what another frame leaves of the distances
_FAR = 1e6  # distance [m] of answers that are of other objects


def sentences(task: BenchmarkTask, answers: Answers, errors: pd.DataFrame, truth: np.ndarray) -> list[str]:
    """Return the suspicions, a sentence each.

    errors: of `scores.errors`
    truth: GCRF states (questions, 6) [m, m/s]
    """
    suspicions = [*_missing(task, answers)]
    if stray := answers.stray:
        suspicions.append(f"times: {len(stray)} answers are to no question; {stray[0]}")
    if answers.is_answered.any():
        suspicions += [*_frame(task, answers, truth)] or [*_of_others(answers, truth)]
        suspicions += _shifted(errors, truth[answers.is_answered])
    return suspicions


def _missing(task: BenchmarkTask, answers: Answers) -> Iterator[str]:
    missing = task.questions[~answers.is_answered]
    if len(missing):
        leads = ", ".join(f"{lead} d: {count}" for lead, count in missing.groupby("lead").size().items())
        first = missing.iloc[0]
        yield (
            f"truncated: {len(missing)} of {len(task.questions)} questions have no answer ({leads}), "
            f"the first is object {first['object']} at {first['time']}"
        )


def _frame(task: BenchmarkTask, answers: Answers, truth: np.ndarray) -> Iterator[str]:
    """Tell of states that are far nearer to the truth when they are read in another frame."""
    known = answers.is_answered
    time = tasks.seconds(task.questions["time"][known].tolist(), task.folder)
    of_date = teme_to_gcrf(tasks.EPOCH, time)
    turns = {
        "TEME states are called GCRF": of_date,
        "GCRF states are called TEME": of_date.transpose(0, 2, 1),
        "Earth-fixed states are called GCRF": of_date @ _from_earth(time),
        "Earth-fixed states are called TEME": of_date @ _from_earth(time) @ of_date.transpose(0, 2, 1),
    }
    states, true = answers.states[known, :3], truth[known, :3]
    stated = np.median(np.linalg.norm(states - true, axis=1))
    for name, turn in turns.items():
        read = np.median(np.linalg.norm(np.einsum("nij,nj->ni", turn, states) - true, axis=1))
        if read < _BETTER * stated:
            yield (
                f"frame: it seems that {name}: they are {stated / 1e3:.3g} km from the truth as stated and "
                f"{read / 1e3:.3g} km as read so"
            )


def _from_earth(time: np.ndarray) -> np.ndarray:
    """Return the rotations (n, 3, 3) from the turning Earth to TEME at times [s since EPOCH]."""
    angle = erfa.gmst82(*epochs.utc(tasks.EPOCH, time))
    return np.asarray(erfa.rz(-angle, np.eye(3)))


def _of_others(answers: Answers, truth: np.ndarray) -> Iterator[str]:
    """Tell of positions that are not those of the objects."""
    difference = answers.states[answers.is_answered, :3] - truth[answers.is_answered, :3]
    far = float(np.median(np.linalg.norm(difference, axis=1)))
    if far > _FAR:
        yield f"object: answers are {far / 1e3:.0f} km from the truth: are they of other objects?"


def _shifted(errors: pd.DataFrame, truth: np.ndarray) -> Iterator[str]:
    """Tell of states that are ahead of the truth or behind by one time."""
    shift = errors["s"].to_numpy() / np.linalg.norm(truth[:, 3:], axis=1)
    middle = float(np.median(shift))
    is_alike = np.median(np.abs(shift - middle)) < _ALIKE * abs(middle)
    if abs(middle) > _LEAST_SHIFT and is_alike:
        where = "ahead of" if middle > 0.0 else "behind"
        yield (
            f"time: states are {abs(middle):.4g} s {where} their times, nearly all the same: is another "
            "time system than UTC meant (TAI is 37 s, TT 69 s, GPS 18 s ahead since 2017)?"
        )
