"""The pictures of real satellites, from tables of the pages.

    python -m validation.pictures.real_satellites

They are `swarm` and `satellites` of docs/reality.md, and `ellipsoids` of docs/uncertainty.md.
"""

import re
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, NullLocator

from opml.figures import style
from opml.figures.ticks import metres, rounded
from opml.orbits.rsw_covariance import half_width
from validation.case import ROOT
from validation.pictures import shrunk
from validation.pictures.page_tables import rows

BEFORE, LEARNED, SELECTED = "12-hour fit", "best that learned", "selected, no learning"
LOOKS = {
    BEFORE: (style.TRUE_COLOR, "o"),
    LEARNED: (style.ESTIMATE, "D"),
    SELECTED: (style.RESIDUAL, "^"),
}
HEIGHTS_KM = {"Swarm A": 430, "Larets": 690, "Sentinel-3A": 800, "LAGEOS-2": 5700}
MORNINGS = 19
"""Of Swarm A's replay; the others have as many, or fewer."""

LEVEL = 0.9

Errors = Mapping[float, tuple[float, float]]
"""Median and 95th percentile of |e_y| [m] by lead time [d]."""


class Satellite(NamedTuple):
    """Errors of a satellite's predictions by what corrected them, and how many predictions there are."""

    errors: Mapping[str, Errors]
    predictions: int


def _kind(cell: str) -> str:
    """Return what the first cell of a row is about, '' for another model."""
    words = {BEFORE: "no correction", LEARNED: "that learned", SELECTED: r"selected ev|selected each|chosen"}
    return next((kind for kind, text in words.items() if re.search(text, cell)), "")


def _errors(heads: Sequence[str], cells: Sequence[str]) -> Errors:
    """Return the errors of a row; heads: of its columns, with the lead times."""
    leads = [float(re.search(r"(\d+) d", head)[1]) for head in heads]
    sizes = [tuple(map(float, cell.split("/"))) for cell in cells]
    return dict(zip(leads, sizes, strict=True))


def satellites() -> dict[str, Satellite]:
    """Return the satellites of docs/reality.md and notes/reality.md by name."""
    columns = {
        "Swarm A": ("docs/reality", "## Swarm A", slice(1, 4)),
        "Larets": ("docs/reality", "## Larets", slice(1, 4)),
        "Sentinel-3A": ("notes/reality", "## Sentinel-3A and LAGEOS-2", slice(1, 4)),
        "LAGEOS-2": ("notes/reality", "## Sentinel-3A and LAGEOS-2", slice(5, 7)),
    }
    found = {}
    for name, (page, heading, part) in columns.items():
        heads, _, *table = rows(page, heading)[: 14 if page.startswith("docs") else 8]
        errors = {_kind(row[0]): _errors(heads[part], row[part]) for row in table if _kind(row[0])}
        text = " ".join((ROOT / f"{page}.md").read_text("utf-8").partition(f"\n{heading}\n")[2].split())
        counts = re.findall(r"(\d[\d ]*) predictions", text)
        found[name] = Satellite(errors, int(counts[int(part.start > 1)].replace(" ", "")))
    return found


def hindsight() -> dict[str, Errors]:
    """Return the errors of Swarm A's mornings with what only hindsight knows, by what that is."""
    heads, _, *table = rows("notes/reality", "## Swarm A: what hindsight would gain")
    kinds = ("state, Cd of the month", "state, Cd of each week")
    names = [name for kind in kinds for name in (kind, f"{kind}, weather")]
    return {name: _errors(heads[1:], row[1:]) for name, row in zip(names, table, strict=True)}


def overview(found: Mapping[str, Satellite]) -> Figure:
    """Draw medians of |e_y| by lead time and their 95th percentiles, a panel for each satellite."""
    figure = style.page_figure(height_mm=82.0)
    panels = figure.subplots(1, len(found), sharey=True)
    for axes, (name, satellite) in zip(panels, found.items(), strict=True):
        for aside, (kind, errors) in zip((-0.12, 0.0, 0.12), satellite.errors.items(), strict=True):
            color, marker = LOOKS[kind]
            leads = np.array(list(errors))
            median, most = np.array(list(errors.values())).T
            axes.plot(leads + aside, median, color=color, marker=marker, ms=4.0, label=kind)
            axes.vlines(leads + aside, median, most, color=color, lw=0.8)
        title = f"{name}, {HEIGHTS_KM[name]} km\n{satellite.predictions} predictions"
        axes.set_title(title, fontsize=8.0, loc="left")
        axes.set(yscale="log", xlim=(0.5, 7.5), xlabel="lead time [d]")
        axes.set_xticks([1, 4, 7])
    panels[0].set_ylabel("along-track error")
    panels[0].yaxis.set_major_formatter(FuncFormatter(metres))
    panels[-1].legend(loc="upper right", fontsize=style.NOTE_SIZE, handlelength=1.0, borderaxespad=0.0)
    headline = "On four satellites orbit determination removes most of the error, learning adds nothing"
    note = (
        "learning from the object's own past; tracks of three simulated radars, weather as forecast that "
        "day; marks: median, bars: up to the 95th percentile"
    )
    style.add_head(figure, headline, note)
    return figure


