"""Sets of mean elements as measurements: the points that stand for each, and how much they count."""

import logging
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from opml.base.constants import DAY, HOUR
from opml.base.errors import InputError
from opml.base.section import JobSettings
from opml.interop.element_sets import accuracy, fit_spans, histories, mean_elements
from opml.interop.element_sets.accuracy import SetSampling
from opml.orbits.manoeuvres import Manoeuvre
from opml.tables import FIX_SIGMAS, STATE

USUAL_REACH = DAY  # time before the epoch of a set over which its points lie where its span is unknown [s]
PAST = 60.0 * DAY  # sets so long before a run show how accurate its first ones are [s]
_NUMBERS = 6  # what a set shows about an orbit, however many points it gives

_LEAST = 0.5
"""Part of a set's points, of a day at most, that lie within the run and after a manoeuvre, at least."""

_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Taking:
    """How sets are taken for measurements.

    reach: from the first of them to its epoch [s]; None: as long as it was fitted to, where the sets up to it
        tell
    sigmas: (3,) standard deviations of a set in RSW [m]; None: learned from the sets before it
    raster: points of sets end at its multiples, the next one behind each epoch [s]; None: at the epochs
    since: earlier sets tell how accurate later ones are, but have no points, unless all are earlier [s]
    """

    step: float  # between the points that stand for a set [s]
    reach: float | None = None
    sigmas: Sequence[float] | None = None
    raster: float | None = None
    since: float = -np.inf

    def ends(self, epochs: np.ndarray) -> np.ndarray:
        """Return when points of sets end [s]: each at a multiple of its own, whatever sets follow."""
        if self.raster is None:
            return epochs
        number = np.arange(len(epochs))
        multiples = np.maximum.accumulate(np.ceil(epochs / self.raster) - number) + number
        return self.raster * multiples


class HistoryTaking(JobSettings):
    """How a job takes the history of an object's mean elements: the settings `histories`."""

    number: int | None = None
    leave_out_damaged: bool = False
    find_manoeuvres: bool = False
    every_s: float
    reach_hours: float | None = None
    sigma_m: tuple[float, float, float] | None = None

    @property
    def of_sets(self) -> Taking:
        """How its sets are taken."""
        return Taking(self.every_s, HOUR * self.reach_hours if self.reach_hours else None, self.sigma_m)


@dataclass(frozen=True)
class MeasuredSets:
    """The sets of a run that count, in ascending order."""

    epochs: np.ndarray  # (sets,) of their last points [s]
    known: np.ndarray  # (sets,) when they and all before them were made, their epochs at the earliest [s]
    points: pd.DataFrame  # track, the number of the set among these; t, state in GCRF, sigmas in RSW


def of_run(sets: pd.DataFrame, duration: float) -> pd.DataFrame:
    """Return the sets that count for a run of a duration [s]: its own, and those that show their accuracy."""
    return sets[(sets["t"] >= -PAST) & (sets["t"] <= duration)].reset_index(drop=True)


def measured(
    sets: pd.DataFrame,
    taking: Taking,
    *,
    epoch: str,
    duration: float,
    manoeuvres: Sequence[Manoeuvre] = (),
) -> MeasuredSets:
    """Return what the sets of one object measured within a run.

    sets: table `element_sets` of one object
    duration: of the run [s]
    manoeuvres: no points of a set lie before one that was before its epoch, and known by then

    Raises InputError where no set is left.
    """
    sets = of_run(sets, duration)
    usual = SetSampling(taking.reach or USUAL_REACH, taking.step)
    worth = accuracy.weighed(sets, epoch=epoch, sampling=usual, manoeuvres=manoeuvres)
    sigmas = worth[FIX_SIGMAS[:3]].to_numpy()
    if taking.sigmas is not None:
        sigmas = np.tile(taking.sigmas, (len(worth), 1))
    ends = taking.ends(sets["t"].to_numpy())
    counting = worth["counts"].to_numpy(bool) & (sets["t"].to_numpy() >= 0.0) & (ends <= duration)
    reaches = np.full(len(sets), usual.reach)
    if taking.reach is None:
        reaches[worth["counts"]] = _over_spans(sets[worth["counts"]], epoch, manoeuvres)
    made = np.where(counting, np.fmax(ends, sets["t_created"].to_numpy()), -np.inf)
    asked = np.flatnonzero(counting & (ends >= min(taking.since, ends[counting].max(initial=-np.inf))))
    begins = [max([0.0, *(burn.t for burn in manoeuvres if burn.counts_from <= end)]) for end in ends[asked]]
    kept: list[int] = []
    points = []
    for k, begin, (t, states) in zip(
        asked.tolist(),
        begins,
        _paths(sets.iloc[asked], ends[asked], reaches[asked], taking.step, epoch),
        strict=True,
    ):
        if np.isnan(states[:, 0]).any():
            _log.warning("%s has points no farther back than SGP4 goes", accuracy.place(sets.iloc[k], epoch))
        rows = _points(t, states, sigmas[k], begin=begin)
        if len(rows) >= _LEAST * min(reaches[k], USUAL_REACH) / taking.step:
            points.append(np.insert(rows, 0, len(kept), axis=1))
            kept.append(k)
    if not kept:
        raise InputError(f"element sets: expected a set within the run that counts, got {len(sets)} others")
    _log.info("sets that count as measurements: %d", len(kept))
    table = pd.DataFrame(np.concatenate(points), columns=["track", "t", *STATE, *FIX_SIGMAS[:3]])
    return MeasuredSets(ends[kept], np.maximum.accumulate(made)[kept], table.astype({"track": np.int64}))


def _paths(
    sets: pd.DataFrame, ends: np.ndarray, reaches: np.ndarray, step: float, epoch: str
) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Yield times (n,) and states (n, 6) of the points of each set up to its end, NaN where SGP4 fails."""
    times = [SetSampling(reach, step).times(end) for reach, end in zip(reaches, ends, strict=True)]
    if times:
        states = mean_elements.states_of_each(histories.satellites(sets, epoch=epoch), epoch=epoch, t=times)
        yield from zip(times, np.split(states, np.cumsum([len(t) for t in times])[:-1]), strict=True)


def _over_spans(sets: pd.DataFrame, epoch: str, manoeuvres: Sequence[Manoeuvre]) -> np.ndarray:
    """Return how far points of sets (n,) reach back [s]: over what was fitted where sets show it."""
    lengths = fit_spans.fit_spans(sets, epoch=epoch, manoeuvres=manoeuvres)
    is_known = np.isfinite(lengths)
    if is_known.any():
        hours = lengths[is_known][-1] / HOUR
        _log.info("sets part as fits to %.0f hours each do: their points go back as far", hours)
    return np.where(is_known, lengths, USUAL_REACH)


def _points(t: np.ndarray, states: np.ndarray, sigmas: np.ndarray, *, begin: float) -> np.ndarray:
    """Return points of a set as rows (n, 10) of t, states, and sigmas that count as much as the set does.

    t, states: (points,) and (points, 6) of all, NaN where SGP4 does not go so far back
    sigmas: (3,) of the set
    begin: since when points count [s]
    """
    reached = np.flatnonzero(np.isnan(states[:, 0])).max(initial=-1) + 1
    each = np.tile(sigmas * np.sqrt(3 * (len(t) - reached) / _NUMBERS), (len(t), 1))
    return np.column_stack([t, states, each])[reached:][t[reached:] >= begin]
