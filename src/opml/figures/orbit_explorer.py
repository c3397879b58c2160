"""A page to turn an orbit and pick an estimate: one HTML file with all it needs, opened without a server.

Plotly draws the page. It comes with the extra `explore`, and is imported only where a page is made.
"""

import html
import json
from collections.abc import Mapping, Sequence
from datetime import datetime, timedelta
from typing import Any

import numpy as np
import pandas as pd

from opml.base.constants import DAY, WGS84_A
from opml.base.errors import InputError
from opml.figures import ground_tracks
from opml.figures.axis_labels import axis, in_words, si_unit
from opml.figures.display_names import display_learner
from opml.figures.style import (
    ESTIMATE,
    HIGHLIGHT,
    MUTED,
    OBSERVED_COLOR,
    PREDICTED_COLOR,
    PUBLISHED,
    RESIDUAL,
    TRACK_COLOR,
    TRUE_COLOR,
)
from opml.figures.ticks import metres
from opml.orbits.sheets import Station

_MOST = 150  # estimates to pick from: more would make the page slow to load

REVOLUTION_S = 5700.0  # length of the path that is shown from an estimate on [s]
_STEP_S = 60.0  # between its points [s]

DIV = "explore"
KM = 1e-3
NARROW = {
    "scene.domain": {"x": [0.0, 1.0], "y": [0.54, 1.0]},
    "xaxis.domain": [0.08, 1.0],
    "yaxis.domain": [0.0, 0.46],
    "legend.x": 0.0,
    "legend.y": -0.26,
    "legend.yanchor": "top",
    "sliders[0].len": 1.0,
    "sliders[0].currentvalue.font.size": 11,
    "title.font.size": 11,
    "height": 1000,
}
ON_A_PHONE = f"if (window.innerWidth < 800) Plotly.relayout('{DIV}', {json.dumps(NARROW)});"
"""Put the orbit above the errors on a screen that has no room for both side by side."""

COLORS = (RESIDUAL, PREDICTED_COLOR, OBSERVED_COLOR, ESTIMATE, TRACK_COLOR, HIGHLIGHT)
DASHES = ("solid", "dash", "dot", "dashdot")  # a color and a dash together are the look of one model

HEAD = '<head><meta name="viewport" content="width=device-width, initial-scale=1"><title>{title}</title>'
LINK = "font: 12px sans-serif"
HOW = "Turn the orbit, move the slider to another estimate,<br>click a model in the legend."
"""What a visitor can do."""

EARTH, PATH, START, BEFORE = "Earth", "its next 95 minutes", "estimate", "no correction"


def page(
    orbit: ground_tracks.ObservedOrbit,
    evaluations: Mapping[str, pd.DataFrame],
    dataset: pd.DataFrame,
    *,
    component: str,
    epoch: str,
    back: str,
    note: str = "",
) -> str:
    """Return the page as HTML: an orbit over the Earth, and the errors of predictions from one estimate.

    Raises InputError without a model or without plotly.

    evaluations: those tables of one test, by model
    dataset: that table of the RSO tested on, which holds the epochs of the estimates
    back: address of the page that this one belongs to
    """
    if not evaluations:
        raise InputError("page to explore: expected at least one model, got none")
    try:
        from plotly.graph_objects import Figure
    except ImportError:
        raise InputError("page to explore: expected the package plotly, which is not installed") from None
    picks = _picks(next(iter(evaluations.values())), dataset)
    moving = [
        _moving_traces(track, epoch, evaluations, orbit)
        for track, epoch in zip(picks["i"], picks["t_i"], strict=True)
    ]
    fixed = [_earth(), _land(), _stations(orbit.stations)]
    middle = len(moving) // 2  # its predictions are about as long as any
    first = [{**trace, **look} for trace, look in zip(moving[middle], _looks(list(evaluations)), strict=True)]
    indices = list(range(len(fixed), len(fixed) + len(first)))
    slider = {**_slider(_labels(picks["t_i"], epoch), moving, indices), "active": middle}
    layout = _layout(evaluations, component, note) | {"sliders": [slider]}
    config = {"responsive": True, "displaylogo": False}
    figure = Figure(data=[*fixed, *first], layout=layout)
    text: str = figure.to_html(include_plotlyjs=True, div_id=DIV, config=config, post_script=ON_A_PHONE)
    head = HEAD.format(title=html.escape(note.split(";")[0]))
    text = text.replace("<html>", '<html lang="en">', 1).replace("<head>", head, 1)
    return text.replace("<body>", f'<body><a href="{back}" style="{LINK}">Back</a>', 1)


