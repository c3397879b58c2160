"""Ranges by laser, there and back, as measurements of an orbit.

Stations stand where coordinates, velocities, eccentricities and the solid tide put them; the air's delay and
relativity's belong to the orbit that is tried.
"""

from collections.abc import Collection
from dataclasses import dataclass

import erfa
import numpy as np
import pandas as pd

from opml.base import epochs
from opml.base.constants import DAY, GM, SPEED_OF_LIGHT
from opml.base.errors import InputError
from opml.catalog.fit.least_squares import Evaluation
from opml.catalog.fit.measurements import Measurements, Rows, Window
from opml.catalog.fit.observations import Measured
from opml.catalog.fit.range_corrections import bent, mapped, tide, vapour_pressure, zenith_delay
from opml.catalog.simulate.observing import StationStates, horizon, observe, retarded
from opml.dynamics.frames import gcrf_to_itrf

_WGS84 = 1
_MOVERS = ("moon", "sun")  # bodies whose tides move stations

_STATION = [f"{axis}_station" for axis in "xyz"]


@dataclass(frozen=True)
class Sites:
    """Positions of laser stations: tables of `interop.sinex`."""

    coordinates: pd.DataFrame  # of `read_coordinates`
    eccentricities: pd.DataFrame  # of `read_eccentricities`

    def position(self, station: str, system: str, date: pd.Timestamp) -> np.ndarray:
        """Return the position (3,) in ITRF [m] that a station's ranges count from at a date.

        Raises InputError for a station of several points, and without coordinates or eccentricity then.
        """
        marks = self.coordinates[self.coordinates["station"] == station]
        if len(points := marks["point"].unique()) > 1:
            raise InputError(f"station {station}: expected one point of its site, got {' and '.join(points)}")
        mark = _valid(marks, date)
        ours = self.eccentricities["station"] == station
        away = _valid(self.eccentricities[ours & (self.eccentricities["system"] == system)], date)
        if mark is None or away is None:
            lacking = "coordinates" if mark is None else f"an eccentricity of its system {system}"
            raise InputError(f"station {station}: expected {lacking} on {date:%Y-%m-%d}, got none")
        seconds = (date - mark["reference"]).total_seconds()
        there = mark[["x", "y", "z"]].to_numpy(float) + seconds * mark[["vx", "vy", "vz"]].to_numpy(float)
        lon, lat, _ = erfa.gc2gd(_WGS84, there)
        return there + away[["east", "north", "up"]].to_numpy(float) @ horizon(lon, lat)


def _valid(rows: pd.DataFrame, date: pd.Timestamp) -> pd.Series | None:
    begun = rows["begin"].isna() | (rows["begin"] <= date)
    valid = rows[begun & (rows["end"].isna() | (rows["end"] >= date))]
    return None if valid.empty else valid.iloc[-1]


def table(
    points: pd.DataFrame,
    sites: Sites,
    *,
    epoch: str,
    earth_orientation: pd.DataFrame,
    ephemerides: pd.DataFrame,
    sigma: float,
    offset: float,
) -> pd.DataFrame:
    """Return the table `laser_ranges` of normal points.

    points: of `interop.crd.read`, by passes
    epoch: UTC text from which their times count
    earth_orientation, ephemerides: tables of the environment
    sigma: least standard deviation of a point [m]; the scatter of its ranges counts where that is larger
    offset: of the reflectors from the satellite's centre of mass, towards the station [m]

    Passes that overlap are one track. Raises InputError for a station without coordinates.
    """
    points = points.assign(track=_tracks(points)).sort_values(["track", "t"], ignore_index=True)
    stood, t = positions(points, sites, epoch=epoch), points["t"].to_numpy()
    _, latitude, height = erfa.gc2gd(_WGS84, stood)
    moved = stood + _tides(stood, t, earth_orientation, ephemerides)
    pressure, temperature, humidity, wavelength = (
        points[["pressure", "temperature", "humidity", "wavelength"]].to_numpy().T
    )
    vapour = vapour_pressure(pressure, temperature, humidity)
    columns = {
        "range": 0.5 * SPEED_OF_LIGHT * points["flight"] + offset,
        "sigma_range": np.fmax(sigma, points["scatter"]),
        **dict(zip(_STATION, moved.T, strict=True)),
        "zenith_delay": zenith_delay(pressure, vapour, wavelength, latitude, height),
        "temperature": temperature,
    }
    return points[["track", "t", "station"]].assign(**columns)


