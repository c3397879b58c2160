"""Sets of mean elements as measurements: the points that stand for each, and how much they count."""

import logging
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from opml.base.constants import DAY, HOUR
from opml.base.errors import InputError
from opml.base.section import JobSettings
from opml.interop.element_sets import agreement, sgp4_points, spans
from opml.interop.element_sets.sgp4_points import SetSampling
from opml.orbits.manoeuvres import Manoeuvre
from opml.tables import FIX_SIGMAS

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
    points: list[pd.DataFrame]  # of each set: t, state in GCRF, standard deviations in RSW


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
    worth = agreement.weighed(sets, epoch=epoch, sampling=usual, manoeuvres=manoeuvres)
    if taking.sigmas is not None:
        worth[FIX_SIGMAS[:3]] = np.tile(taking.sigmas, (len(worth), 1))
    ends = taking.ends(sets["t"].to_numpy())
    counting = worth["counts"].to_numpy(bool) & (sets["t"].to_numpy() >= 0.0) & (ends <= duration)
    reaches = np.full(len(sets), usual.reach)
    if taking.reach is None:
        reaches[worth["counts"]] = _over_spans(sets[worth["counts"]], epoch, manoeuvres)
    kept, points = [], []
    weighed = sets.assign(**{name: worth[name].to_numpy() for name in FIX_SIGMAS[:3]})
    made = np.where(counting, np.fmax(ends, sets["t_created"].to_numpy()), -np.inf)
    asked = counting & (ends >= min(taking.since, ends[counting].max(initial=-np.inf)))
    for k in np.flatnonzero(asked):
        sampling = SetSampling(float(reaches[k]), taking.step)
        one, end = weighed.iloc[k], float(ends[k])
        found = _points(one, sampling, epoch=epoch, end=end, manoeuvres=manoeuvres)
        if found is not None:
            kept.append(k)
            points.append(found)
    if not kept:
        raise InputError(f"element sets: expected a set within the run that counts, got {len(sets)} others")
    _log.info("sets that count as measurements: %d", len(kept))
    return MeasuredSets(ends[kept], np.maximum.accumulate(made)[kept], points)


def _over_spans(sets: pd.DataFrame, epoch: str, manoeuvres: Sequence[Manoeuvre]) -> np.ndarray:
    """Return how far points of sets (n,) reach back [s]: over what was fitted where sets show it."""
    lengths = spans.fit_spans(sets, epoch=epoch, manoeuvres=manoeuvres)
    is_known = np.isfinite(lengths)
    if is_known.any():
        hours = lengths[is_known][-1] / HOUR
        _log.info("sets part as fits to %.0f hours each do: their points go back as far", hours)
    return np.where(is_known, lengths, USUAL_REACH)


def _points(
    one: pd.Series, sampling: SetSampling, *, epoch: str, end: float, manoeuvres: Sequence[Manoeuvre]
) -> pd.DataFrame | None:
    """Return the points of a set in the run and behind the last manoeuvre before it; None if they are few."""
    points = sgp4_points.before(one, end, epoch=epoch, sampling=sampling)
    if len(points) < len(sampling.times(end)):
        _log.warning("%s has points no farther back than SGP4 goes", agreement.place(one, epoch))
    begin = max([0.0, *(burn.t for burn in manoeuvres if burn.counts_from <= end)])
    rows = points[points["t"] >= begin]
    if len(rows) < _LEAST * min(sampling.reach, USUAL_REACH) / sampling.step:
        return None
    sigmas = one[FIX_SIGMAS[:3]].to_numpy(float) * np.sqrt(3 * len(points) / _NUMBERS)
    return rows.assign(**dict(zip(FIX_SIGMAS, [*sigmas, *[np.nan] * 3], strict=True)))
