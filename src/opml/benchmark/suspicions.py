"""Signs that answers are wrong: cut short, at other times, in another frame, from the truth.

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

_COPIED = 0.01  # distance from the truth [m] that no prediction has: sets alone err by tens of metres
_LEAST_SHIFT = 0.5  # [s] along the track
_ALIKE = 0.15  # of a shift: how far half of the answers may be from it
_BETTER = 0.1  # what another frame leaves of the distances
_FAR = 1e6  # distance [m] of answers that are of other objects
_FAST = 1500.0  # difference of velocities [m/s] that no error below _FAR makes
_GROWS = 1.2  # times the error of the shortest lead, as errors at the longest are at least
_MANY = 100  # answers to a lead, of which a tenth may say something


def sentences(task: BenchmarkTask, answers: Answers, errors: pd.DataFrame, truth: np.ndarray) -> list[str]:
    """Return the suspicions, a sentence each.

    errors: of `scores.errors`
    truth: GCRF states (questions, 6) [m, m/s]
    """
    suspicions = [*_missing(task, answers), *_stray(answers), *_later_inputs(task, answers)]
    if answers.is_answered.any():
        frame = [*_frame(task, answers, truth)]
        suspicions += [*_copied(answers, truth), *frame]
        suspicions += [*_of_others(answers, truth)] if not frame else []
        shifted = [*_shifted(errors, truth[answers.is_answered])]
        suspicions += shifted or [*_without_growth(errors)]
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


def _stray(answers: Answers) -> Iterator[str]:
    if answers.stray:
        yield f"times: {len(answers.stray)} answers are to no question; {answers.stray[0]}"


def _later_inputs(task: BenchmarkTask, answers: Answers) -> Iterator[str]:
    t = tasks.seconds(task.questions["t"].tolist(), task.folder)
    later = answers.known > t
    if later.any():
        first = task.questions[later].iloc[0]
        yield (
            f"peeking: {later.sum()} answers depend on inputs known after t, the first for object "
            f"{first['object']} at t = {first['t']}"
        )


def _copied(answers: Answers, truth: np.ndarray) -> Iterator[str]:
    distance = np.linalg.norm(answers.states[:, :3] - truth[:, :3], axis=1)
    copied = distance[answers.is_answered] < _COPIED
    if copied.any():
        yield f"peeking: {copied.sum()} answers are within {_COPIED:g} m of the truth, as no prediction is"


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
    """Tell of positions, or of velocities alone, that are not those of the objects."""
    difference = answers.states[answers.is_answered] - truth[answers.is_answered]
    far, fast = (float(np.median(np.linalg.norm(part, axis=1))) for part in np.split(difference, 2, axis=1))
    if far > _FAR:
        yield f"object: answers are {far / 1e3:.0f} km from the truth: are they of other objects?"
    elif fast > _FAST:
        yield (
            f"velocities: they are {fast:.0f} m/s off where positions are {far / 1e3:.3g} km off: "
            "they are not those of the orbits, and turn covariances"
        )


def _shifted(errors: pd.DataFrame, truth: np.ndarray) -> Iterator[str]:
    """Tell of states that all, or all of the shortest lead, are ahead of the truth or behind by one time."""
    shift = errors["s"].to_numpy() / np.linalg.norm(truth[:, 3:], axis=1)
    lead = errors["lead"].to_numpy()
    for part in (lead >= 0, lead == lead.min()):
        middle = float(np.median(shift[part]))
        is_alike = np.median(np.abs(shift[part] - middle)) < _ALIKE * abs(middle)
        if abs(middle) > _LEAST_SHIFT and is_alike and part.sum() >= min(_MANY, len(lead)):
            where = "ahead of" if middle > 0.0 else "behind"
            yield (
                f"time: states are {abs(middle):.4g} s {where} their times, nearly all the same: is another "
                "time system than UTC meant (TAI is 37 s, TT 69 s, GPS 18 s ahead since 2017)?"
            )
            return


def _without_growth(errors: pd.DataFrame) -> Iterator[str]:
    """Tell of errors along the track that do not grow with the lead: all, or of many the best tenth."""
    by_lead = errors["s"].abs().groupby(errors["lead"])
    for name, level, least in (("median", 0.5, 1), ("best tenth's largest", 0.1, _MANY)):
        sizes = by_lead.quantile(level)
        first, last = sizes.iloc[0], sizes.iloc[-1]
        if len(sizes) > 1 and last < _GROWS * first and by_lead.size().min() >= least:
            yield (
                f"peeking: the {name} error along the track is {last:.0f} m at {sizes.index[-1]} d and "
                f"{first:.0f} m at {sizes.index[0]} d: so it looks where inputs after t were used"
            )
            return
