"""Stations' measurements of an orbit; each estimate is at the start of its track."""

from collections.abc import Sequence
from functools import cached_property

import numpy as np
import pandas as pd

from opml.catalog.fit.least_squares import Evaluation
from opml.catalog.fit.measurements import Measurements, Rows, Window
from opml.catalog.fit.neighbour_arcs import NUDGES
from opml.catalog.simulate.observing import (
    ANGLES,
    OBSERVABLES,
    StationStates,
    difference,
    place,
    predicted,
    sigmas,
)
from opml.orbits.sheets import Station


class Measured(Measurements):
    """The measurements of a table `tracking`: of each row, what the table has and its station a sigma of."""

    def __init__(
        self, tracking: pd.DataFrame, earth_orientation: pd.DataFrame, stations: Sequence[Station]
    ) -> None:
        track, t = tracking["track"].to_numpy(), tracking["t"].to_numpy()
        super().__init__(track, t)
        order = {station.name: k for k, station in enumerate(stations)}
        self.stations = tracking["station"].to_numpy()
        station_of_row = np.array([order[name] for name in self.stations])
        two_way = tracking["two_way"].to_numpy() if "two_way" in tracking else None
        self.stands = StationStates.at(t, stations, station_of_row, earth_orientation, two_way=two_way)
        given = [name for name in OBSERVABLES if name in tracking]
        values = tracking[given].to_numpy()
        spread = np.array([sigmas(station, given) for station in stations])[station_of_row]
        counting = np.isfinite(values) & np.isfinite(spread)
        measured = counting.any(axis=0)
        self.names = [name for name, counts in zip(given, measured, strict=True) if counts]
        self.values, self.sigmas, self.counting = (
            numbers[:, measured] for numbers in (values, spread, counting)
        )

    def count(self, rows: Rows) -> int:
        """Return how many numbers rows of measurements hold."""
        return int(self.counting[rows].sum())

    def layout(self, rows: Rows) -> tuple[np.ndarray, np.ndarray]:
        """Return the row, from the first one, and the observable of each number (numbers,) that rows hold."""
        row, observable = np.nonzero(self.counting[rows])
        return row, observable

    def places(self, rows: Rows) -> np.ndarray:
        """Return positions (n, 3) in GCRF [m] of rows of measurements, NaN without two angles and a range."""
        return np.asarray(self._standing(rows) + self._columns(["range"], rows) * self._sights(rows))

    def instruments(self, rows: Rows) -> np.ndarray:
        """Return the instrument of each number (numbers,) that rows hold: station and observable."""
        row, observable = self.layout(rows)
        station_of_row, _ = self._measuring
        return len(self.names) * station_of_row[rows][row] + observable

    def instrument_names(self) -> list[str]:
        """Return the names of all instruments."""
        return [f"{station} {name}" for station in self._measuring[1] for name in self.names]

    @cached_property
    def _measuring(self) -> tuple[np.ndarray, np.ndarray]:
        """The station of each row (rows,), from 0 on, and the names of the stations."""
        station_of_row, names = pd.factorize(self.stations)
        return station_of_row, np.asarray(names)

    def lines(self, rows: Rows) -> tuple[np.ndarray, np.ndarray]:
        """Return where lines of sight begin, and their directions, as `Measurements.lines`."""
        return self._standing(rows), self._sights(rows)

    def distances(self, rows: np.ndarray, positions: np.ndarray) -> np.ndarray:
        """Return how far (n,) [m] positions (n, 3) in GCRF are from a place, a line of sight or a sphere.

        What a row does not tell is taken from the position.
        """
        away = positions - self._standing(rows)
        sights, ranges = self._sights(rows), self._columns(["range"], rows)
        sights = np.where(np.isfinite(sights), sights, away / np.linalg.norm(away, axis=1, keepdims=True))
        along = np.maximum(np.sum(away * sights, axis=1, keepdims=True), 0.0)
        ranges = np.where(np.isfinite(ranges), ranges, along)
        return np.asarray(np.linalg.norm(away - ranges * sights, axis=1))

    def reduced(self, rows: Rows, positions: np.ndarray, velocities: np.ndarray) -> np.ndarray:
        """Return what rows measured (n, observables), less what is no geometry.

        positions, velocities: (n, 3) of the orbit, as for `predicted`
        """
        return self.values[rows]

    def evaluation(self, window: Window, states: np.ndarray, *, light_time: bool = False) -> Evaluation:
        """Return residuals and partial derivatives of a window, as `Measurements.evaluation`."""
        rows = window.rows
        stands, sigma, counting = self.stands.among(rows), self.sigmas[rows], self.counting[rows].ravel()
        at_rows = states[:, self.epoch_of_row[rows] - window.first]
        positions, velocities = (
            np.einsum("nij,lnj->lni", stands.from_gcrf, vectors)
            for vectors in (at_rows[..., :3], at_rows[..., 3:])
        )

        def seen(side: float) -> np.ndarray:
            """Return what is measured of the neighbours, or of their mirror images about the nominal arc."""
            places, speeds = (one[0] + side * (one[1:] - one[0]) for one in (positions, velocities))
            return predicted(self.names, places, speeds, stands, light_time=light_time)

        nominal = predicted(self.names, positions[0], velocities[0], stands, light_time=light_time)
        reduced = self.reduced(rows, positions[0], velocities[0])
        residual = difference(reduced, nominal, self.names) / sigma
        # By then a step has grown to a hundred metres, over which the measurements bend: between images the
        # bend cancels.
        change = difference(seen(1.0), seen(-1.0), self.names)
        weighted = (0.5 * change / sigma / NUDGES[:, None, None]).reshape(len(NUDGES), -1)
        return Evaluation(np.compress(counting, residual.ravel()), np.compress(counting, weighted, axis=1).T)

    def _columns(self, names: Sequence[str], rows: Rows) -> np.ndarray:
        """Return what rows hold of observables: (n, len(names)), NaN of what does not count."""
        values = np.where(self.counting[rows], self.values[rows], np.nan)
        nothing = np.full(len(values), np.nan)
        held = [values[:, self.names.index(name)] if name in self.names else nothing for name in names]
        return np.stack(held, axis=-1)

    def _standing(self, rows: Rows) -> np.ndarray:
        """Return positions (n, 3) of the stations in GCRF [m]."""
        return self._turned(rows, self.stands.position[rows])

    def _sights(self, rows: Rows) -> np.ndarray:
        """Return unit vectors (n, 3) in GCRF from the stations along the angles, NaN without two of them."""
        azimuth, elevation, right_ascension, declination = self._columns(ANGLES, rows).T
        centre, one = np.zeros(3), np.ones(len(azimuth))
        horizontal = place(np.stack([azimuth, elevation, one], axis=-1), centre, self.stands.to_horizon[rows])
        level = np.cos(declination)
        starry = [level * np.cos(right_ascension), level * np.sin(right_ascension), np.sin(declination)]
        sights = self._turned(rows, horizontal)
        return np.where(np.isfinite(sights), sights, np.stack(starry, axis=-1))

    def _turned(self, rows: Rows, vectors: np.ndarray) -> np.ndarray:
        """Return vectors (n, 3) on the axes of ITRF on those of GCRF."""
        return np.einsum("nij,ni->nj", self.stands.from_gcrf[rows], vectors)
