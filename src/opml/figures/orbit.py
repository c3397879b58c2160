"""Figures of the orbit, of its elements, and of the tracks that an estimate is made of."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator, MultipleLocator
from mpl_toolkits.mplot3d import Axes3D
from mpl_toolkits.mplot3d.art3d import Line3DCollection

from opml.base.constants import DAY, HOUR, WGS84_A
from opml.base.errors import InputError
from opml.figures.axis_labels import clauses
from opml.figures.style import (
    ESTIMATE,
    HIGHLIGHT,
    LEAST_ALPHA,
    MUTED,
    PUBLISHED,
    TRACK_COLOR,
    TRUE_COLOR,
    add_head,
    add_head_and_legend,
    page_figure,
    space_figure,
)
from opml.orbits.elements import coe_from_cartesian
from opml.tables import STATE

REVOLUTIONS = 40  # revolutions that stand for the whole orbit: more would hide each other
ELEVATION, AZIMUTH = 25.0, -50.0  # where the viewer of the orbit stands [deg]

EARLY_TO_LATE = LinearSegmentedColormap.from_list("early to late", ["#D7191C", "#7B3294", "#2C7BB6"])

_COE = ("a", "e", "i", "argp", "raan", "nu")
_ELEMENTS = {
    "a": (r"$a$ [km]", 1e-3),
    "e": (r"$e$ [$10^{-3}$]", 1e3),
    "i": (r"$i$ [deg]", np.degrees(1.0)),
    "argp": (r"$\omega$ [deg]", np.degrees(1.0)),
    "raan": (r"$\Omega$ [deg]", np.degrees(1.0)),
    "nu": (r"$\nu$ [deg]", np.degrees(1.0)),
}
_TURNING = ("argp", "raan", "nu")


def select_days(table: pd.DataFrame, days: Sequence[float]) -> pd.DataFrame:
    """Return the rows of a table whose time `t` [s] lies between two days, both included."""
    first, last = days
    return table[table["t"].between(first * DAY, last * DAY)]


def estimation_window(tracking: pd.DataFrame, *, track: int, window_hours: float, note: str = "") -> Figure:
    """Draw the tracks used for one estimate, and their neighbours that are not; one lane per station.

    After the paper's figure 'Illustration of the tracks included for an estimation at t_i'. Raises InputError
    for a track that is not in the table.

    track: at whose start the estimate is
    window_hours: tracks that began so long before that start, or less, are used
    """
    tracks = tracking.groupby("track").agg(start=("t", "min"), end=("t", "max"), station=("station", "first"))
    if track not in tracks.index:
        raise InputError(f"estimation window: expected a track of the table, got {track}")
    epoch = tracks.loc[track, "start"]
    start, end = (tracks["start"] - epoch) / HOUR, (tracks["end"] - epoch) / HOUR
    first, last = -2.0 * window_hours, window_hours
    near = (end >= first) & (start <= last)
    used = near & (start >= -window_hours) & (start <= 0.0)

    stations = list(tracks["station"].unique())
    lane = tracks["station"].map(stations.index)
    figure = page_figure(height_mm=36.0 + 8.0 * len(stations))
    axes = figure.add_subplot()
    axes.axvspan(-window_hours, 0.0, color="#EBEBEB", lw=0.0, label=f"estimation window, {window_hours:g} h")
    for label, own, color in (("track used", used, HIGHLIGHT), ("track not used", ~used, TRACK_COLOR)):
        # The edge keeps a track of a single measurement visible.
        look: dict[str, Any] = {"color": color, "edgecolor": color, "lw": 0.5, "zorder": 2}
        shown = near & own
        axes.barh(lane[shown], (end - start)[shown], left=start[shown], height=0.5, label=label, **look)
    dots: dict[str, Any] = {"color": ESTIMATE, "ms": 3.0, "mew": 0.0}
    axes.plot(start[near], lane[near] + 0.37, "o", label="epoch of an estimate", **dots)
    axes.axvline(0.0, color=TRUE_COLOR, lw=0.8, zorder=1.5)
    axes.annotate(
        "$t_i$",
        (0.0, 1.0),
        xycoords=axes.get_xaxis_transform(),
        xytext=(0.0, 1.5),
        textcoords="offset points",
        ha="center",
    )
    axes.set_xlim(first, last)
    axes.set_ylim(len(stations) - 0.4, -0.4)
    axes.set_yticks(range(len(stations)), [station.capitalize() for station in stations])
    axes.xaxis.set_major_locator(MultipleLocator(window_hours / 4.0))
    axes.grid(visible=False, axis="y")
    axes.set_xlabel(f"time since $t_i$ = {epoch / DAY:.3f} d [h]")
    axes.set_ylabel("station")
    headline = f"An estimate uses the {used.sum()} tracks that begin within {window_hours:g} h before it"
    add_head_and_legend(figure, headline, note, columns=4)
    return figure


def orbit_3d(truth: pd.DataFrame, tracking: pd.DataFrame, *, note: str = "") -> Figure:
    """Draw the orbit in GCRF [1000 km], red at the beginning and blue at the end, with the observed points.

    After the paper's figure 'True orbit and observations of the RSO'. Of a long orbit, REVOLUTIONS whole
    revolutions are drawn, evenly spread, with the points observed on them; what the Earth hides is left out.
    Raises InputError for less than one revolution.

    truth, tracking: those tables, of epochs in common
    """
    days, positions = truth["t"].to_numpy() / DAY, truth[["x", "y", "z"]].to_numpy() / 1e6
    revolution = _revolutions(positions)
    whole = int(revolution[-1])
    if whole < 1:
        raise InputError(f"orbit in 3D: expected at least one revolution, got {revolution[-1]:.2f}")
    drawn = np.unique(np.linspace(0, whole - 1, REVOLUTIONS).round())
    sight = _is_visible(positions)
    shown = np.isin(np.floor(revolution), drawn) & sight
    starts = np.flatnonzero(shown[:-1])
    observed = positions[np.isin(truth["t"], tracking["t"]) & shown]

    figure, axes = space_figure(height_mm=90.0)
    axes.set_proj_type("ortho")
    axes.view_init(elev=ELEVATION, azim=AZIMUTH)
    axes.computed_zorder = False
    _draw_earth(axes)
    arcs = Line3DCollection(
        np.stack([positions[starts], positions[starts + 1]], axis=1),
        cmap=EARLY_TO_LATE,
        linewidths=0.6,
        zorder=2,
        rasterized=True,
    )
    arcs.set_array(days[starts])
    arcs.set_clim(days[0], days[-1])
    axes.add_collection3d(arcs)
    axes.scatter(
        *observed.T,
        s=0.8,
        color="black",
        linewidths=0.0,
        depthshade=False,
        zorder=3,
        rasterized=True,
        label="observed",
    )
    _span(axes, float(np.abs(positions).max()))
    # Automatic layout knows too little of what is drawn in 3D.
    figure.set_layout_engine("none")
    axes.set_position((0.0, 0.15, 0.92, 0.8))
    bar = figure.colorbar(arcs, cax=figure.add_axes((0.2, 0.115, 0.6, 0.018)), orientation="horizontal")
    bar.set_label("time [d]")
    bar.outline.set_linewidth(0.5)
    seen = 100.0 * np.isin(truth["t"], tracking["t"]).mean()
    headline = f"{seen:.1f} % of the orbit is observed"
    add_head(figure, headline, clauses(note, f"{len(drawn)} of {whole} revolutions, GCRF"))
    figure.legend(loc="upper right", markerscale=3.0, bbox_to_anchor=(1.0, 0.92))
    return figure


def orbital_elements(
    truth: pd.DataFrame,
    *,
    gm: float,
    zoom_days: Sequence[float],
    elements: Sequence[str] = ("a", "e", "i", "raan"),
    note: str = "",
) -> Figure:
    """Draw osculating elements against time [d]: range and mean of each revolution, and some days enlarged.

    After the paper's figure 'Instantaneous classical orbital elements'. Raises InputError where the enlarged
    days hold no epoch.

    gm: of the Earth [m3/s2]
    zoom_days: first and last of the enlarged days
    elements: any of a, e, i, argp, raan, nu
    """
    days, turns = truth["t"].to_numpy() / DAY, np.floor(_revolutions(truth[["x", "y", "z"]].to_numpy()))
    coe = dict(zip(_COE, coe_from_cartesian(truth[STATE].to_numpy(), gm).T, strict=True))
    first, last = zoom_days
    zoomed = (days >= first) & (days <= last)
    if not zoomed.any():
        raise InputError(f"orbital elements: expected epochs within days {first:g} to {last:g}, got none")

    figure = page_figure(height_mm=20.0 + 27.0 * len(elements))
    panels = figure.subplots(len(elements), 2, sharex="col", squeeze=False, width_ratios=(3, 2))
    for (left, right), name in zip(panels, elements, strict=True):
        label, factor = _ELEMENTS[name]
        values = coe[name] * factor
        if name in _TURNING:
            values = _break_turns(coe[name]) * factor
            left.plot(days, values, color=TRUE_COLOR, lw=1.0, rasterized=True)
        else:
            _draw_revolutions(left, days, values, turns)
        left.axvspan(first, last, color=HIGHLIGHT, alpha=0.6, lw=0.0, zorder=3)
        right.plot(days[zoomed], values[zoomed], color=TRUE_COLOR, lw=1.0)
        left.set_ylabel(label)
        for axes in (left, right):
            axes.ticklabel_format(axis="y", useOffset=False)
        right.margins(x=0.0)
    _name_zoom(panels[0], first, last)
    mean = pd.Series(coe["a"] * 1e-3).groupby(turns).mean()
    change = f"from {mean.iloc[0]:.0f} to {mean.iloc[max(len(mean) - 2, 0)]:.0f} km"
    add_head(figure, f"The mean semi-major axis changes {change} in {days[-1] - days[0]:.0f} days", note)
    left.set_xlim(days[0], days[-1])
    left.set_xlabel("time [d]")
    right.set_xlabel("time [d]")
    figure.align_ylabels()
    return figure


def _draw_revolutions(axes: Axes, days: np.ndarray, values: np.ndarray, turns: np.ndarray) -> None:
    """Draw the mean and the range of values (n,) over each whole revolution; turns: its number (n,)."""
    whole = turns < max(turns[-1], 1.0)
    of_turn = pd.DataFrame({"day": days, "value": values})[whole].groupby(turns[whole])
    middle, value = of_turn["day"].mean(), of_turn["value"]
    axes.fill_between(middle, value.min(), value.max(), color=MUTED, alpha=LEAST_ALPHA, lw=0.0)
    axes.plot(middle, value.mean(), color=TRUE_COLOR, lw=1.0)


def _span(axes: Axes3D, reach: float) -> None:
    """Let the axes reach equally far on every side [1000 km], on one scale."""
    axes.set(xlim=(-reach, reach), ylim=(-reach, reach), zlim=(-reach, reach))
    axes.set_box_aspect((1, 1, 1))
    for name in "xyz":
        getattr(axes, f"set_{name}label")(f"${name}$ [1000 km]", labelpad=-6.0)
        getattr(axes, f"{name}axis").set_major_locator(MaxNLocator(3, steps=[1, 2, 5, 10]))
        axes.tick_params(axis=name, pad=-3.0)


def _name_zoom(panels: Sequence[Axes], first: float, last: float) -> None:
    """Write above the panels what the band on the left is, and that the right shows its days."""
    left, right = panels
    left.annotate(
        "enlarged",
        (0.5 * (first + last), 1.0),
        xycoords=left.get_xaxis_transform(),
        xytext=(0.0, 2.0),
        textcoords="offset points",
        ha="center",
        fontsize=7.0,
        color=PUBLISHED,
    )
    right.set_title(f"enlarged: days {first:g} to {last:g}", fontsize=8.0, loc="left")


def _revolutions(positions: np.ndarray) -> np.ndarray:
    """Return the revolutions (n,) made at each position (n, 3), from the angles between neighbours."""
    start, end = positions[:-1], positions[1:]
    across = np.linalg.norm(np.cross(start, end), axis=-1)
    angle = np.arctan2(across, np.sum(start * end, axis=-1))
    return np.concatenate([[0.0], np.cumsum(angle)]) / (2.0 * np.pi)


def _is_visible(positions: np.ndarray) -> np.ndarray:
    """Return which (n,) of the positions (n, 3) [1000 km] the Earth does not hide from the viewer."""
    elevation, azimuth = np.radians([ELEVATION, AZIMUTH])
    viewer = np.array(
        [np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)]
    )
    ahead = positions @ viewer
    aside = np.linalg.norm(positions - ahead[:, None] * viewer, axis=-1)
    return (ahead > 0.0) | (aside > WGS84_A / 1e6)


def _draw_earth(axes: Axes3D) -> None:
    longitude, latitude = np.meshgrid(
        np.radians(np.arange(0, 361, 15)), np.radians(np.arange(-90, 91, 15)), indexing="ij"
    )
    radius = WGS84_A / 1e6
    axes.plot_surface(
        radius * np.cos(latitude) * np.cos(longitude),
        radius * np.cos(latitude) * np.sin(longitude),
        radius * np.sin(latitude),
        rstride=1,
        cstride=1,
        color="#FAFAFA",
        edgecolor="#D0D0D0",
        linewidth=0.3,
        shade=False,
        zorder=1,
    )


def _break_turns(angle: np.ndarray) -> np.ndarray:
    """Return the angles [rad] with a gap where they pass a full turn, so that no line joins its two ends."""
    return np.where(np.abs(np.diff(angle, append=angle[-1])) > np.pi, np.nan, angle)
