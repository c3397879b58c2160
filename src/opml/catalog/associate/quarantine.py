"""Tracks that the orbit does not explain: of another object, or after a burn. They are held back from fits.

Each track is compared with where the newest estimate predicts it, and with where one does that is a window
older, which sees what newer fits went along with. One that is far, by the object's own scale, and that no
fit over the window takes in with about the drag of before, is held back:

* a later track is where it was predicted -> those held back were of another object, and take part in no fit;
* tracks held back lie on one orbit, which meets the old one -> a burn, and fits restart after it;
* nothing explains them for longer than a window -> they count again, as forces err more than was known.

What happens at a track follows from the tracks up to it alone.
"""

import logging
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd

from opml.base.constants import HOUR
from opml.catalog.associate.burns import TrackedBurn, burn_between
from opml.catalog.associate.innovations import CD_SPREAD, ReferenceOrbit, farthest, usual_scale
from opml.catalog.fit import biases, estimation
from opml.catalog.fit.apriori import CD
from opml.catalog.fit.estimate import Estimate
from opml.catalog.fit.estimation import Run
from opml.catalog.fit.estimation_settings import Estimation
from opml.catalog.fit.least_squares import Fit, Method
from opml.catalog.fit.measurements import Measurements
from opml.catalog.fit.starts import StartParameters
from opml.catalog.propagator import Propagator
from opml.tables import BURN

HELD_BACK = "track of no known orbit"  # why there is no estimate at a track that is held back
AGREEING = 2  # tracks on one orbit that make a burn, where that orbit meets the old one
MANY = 4  # tracks on one orbit that make a burn, or several, even where the orbits do not meet

_WORST = 5.0
"""Largest median residual of a track that a fit takes in, in units of the typical one."""

_LATELY = 50  # newest fits, whose residuals are what is usual

_DRAG = 0.5
"""Change of Cd, as a part of it, beyond which a fit that takes a far track in does so by a burn's work."""

_MEDIAN = 1.2533  # standard deviation of the median of many normal deviates, in that of their mean

_log = logging.getLogger(__name__)