def _picks(evaluation: pd.DataFrame, dataset: pd.DataFrame) -> pd.DataFrame:
    """Return track i and epoch t_i [s] of the estimates to pick from, MOST at most.

    Many predictions of the test start from each.
    """
    epochs = dataset.drop_duplicates("i").set_index("i")["t_i"]
    counts = evaluation["i"].value_counts()
    tracks = np.sort(counts.index[counts >= 0.5 * counts.max()])
    picks = tracks[np.unique(np.linspace(0, len(tracks) - 1, _MOST).round().astype(int))]
    return pd.DataFrame({"i": picks, "t_i": epochs.loc[picks].to_numpy()})


def _moving_traces(
    track: int, epoch: float, evaluations: Mapping[str, pd.DataFrame], orbit: ground_tracks.ObservedOrbit
) -> list[dict[str, Any]]:
    """Return coordinates of the traces that change with the estimate: its path, its place, its errors."""
    path = _path(orbit, epoch)
    places = [dict(zip("xyz", part.T.tolist(), strict=True)) for part in (path, path[:1])]
    predictions = [table[table["i"] == track].sort_values("duration") for table in evaluations.values()]
    errors = [_sizes(predictions[0], "true"), *(_sizes(rows, "residual") for rows in predictions)]
    return [*places, *errors]


def _sizes(rows: pd.DataFrame, column: str) -> dict[str, list[float]]:
    """Return duration [d] and size [m or m/s] of an error, rounded to what a screen shows."""
    return {
        "x": (rows["duration"] / DAY).round(3).tolist(),
        "y": [float(f"{size:.4g}") for size in rows[column].abs()],
    }


def _path(orbit: ground_tracks.ObservedOrbit, epoch: float) -> np.ndarray:
    """Return positions (n, 3) in ITRF [km] of one revolution from an epoch on."""
    span = orbit.truth[orbit.truth["t"].between(epoch, epoch + REVOLUTION_S)]
    step = max(1, round(_STEP_S / float(np.diff(orbit.truth["t"].to_numpy()[:2])[0])))
    places = orbit.itrf(span.iloc[::step]) * KM
    return places.round(1)


def _earth() -> dict[str, Any]:
    longitude, latitude = np.meshgrid(np.radians(np.arange(0, 361, 10)), np.radians(np.arange(-90, 91, 10)))
    x, y, z = (part.round(1).tolist() for part in _sphere_points(longitude, latitude, 0.995))
    light = {"ambient": 1.0, "diffuse": 0.0, "specular": 0.0}
    look = {
        "showscale": False,
        "hoverinfo": "skip",
        "lighting": light,
        "colorscale": [[0, "#DDE6EC"], [1, "#DDE6EC"]],
    }
    return {"type": "surface", "name": EARTH, "x": x, "y": y, "z": z, **look}


def _land() -> dict[str, Any]:
    outlines = [np.vstack([outline, [np.nan, np.nan]]) for outline in ground_tracks.outlines()]
    longitude, latitude = np.radians(np.vstack(outlines)).T
    x, y, z = _sphere_points(longitude, latitude, 1.0)
    look = {"mode": "lines", "line": {"color": MUTED, "width": 1}, "hoverinfo": "skip", "showlegend": False}
    return {"type": "scatter3d", "name": "land", **_with_gaps(x, y, z), **look}


def _stations(stations: Sequence[Station]) -> dict[str, Any]:
    longitude, latitude = (
        np.array([getattr(station, name) for station in stations]) for name in ("longitude", "latitude")
    )
    x, y, z = (part.round(1).tolist() for part in _sphere_points(longitude, latitude, 1.02))
    names = [station.name.capitalize() for station in stations]
    look = {"mode": "markers+text", "marker": {"size": 4, "color": OBSERVED_COLOR}, "showlegend": False}
    return {"type": "scatter3d", "name": "stations", "x": x, "y": y, "z": z, "text": names, **look}


def _sphere_points(longitude: np.ndarray, latitude: np.ndarray, scale: float) -> tuple[np.ndarray, ...]:
    """Return x, y and z [km] on a sphere of `scale` Earth radii; angles in rad."""
    radius = scale * WGS84_A * KM
    return (
        radius * np.cos(latitude) * np.cos(longitude),
        radius * np.cos(latitude) * np.sin(longitude),
        radius * np.sin(latitude),
    )


def _with_gaps(*parts: np.ndarray) -> dict[str, list[float | None]]:
    """Return x, y and z with None where they have a gap, as JSON knows no NaN."""
    return {
        name: [None if np.isnan(value) else round(float(value), 1) for value in part]
        for name, part in zip("xyz", parts, strict=True)
    }