def ladder(satellite: Satellite, known: Mapping[str, Errors]) -> Figure:
    """Draw a row for each correction of a satellite, then for what hindsight would gain."""
    figure = style.page_figure(height_mm=86.0)
    axes = figure.add_subplot()
    table = {**satellite.errors, **{f"hindsight: {what}": errors for what, errors in known.items()}}
    for place, errors in enumerate(table.values()):
        for k, (lead, (median, most)) in enumerate(errors.items()):
            height, look = place + 0.2 * (k - 1), {"color": style.RAMP[k]}
            label = f"{lead:g} d" if place == 0 else None
            axes.plot(median, height, marker=style.MARKERS[k], ls="", ms=5.0, label=label, **look)
            axes.hlines(height, median, most, lw=0.9, **look)
    axes.set(xscale="log", xlabel="along-track error", ylim=(len(table) - 0.5, -0.5))
    axes.xaxis.set_major_formatter(FuncFormatter(metres))
    axes.set_yticks(range(len(table)), list(table))
    axes.yaxis.set_minor_locator(NullLocator())
    axes.axhline(len(satellite.errors) - 0.5, color=style.MUTED, lw=0.8, ls="--")
    axes.legend(title="lead time", loc="lower right", fontsize=style.NOTE_SIZE)
    week = {name: metres(rounded(list(errors.values())[-1][0])) for name, errors in table.items()}
    headline = (
        f"Swarm A after a week: {week[BEFORE]} by a 12-hour fit, {week[SELECTED]} by the model selected"
    )
    note = (
        f"September 2019, {MORNINGS} mornings, {satellite.predictions} predictions, weather as forecast that "
        "day; marks: median, bars: up to the 95th percentile"
    )
    style.add_head(figure, headline, note)
    return figure


def coverage() -> dict[str, dict[str, dict[float, float]]]:
    """Return the share [%] of errors inside the 90 % ellipsoids by case, model and lead time [d]."""
    heads, _, *table = rows("docs/uncertainty", "## Results")
    found: dict[str, dict[str, dict[float, float]]] = {}
    for case, model, *cells in table:
        shares = {
            float(head.removesuffix(" d")): float(cell.split(" %")[0])
            for head, cell in zip(heads[2:], cells, strict=True)
        }
        found.setdefault(case, {})[model] = shares
    return found


def ellipsoids(found: Mapping[str, Mapping[str, Mapping[float, float]]]) -> Figure:
    """Draw the share of errors inside the 90 % ellipsoids by lead time, a panel for each case."""
    figure = style.page_figure(height_mm=68.0)
    panels = figure.subplots(1, len(found), sharey=True)
    looks = {"selected each day": LOOKS[SELECTED], "no correction": LOOKS[BEFORE]}
    for axes, (case, models) in zip(panels, found.items(), strict=True):
        axes.axhline(100.0 * LEVEL, color=style.MUTED, ls="--", lw=1.0)
        for model, shares in models.items():
            color, marker = looks[model]
            leads = np.array(list(shares)) + (0.12 if model == "no correction" else -0.12)
            axes.plot(leads, list(shares.values()), color=color, marker=marker, ms=4.0, label=model)
            for place, (lead, share) in zip(leads, shares.items(), strict=True):
                axes.vlines(place, *interval(share, MORNINGS / lead), color=color, lw=0.8)
        axes.set_title(case.replace(", ", ",\n"), fontsize=8.0, loc="left")
        axes.set(xlabel="lead time [d]", xlim=(0.5, 7.5), ylim=(20.0, 102.0))
        axes.set_xticks([1, 3, 5, 7])
    panels[0].set_ylabel("errors inside the 90 % ellipsoid [%]")
    panels[0].legend(loc="lower left", fontsize=style.NOTE_SIZE)
    *quiet, storm = ([min(shares.values()), max(shares.values())] for shares in _selected(found))
    low, high = min(map(min, quiet)), max(map(max, quiet))
    inside, in_storm = f"{low:g} to {high:g} %", f"{storm[0]:g} to {storm[1]:g} %"
    headline = f"90 % ellipsoids contain {inside} of the errors, {in_storm} in a storm"
    note = (
        "positions, weather as forecast that day; bars: Wilson's 90 % interval, counting one independent "
        f"prediction per lead time in {MORNINGS} days"
    )
    style.add_head(figure, headline, note)
    return figure


def _selected(found: Mapping[str, Mapping[str, Mapping[float, float]]]) -> list[Mapping[float, float]]:
    return [models["selected each day"] for models in found.values()]


def interval(share: float, count: float) -> tuple[float, float]:
    """Return Wilson's 90 % interval [%] of a share [%] of `count` independent errors, a number or a part."""
    p, z = share / 100.0, half_width(0.9)
    middle, weight = p + z**2 / (2.0 * count), 1.0 + z**2 / count
    half = z * np.sqrt(p * (1.0 - p) / count + z**2 / (4.0 * count**2))
    return 100.0 * (middle - half) / weight, 100.0 * (middle + half) / weight


def main() -> None:
    """Draw the three pictures and shrink them."""
    found = satellites()
    drawn = {
        "swarm": ladder(found["Swarm A"], hindsight()),
        "satellites": overview(found),
        "ellipsoids": ellipsoids(coverage()),
    }
    for name, figure in drawn.items():
        shrunk.save(figure, name)


if __name__ == "__main__":
    main()