class Watch:
    """Tracks of a run in turn, what is held back of them, and the burns between them.

    foreign: tracks of other objects
    burns: those found so far, each with the first track behind it
    """

    def __init__(self, run: Run, method: Method) -> None:
        self.foreign: set[int] = set()
        self.burns: list[tuple[int, TrackedBurn]] = []
        self._run, self._method = run, method
        self._limit = run.settings.suspect_sigma or np.inf
        self._waiting: list[int] = []
        self._before: list[ReferenceOrbit] = []
        self._known: list[ReferenceOrbit] = []
        self._usable: StartParameters | None = None
        self._spare: StartParameters | None = None
        self._past: tuple[list[float], list[float]] = [], []  # innovations of the object's own tracks
        self._sizes: list[float] = []

    def take(self, track: int) -> tuple[Estimate, TrackedBurn | None]:
        """Return the estimate at the next track, and the burn that it shows."""
        if not self._waiting:
            self._before = self._predictors(track)
        away = [farthest(self._run, one, track) for one in self._before]
        if not self._are_far(away):
            self._refuse(self._waiting)
            return self._accepted(self._fitted(track), away), None
        across = self._fitted(track)
        if self._goes_across(across) or self._waits_too_long(track):
            self._waiting = []
            return self._accepted(across, away), None
        _log.info("track %d at %.0f s is held back: %.0f sigma off", track, self._time(track), max(away))
        self._waiting.append(track)
        burn = self._burn(away)
        if burn is None:
            return self._held_back(track), None
        return self._accepted(self._fitted(track), []), burn

    def excluded(self, track: int) -> set[int]:
        """Return the tracks that no fit around a track takes: foreign ones, and those beyond a burn."""
        firsts = [0, *(first for first, _ in self.burns), self._run.measured.tracks]
        since = int(np.searchsorted(firsts, track, side="right")) - 1
        beyond = range(firsts[since]), range(firsts[since + 1], firsts[-1])
        return self.foreign.union(*beyond)

    def row(self, estimate: Estimate, burn: TrackedBurn | None) -> dict[str, Any]:
        """Return an estimate as a row of the table, with how many tracks its window does without."""
        track = estimate.window.track
        is_held_back = track in self.foreign.union(self._waiting)
        without = 0 if is_held_back else self._run.window(track).tracks - estimate.window.tracks
        shown = [np.nan] * 4 if burn is None else [burn.t, *burn.velocity]
        marks = {"held_back": is_held_back, "tracks_left_out": without}
        return self._run.row(estimate) | marks | dict(zip(BURN, shown, strict=True))

    def _time(self, track: int) -> float:
        return float(self._run.measured.epochs[self._run.measured.at[track]])

    def _predictors(self, track: int) -> list[ReferenceOrbit]:
        """Return the orbits that predict a track: the newest, and the newest that is a window older."""
        epochs, oldest = self._run.measured.epochs, self._time(track) - self._run.settings.window_hours * HOUR
        older = [one for one in self._known if epochs[one.at] <= oldest]
        self._known = older[-1:] + self._known[len(older) :]
        return [*self._known[-1:], *older[-1:]]

    def _are_far(self, away: Sequence[float]) -> bool:
        scales = map(usual_scale, self._past)
        return any(one > self._limit * scale for one, scale in zip(away, scales, strict=False))

    def _fitted(self, track: int) -> Estimate:
        """Return the fit over the window at a track, to what is neither foreign nor beyond a burn."""
        window = self._run.window(track, without=self.excluded(track))
        run = self._run_since_burn(track)
        starts = run.candidates([window], self._usable, self._spare)
        [estimate] = run.fit_windows([window], starts, [self._method])
        return estimate

    def _run_since_burn(self, track: int) -> Run:
        """Return the run, which takes Cd for known while a burn cuts the window: it does not change it."""
        run = self._run
        if not self.burns or self._time(track) - self.burns[-1][1].t > run.settings.window_hours * HOUR:
            return run
        propagator = replace(run.propagator, rso=replace(run.propagator.rso, cd=self._cd))
        settings = run.settings.evolve(cd_sigma=CD_SPREAD * abs(self._cd))
        return replace(run, propagator=propagator, settings=settings)

    def _accepted(self, estimate: Estimate, away: Sequence[float]) -> Estimate:
        """Return an estimate that later tracks are compared with."""
        for past, largest in zip(self._past, away, strict=False):
            if np.isfinite(largest):
                past.append(largest)
        if estimate.fit.converged:
            self._sizes.append(float(self._run.row(estimate)["weighted_rms"]))
        if orbit := ReferenceOrbit.of_estimate(estimate, self._run.propagator.rso.cd):
            self._known.append(orbit)
        self._usable, self._spare = self._run.newest([estimate.solution], self._usable, self._spare)
        return estimate

    def _goes_across(self, estimate: Estimate) -> bool:
        """Whether a fit takes a track in that is far from its prediction, with about the drag from before."""
        cd, variance = estimate.fit.best[CD], estimate.fit.covariance[CD, CD]
        if any(_has_other_drag(cd, variance, one) for one in self._before):
            return False
        return self._takes_in(estimate)

    def _takes_in(self, estimate: Estimate) -> bool:
        """Whether a fit goes through all its tracks as usual, outliers aside."""
        if not estimate.fit.converged:
            return False
        measured, window = self._run.measured, estimate.window
        rows, observables = measured.layout(window.rows)
        tracks = np.searchsorted(measured.first_row, window.index[rows], side="right")
        together = pd.Series(self._run.residuals([estimate])[0]).groupby([tracks, observables])
        # A foreign track has residuals on one side. Of n normal ones the median scatters by 1.2533 / sqrt(n),
        # so pulls of the object's own tracks are about 1; a few outliers move no median.
        pulls = together.median().abs() * np.sqrt(together.size()) / _MEDIAN
        return bool(pulls.max() <= _WORST * max(1.0, float(np.median(self._sizes[-_LATELY:]))))

    def _refuse(self, tracks: Sequence[int]) -> None:
        for track in tracks:
            _log.info("track %d at %.0f s is of another object", track, self._time(track))
        self.foreign.update(tracks)
        self._waiting = []

    def _held_back(self, track: int) -> Estimate:
        """Return the estimate at a track that is held back, which is none."""
        fit = Fit(np.full(7, np.nan), self._method)
        fit.reject(HELD_BACK)
        return Estimate(self._run.measured.track(track), fit)

    def _waits_too_long(self, track: int) -> bool:
        """Whether no orbit explains tracks for more than a window: then forces err more than was known."""
        begin = self._time(self._waiting[0] if self._waiting else track)
        return self._time(track) - begin > self._run.settings.window_hours * HOUR

    def _burn(self, away: Sequence[float]) -> TrackedBurn | None:
        """Return the burn that the tracks held back show, if any, and restart after it."""
        newest, older = self._before[0], self._before[-1]
        went_along = _has_other_drag(newest.parameters[CD], newest.covariance[CD, CD], older)
        before = older if went_along or not self._are_far(away[:1]) else newest
        for tracks in _agreements(self._waiting):
            fitted = self._orbit(tracks, before)
            if fitted is None:
                continue
            window, fit = fitted.window, fitted.fit
            after = ReferenceOrbit(window.track, window.at, fit.best, fit.covariance)
            burn = self._between(before, after, tracks[0])
            if burn is None or (burn.mismatch > self._limit and len(tracks) < MANY):
                continue
            if burn.mismatch > self._limit:
                burn = replace(burn, velocity=np.full(3, np.nan))
            self._restart_after_burn(burn, after, tracks)
            return burn
        return None

    def _orbit(self, tracks: Sequence[int], before: ReferenceOrbit) -> Estimate | None:
        window = self._run.measured.of_tracks(tracks[-1], tracks)
        start = self._run.carry(before.at, before.parameters, np.array([window.at]))[0]
        method = replace(self._method, free=self._method.free & (np.arange(7) != CD))
        [estimate] = self._run.complete([Estimate(window, Fit(start, method))])
        return estimate if self._takes_in(estimate) else None

    def _between(self, before: ReferenceOrbit, after: ReferenceOrbit, first: int) -> TrackedBurn | None:
        """Return the burn between an orbit and one of tracks that were held back, by the first of these."""
        measured = self._run.measured
        span = float(measured.epochs[measured.ends[before.track]]), self._time(first)
        return burn_between(self._run, before, after, span, usual_scale(self._past[0]))

    def _restart_after_burn(self, burn: TrackedBurn, after: ReferenceOrbit, tracks: Sequence[int]) -> None:
        """Take a burn for found: what was held back on the new orbit counts, what is older does not."""
        self._cd = float(after.parameters[CD])
        times = self._run.measured.epochs[self._run.measured.at]
        first = min(int(np.searchsorted(times, burn.t)), tracks[0])
        self._refuse([track for track in self._waiting if track not in tracks])
        self.burns.append((first, burn))
        self._known, self._usable, self._spare = [after], (after.at, after.parameters), None
        sizes = " ".join(f"{v:+.4f}({s:.4f})" for v, s in zip(burn.velocity, burn.sigma, strict=True))
        _log.info(
            "burn at %.0f s: %s m/s along R, S, W, orbits differ by %.1f sigma", burn.t, sizes, burn.mismatch
        )


