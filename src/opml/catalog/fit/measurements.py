"""Measurements that orbits are fitted to: by row, gathered in tracks, each with the epoch of its estimate."""

import math
from abc import ABC, abstractmethod
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from opml.catalog.fit.least_squares import Evaluation
from opml.orbits.manoeuvres import Manoeuvre

Rows = slice | np.ndarray  # rows of measurements: all between two of them, or those of an index


@dataclass(frozen=True)
class Window:
    """The measurements of one fit: of its track, and of the tracks around it."""

    track: int
    tracks: int
    rows: Rows
    first: int  # epoch of the oldest measurement, an index into the run's epochs
    at: int  # epoch of the estimate
    last: int  # epoch of the newest measurement

    @property
    def measurements(self) -> int:
        """Number of the measurements."""
        return _size(self.rows)

    @property
    def index(self) -> np.ndarray:
        """Numbers (measurements,) of the rows."""
        return np.arange(self.rows.start, self.rows.stop) if isinstance(self.rows, slice) else self.rows


def _size(rows: Rows) -> int:
    return int(rows.stop - rows.start) if isinstance(rows, slice) else len(rows)


class Measurements(ABC):
    """Measurements of a run by row, their epochs, and where each track begins and ends.

    epochs: (n,) of measurements [s], ascending
    epoch_of_row: (rows,) index of each row's epoch
    first_row: (tracks + 1,) where the rows of each track begin
    at, ends: (tracks,) index of the epochs of each track's oldest measurement, where its estimate is, and of
        its newest one; the former ascend
    numbers: in a measurement at most
    smooth_for: how long from its beginning a track may be laid through by one curve [s]
    restarts: (tracks,) time before which the window of an estimate holds nothing [s]
    states: (tracks, 6) GCRF at the epochs of the estimates, where the measurements themselves tell them
    """

    sigmas: np.ndarray  # (rows, observables) standard deviations [rad, m, m/s]
    numbers = 3
    smooth_for = math.inf

    def __init__(self, track: np.ndarray, t: np.ndarray) -> None:
        """Take number and epoch of each row (rows,), in the order of the tracks."""
        self.epochs, self.epoch_of_row = np.unique(t, return_inverse=True)
        self.first_row = np.searchsorted(track, np.arange(track[-1] + 2))
        self.tracks = len(self.first_row) - 1
        self.at = self.epoch_of_row[self.first_row[:-1]]
        self.ends = np.maximum.reduceat(self.epoch_of_row, self.first_row[:-1])
        self.restarts = np.full(self.tracks, -np.inf)
        self.states: np.ndarray | None = None

    def restart_after_burns(self, manoeuvres: Sequence[Manoeuvre]) -> Self:
        """Let the windows of estimates hold nothing from before manoeuvres that are known by then; return it.

        manoeuvres: in the order of their times; those count after which fits restart
        """
        for one in manoeuvres:
            since = one.counts_from if one.restarts else np.inf
            self.restarts[self.epochs[self.at] >= since] = one.t
        return self

    def window(
        self, track: int, length: float, after: float = 0.0, *, without: Collection[int] = ()
    ) -> Window:
        """Return the window from `length` [s] before the estimate of a track to `after` [s] behind it.

        without: tracks that are left out
        """
        at = self.epochs[self.at]
        oldest = int(np.searchsorted(at, at[track] - length))
        newest = int(np.searchsorted(at, at[track] + after, side="right")) - 1
        since = self.restarts[track]
        kept = [k for k in range(oldest, newest + 1) if k not in without and (k == track or at[k] >= since)]
        return self.of_tracks(track, kept)

    def track(self, track: int) -> Window:
        """Return the window of one track alone."""
        return self.of_tracks(track, [track])

    def of_tracks(self, track: int, tracks: Sequence[int]) -> Window:
        """Return the window of an estimate at a track that is made of ascending tracks."""
        at, oldest, newest = int(self.at[track]), tracks[0], tracks[-1]
        rows: Rows = slice(int(self.first_row[oldest]), int(self.first_row[newest + 1]))
        if len(tracks) <= newest - oldest:
            rows = np.concatenate([np.arange(*self.first_row[k : k + 2]) for k in tracks])
        return Window(
            track=track,
            tracks=len(tracks),
            rows=rows,
            first=min(at, int(self.at[oldest])),
            at=at,
            last=max(at, int(self.ends[tracks].max())),
        )

    def count(self, rows: Rows) -> int:
        """Return how many numbers rows of measurements hold."""
        return self.numbers * _size(rows)

    def layout(self, rows: Rows) -> tuple[np.ndarray, np.ndarray]:
        """Return the row, from the first one, and the observable of each number (numbers,) that rows hold."""
        row, observable = np.divmod(np.arange(self.count(rows)), self.numbers)
        return row, observable

    def deviations(self, rows: Rows) -> np.ndarray:
        """Return the standard deviation of each number (numbers,) that rows hold [rad, m, m/s]."""
        row, observable = self.layout(rows)
        return self.sigmas[rows][row, observable]

    def times(self, rows: Rows) -> np.ndarray:
        """Return the epochs (n,) of rows [s]."""
        return self.epochs[self.epoch_of_row[rows]]

    def lines(self, rows: Rows) -> tuple[np.ndarray, np.ndarray]:
        """Return where in GCRF (n, 3) [m] lines of sight of rows begin, and unit vectors (n, 3) along them.

        The latter are NaN of rows that give no direction.
        """
        nothing = np.full((len(self.times(rows)), 3), np.nan)
        return nothing, nothing

    def instruments(self, rows: Rows) -> np.ndarray:
        """Return the instrument of each number (numbers,) that rows hold, from 0 on: here its observable."""
        return self.layout(rows)[1]

    def instrument_names(self) -> list[str]:
        """Return the names of all instruments."""
        return [
            "radial",
            "along track",
            "across track",
            "radial rate",
            "rate along track",
            "rate across track",
        ]

    def distances(self, rows: np.ndarray, positions: np.ndarray) -> np.ndarray:
        """Return how far (n,) [m] positions (n, 3) in GCRF are from where rows of measurements can be."""
        return np.asarray(np.linalg.norm(self.places(rows) - positions, axis=1))

    @abstractmethod
    def places(self, rows: Rows) -> np.ndarray:
        """Return positions (n, 3) in GCRF [m] of rows of measurements, NaN of those that give none."""

    @abstractmethod
    def evaluation(self, window: Window, states: np.ndarray, *, light_time: bool = False) -> Evaluation:
        """Return residuals and partial derivatives of a window.

        states: (8, epochs, 6) GCRF [m, m/s] of the nominal arc and its neighbours, at the epochs from
        window.first to window.last
        light_time: as in `Estimation`
        """