def _looks(models: Sequence[str]) -> list[dict[str, Any]]:
    """Return the looks of the moving traces; the last model is shown, the others wait in the legend."""
    path: dict[str, Any] = {
        "mode": "lines",
        "line": {"color": PREDICTED_COLOR, "width": 5},
        "showlegend": False,
    }
    start: dict[str, Any] = {"mode": "markers", "marker": {"size": 5, "color": RESIDUAL}, "showlegend": False}
    before: dict[str, Any] = {"mode": "lines+markers", "line": {"color": TRUE_COLOR}, "name": BEFORE}
    after: list[dict[str, Any]] = [
        {
            "mode": "lines+markers",
            "line": _line(place),
            "name": display_learner(name),
            "visible": True if k == len(models) - 1 else "legendonly",
        }
        for place, (k, name) in zip(reversed(range(len(models))), enumerate(models), strict=True)
    ]
    return [
        {"type": "scatter3d", "name": PATH, **path},
        {"type": "scatter3d", "name": START, **start},
        *({"type": "scatter", **look} for look in (before, *after)),
    ]


def _line(place: int) -> dict[str, str]:
    """Return a line that no other model's looks like."""
    return {"color": COLORS[place % len(COLORS)], "dash": DASHES[place // len(COLORS) % len(DASHES)]}


def _layout(evaluations: Mapping[str, pd.DataFrame], component: str, note: str) -> dict[str, Any]:
    first = next(iter(evaluations.values()))
    residuals = (table["residual"].abs() for table in evaluations.values())
    sizes = np.concatenate([first["true"].abs(), *residuals])
    low, high = np.log10(np.quantile(sizes[sizes > 0.0], [0.005, 1.0]))
    hidden, symbol = {"visible": False}, f"e<sub>{axis(component)}</sub>"
    return {
        "template": "simple_white",
        "title": {"text": "<br>".join([*note.split("; "), HOW]), "font": {"size": 14, "color": PUBLISHED}},
        "scene": {
            "domain": {"x": [0.0, 0.46], "y": [0.0, 1.0]},
            "aspectmode": "data",
            **dict.fromkeys(("xaxis", "yaxis", "zaxis"), hidden),
            "camera": {"eye": {"x": -0.2, "y": -1.1, "z": 0.8}},
        },
        "xaxis": {
            "domain": [0.56, 1.0],
            "range": [0.0, float(first["duration"].max() / DAY)],
            "title": {"text": "prediction duration [d]"},
        },
        "yaxis": {
            "type": "log",
            "range": [float(low), float(high) + 0.1],
            "title": {
                "text": f"{in_words(component)} |{symbol}| [{si_unit(component)}]".removesuffix(" [m]")
            },
            "showgrid": True,
            **_ticks(component),
        },
        "legend": {"x": 0.56, "xanchor": "left", "y": -0.18, "yanchor": "top", "orientation": "h"},
        "margin": {"t": 90, "l": 10, "r": 20},
        "height": 640,
    }


def _ticks(component: str) -> dict[str, Any]:
    """Return marks at powers of ten on an axis of sizes, as 100 m and 10 km where it is one of lengths."""
    sizes = [10.0**power for power in range(-4, 8)]
    is_length = si_unit(component) == "m"
    return {"tickvals": sizes, "ticktext": [metres(size) if is_length else f"{size:g}" for size in sizes]}


def _labels(t: pd.Series, epoch: str) -> list[str]:
    start = datetime.fromisoformat(epoch)
    return [f"{one / DAY:.2f}, {start + timedelta(seconds=one):%Y-%m-%d %H:%M} UTC" for one in t]


def _slider(
    labels: Sequence[str], moving: Sequence[Sequence[Mapping[str, Any]]], indices: Sequence[int]
) -> dict[str, Any]:
    """Return a slider with a step per estimate, which gives the traces of `indices` their coordinates."""
    steps = [
        {
            "label": label,
            "method": "restyle",
            "args": [_columns(traces), list(indices)],
        }
        for label, traces in zip(labels, moving, strict=True)
    ]
    current = {"prefix": "estimate at day ", "font": {"size": 14, "color": TRUE_COLOR}}
    return {
        "steps": steps,
        "currentvalue": current,
        "font": {"color": "rgba(0, 0, 0, 0)"},  # of the steps: too long to stand below a slider
        "pad": {"t": 50},
        "len": 0.46,
        "ticklen": 0,
        "minorticklen": 0,
    }


def _columns(traces: Sequence[Mapping[str, Any]]) -> dict[str, list[Any]]:
    """Return coordinates of several traces as a restyling takes them, an empty z for a trace without one."""
    return {name: [trace.get(name, []) for trace in traces] for name in "xyz"}