def _has_other_drag(cd: float, variance: float, before: ReferenceOrbit) -> bool:
    """Return whether Cd, of a variance, is another one than that of an orbit before."""
    sigma = np.sqrt(variance + before.covariance[CD, CD])
    return bool(abs(cd - before.parameters[CD]) > _DRAG * abs(before.parameters[CD]) + sigma)


def _agreements(tracks: Sequence[int]) -> Iterator[list[int]]:
    """Yield which of the tracks that were held back may be on one orbit: all, or all but one."""
    newest = list(tracks[-MANY:])
    if len(newest) >= AGREEING:
        yield newest
    if len(newest) > AGREEING:
        yield from (newest[:k] + newest[k + 1 :] for k in range(len(newest) - 1))


def estimate_all(
    propagator: Propagator, starts: pd.DataFrame, measured: Measurements, *, settings: Estimation
) -> pd.DataFrame:
    """Return the `estimates` table, fitted without tracks that do not belong.

    Where no setting asks for it, all tracks count. starts: as of `estimation.with_noise`
    """
    return with_noise(propagator, starts, measured, settings=settings)[0]


def with_noise(
    propagator: Propagator, starts: pd.DataFrame, measured: Measurements, *, settings: Estimation
) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Return the `estimates` table as `estimate_all`, and the noise by the fits, see `biases`."""
    if settings.suspect_sigma is None:
        return estimation.with_noise(propagator, starts, measured, settings=settings)
    run = Run.of_starts(propagator, starts, measured, settings)
    method = run.method(run.free_parameters())
    watch = Watch(run, method)
    rows, estimates = [], []
    for track in range(measured.tracks):
        estimate, burn = watch.take(track)
        rows.append(watch.row(estimate, burn))
        estimates.append(estimate)
        if propagator.progress:
            propagator.progress((track + 1) / measured.tracks)
    return pd.DataFrame(rows), biases.instrument_residuals(measured, estimates, run.residuals)
