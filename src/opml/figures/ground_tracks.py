"""A map of what stations see: a day of ground tracks, the passes that were tracked, circles of visibility."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime, timedelta
from importlib.resources import files
from typing import Any

import erfa
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from opml.base.constants import DAY, WGS84_A
from opml.base.errors import InputError
from opml.dynamics.frames import gcrf_to_itrf
from opml.figures.axis_labels import clauses
from opml.figures.style import (
    ESTIMATE,
    HIGHLIGHT,
    MARKERS,
    MUTED,
    OBSERVED_COLOR,
    PREDICTED_COLOR,
    PUBLISHED,
    RESIDUAL,
    legend,
    page_figure,
)
from opml.orbits.sheets import Station

LAND = files("opml") / "data" / "land.csv"
LAND_COLOR = "#EFEFEA"
STATIONS = (RESIDUAL, PREDICTED_COLOR, ESTIMATE, HIGHLIGHT)
WGS84 = 1

AZIMUTHS = np.radians(np.arange(0.0, 361.0, 2.0))
"""Directions from a station in which its circle of visibility is drawn."""


@dataclass(frozen=True)
class ObservedOrbit:
    """An orbit, the turning Earth below it, and the stations that observe it."""

    truth: pd.DataFrame  # the orbit as that table
    earth_orientation: pd.DataFrame  # that table
    stations: Sequence[Station]

    def itrf(self, states: pd.DataFrame) -> np.ndarray:
        """Return the positions (n, 3) of rows of the truth in ITRF [m]."""
        turn = gcrf_to_itrf(self.earth_orientation, states["t"].to_numpy())
        return np.einsum("nij,nj->ni", turn, states[["x", "y", "z"]].to_numpy())


def world(
    orbit: ObservedOrbit, tracking: pd.DataFrame, *, first_day: float, epoch: str, note: str = ""
) -> Figure:
    """Draw the ground track of a day, the part of it that was tracked, and what each station can see.

    A station sees an RSO at the day's mean height inside of its circle, which ends at its lowest elevation or
    its longest range. Raises InputError where the truth has no epoch in that day.

    first_day: at which the day begins [d]
    """
    rows = orbit.truth[orbit.truth["t"].between(first_day * DAY, (first_day + 1.0) * DAY)]
    if rows.empty:
        raise InputError(f"world map: expected epochs of day {first_day:g}, got none")
    longitude, latitude, height = geodetic_places(orbit.itrf(rows))
    figure = page_figure(height_mm=108.0)
    axes = figure.add_subplot()
    draw_land(axes)
    axes.plot(*split_line(longitude, latitude), color=MUTED, lw=0.7, label="ground track")
    is_tracked = rows["t"].isin(tracking["t"]).to_numpy()
    tracked = np.where(is_tracked, latitude, np.nan)
    axes.plot(*split_line(longitude, tracked), color=OBSERVED_COLOR, lw=1.8, label="tracked")
    for k, station in enumerate(orbit.stations):
        _draw_station(axes, station, float(height.mean()), k)
    frame(axes)
    begin = datetime.fromisoformat(epoch) + timedelta(days=first_day)
    day = f"24 h from {begin:%Y-%m-%d %H:%M} UTC (day {first_day:g})"
    legend(figure, columns=5, note=clauses(note, day, f"circles: in sight at {height.mean() / 1e3:.0f} km"))
    return figure


def geodetic_places(positions: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return longitude, latitude [deg] and height [m] on WGS84, (n,) each, of ITRF positions (n, 3) [m]."""
    longitude, latitude, height = erfa.gc2gd(WGS84, positions)
    return np.degrees(longitude), np.degrees(latitude), height


def sight_angle(station: Station, height: float) -> float:
    """Return the angle at the Earth's centre [rad] up to which a station sees an RSO, on a sphere.

    It is the lesser of what the station's lowest elevation and its longest range leave.

    height: of the RSO [m]
    """
    radius = WGS84_A + height
    low = station.min_elevation
    by_elevation = np.arccos(min(1.0, WGS84_A / radius * np.cos(low))) - low
    cosine = (WGS84_A**2 + radius**2 - station.max_range**2) / (2.0 * WGS84_A * radius)
    return float(min(by_elevation, np.arccos(np.clip(cosine, -1.0, 1.0))))


def circle(station: Station, angle: float) -> tuple[np.ndarray, np.ndarray]:
    """Return longitudes and latitudes [deg] of the points at an angle [rad] from a station, on a sphere."""
    sine, cosine = np.sin(station.latitude), np.cos(station.latitude)
    latitude = np.arcsin(sine * np.cos(angle) + cosine * np.sin(angle) * np.cos(AZIMUTHS))
    longitude = station.longitude + np.arctan2(
        np.sin(AZIMUTHS) * np.sin(angle) * cosine, np.cos(angle) - sine * np.sin(latitude)
    )
    return (np.degrees(longitude) + 180.0) % 360.0 - 180.0, np.degrees(latitude)


def outlines() -> list[np.ndarray]:
    """Return the outlines of land, each as longitude and latitude [deg] of its points (n, 2)."""
    blocks = LAND.read_text().split("\n\n")
    return [np.loadtxt(block.splitlines(), delimiter=",", comments="#") for block in blocks if block.strip()]


def draw_land(axes: Axes) -> None:
    """Draw land below all else."""
    for outline in outlines():
        axes.fill(*outline.T, facecolor=LAND_COLOR, edgecolor=MUTED, lw=0.3, zorder=0.5)


def _draw_station(axes: Axes, station: Station, height: float, k: int) -> None:
    color = STATIONS[k % len(STATIONS)]
    axes.plot(*split_line(*circle(station, sight_angle(station, height))), color=color, lw=1.0, zorder=3.0)
    place = np.degrees([station.longitude, station.latitude])
    look: dict[str, Any] = {"ls": "", "color": color, "mec": "white", "mew": 0.5, "ms": 6.0, "zorder": 4.0}
    axes.plot(*place[:, None], marker=MARKERS[k % len(MARKERS)], label=station.name.capitalize(), **look)


def split_line(longitude: np.ndarray, latitude: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return a line that ends where it leaves the map on one side, and goes on from the other."""
    jumps = np.flatnonzero(np.abs(np.diff(longitude)) > 180.0) + 1
    edge = np.copysign(180.0, longitude[jumps - 1])
    before, after = 180.0 - np.abs(longitude[jumps - 1]), 180.0 - np.abs(longitude[jumps])
    share = before / np.maximum(before + after, np.finfo(float).tiny)
    crossed = latitude[jumps - 1] + share * (latitude[jumps] - latitude[jumps - 1])
    gap, places = np.full(len(jumps), np.nan), np.repeat(jumps, 3)
    return (
        np.insert(longitude, places, np.column_stack([edge, gap, -edge]).ravel()),
        np.insert(latitude, places, np.column_stack([crossed, gap, crossed]).ravel()),
    )


def frame(axes: Axes) -> None:
    """Show the whole Earth under a graticule of 30 degrees."""
    axes.set(xlim=(-180.0, 180.0), ylim=(-90.0, 90.0), aspect="equal")
    axes.set_xticks(np.arange(-180, 181, 30))
    axes.set_yticks(np.arange(-90, 91, 30))
    axes.set_xlabel("longitude [deg]")
    axes.set_ylabel("latitude [deg]")
    axes.tick_params(colors=PUBLISHED)
