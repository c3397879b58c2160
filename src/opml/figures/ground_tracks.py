"""A map of the Earth: land, points below an orbit, lines that leave the map on one side."""

from importlib.resources import files

import erfa
import numpy as np
from matplotlib.axes import Axes

from opml.figures.style import MUTED, PUBLISHED

LAND = files("opml") / "data" / "land.csv"
LAND_COLOR = "#EFEFEA"
WGS84 = 1


def geodetic_places(positions: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return longitude, latitude [deg] and height [m] on WGS84, (n,) each, of ITRF positions (n, 3) [m]."""
    longitude, latitude, height = erfa.gc2gd(WGS84, positions)
    return np.degrees(longitude), np.degrees(latitude), height


def outlines() -> list[np.ndarray]:
    """Return the outlines of land, each as longitude and latitude [deg] of its points (n, 2)."""
    blocks = LAND.read_text().split("\n\n")
    return [np.loadtxt(block.splitlines(), delimiter=",", comments="#") for block in blocks if block.strip()]


def draw_land(axes: Axes) -> None:
    """Draw land below all else."""
    for outline in outlines():
        axes.fill(*outline.T, facecolor=LAND_COLOR, edgecolor=MUTED, lw=0.3, zorder=0.5)


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