class LaserRanges(Measured):
    """The ranges of a table `laser_ranges`; the estimate of a pass is at its start."""

    def __init__(self, ranges: pd.DataFrame, earth_orientation: pd.DataFrame) -> None:
        track, t = ranges["track"].to_numpy(), ranges["t"].to_numpy()
        Measurements.__init__(self, track, t)
        position, there_and_back = ranges[_STATION].to_numpy(), np.ones(len(t), bool)
        longitude, latitude, height = erfa.gc2gd(_WGS84, position)
        axes = np.array([horizon(lon, lat) for lon, lat in zip(longitude, latitude, strict=True)])
        self.stands = StationStates.of_places(t, position, axes, earth_orientation, two_way=there_and_back)
        self.names, self.stations = ["range"], ranges["station"].to_numpy()
        self.values, self.sigmas = ranges[["range"]].to_numpy(), ranges[["sigma_range"]].to_numpy()
        self.counting = np.isfinite(self.values)
        self.zenith_delay = ranges["zenith_delay"].to_numpy()
        self._air = ranges["temperature"].to_numpy(), latitude, height

    def evaluation(self, window: Window, states: np.ndarray, *, light_time: bool = True) -> Evaluation:
        """Return residuals and partial derivatives, as `Measurements.evaluation`; light always travels."""
        return super().evaluation(window, states, light_time=True)

    def reduced(self, rows: Rows, positions: np.ndarray, velocities: np.ndarray) -> np.ndarray:
        """Return ranges (n, 1) [m] without the delays by air and the Earth's mass."""
        stands = self.stands.among(rows)
        left, _, _ = retarded(positions, velocities, stands.position)
        elevation = observe(left, stands.position, stands.to_horizon)[:, 1]
        air = self.zenith_delay[rows] * mapped(elevation, *(values[rows] for values in self._air))
        return np.asarray(self.values[rows] - (air + bent(left, stands.position))[:, None])


def of_run(points: pd.DataFrame, duration: float, *, without: Collection[int] = ()) -> pd.DataFrame:
    """Return the points within a run of a duration [s], but for some stations'.

    Raises InputError where there are none.
    """
    wanted = points[~points["station"].isin([str(number) for number in without])]
    within = wanted[wanted["t"].between(0.0, duration)]
    if within.empty:
        days = " to ".join(f"{t / DAY:+.2f}" for t in points["t"].agg(["min", "max"]))
        whose = "others" if without else "normal points"
        expected = f"{whose} within the run, of {duration / DAY:g} days"
        raise InputError(f"{points['path'].iloc[0]}: expected {expected}, got some from day {days}")
    return within.reset_index(drop=True)


def positions(points: pd.DataFrame, sites: Sites, *, epoch: str) -> np.ndarray:
    """Return the stations' positions (n, 3) in ITRF [m] at the passes of points, without tides.

    epoch: UTC text from which their times count. Raises InputError for a station without coordinates.
    """
    year, month, day, hour, minute, second = epochs.parse(epoch)
    zero, positions = pd.Timestamp(year, month, day, hour, minute, int(second)), np.empty((len(points), 3))
    by_pass = points.groupby(["track", "station", "system"], sort=False)
    for (_, station, system), rows in by_pass.indices.items():
        date = zero + pd.Timedelta(seconds=float(points["t"].iloc[rows[0]]))
        positions[rows] = sites.position(str(station), str(system), date)
    return positions


def _tracks(points: pd.DataFrame) -> np.ndarray:
    """Return the number (n,) of each point's track: of its pass and those that overlap."""
    spans = points.groupby("track")["t"].agg(["min", "max"]).sort_values("min")
    latest = spans["max"].cummax().shift(fill_value=-np.inf)
    return np.asarray((spans["min"] > latest).cumsum().sub(1).reindex(points["track"]))


def _tides(
    positions: np.ndarray, t: np.ndarray, earth_orientation: pd.DataFrame, ephemerides: pd.DataFrame
) -> np.ndarray:
    """Return how far (n, 3) the solid Earth's tide moves stations at positions (n, 3) in ITRF [m]."""
    to_itrf, nodes = gcrf_to_itrf(earth_orientation, t), ephemerides["t"].to_numpy()
    moved = np.zeros_like(positions)
    for name in _MOVERS:
        gcrf = np.stack([np.interp(t, nodes, ephemerides[f"{name}_{axis}"]) for axis in "xyz"], axis=-1)
        moved += tide(positions, np.einsum("nij,nj->ni", to_itrf, gcrf), GM[name])
    return moved
