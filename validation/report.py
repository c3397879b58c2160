"""docs/tables/orekit.md: the words of report.md with the numbers of a run."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import erfa
import numpy as np
import pandas as pd

from validation import estimation, steps, trajectories
from validation.case import OREKITS_CONVERGED, OURS_CONVERGED, PRECISE, Case
from validation.terms import Difference

_WGS84 = 1
_EDGE_BOUND, _LIGHT_BOUND = 1.0, 1e-7


@dataclass(frozen=True)
class Results:
    """What the parts of the comparison found."""

    places: np.ndarray  # (n, 3) in ITRF [m], of the terms
    differences: Sequence[Difference]
    edges: pd.DataFrame
    light: pd.DataFrame
    our_orbits: pd.DataFrame
    orekit_orbits: pd.DataFrame
    de440_orbits: pd.DataFrame
    fits: pd.DataFrame
    fits_made: int
    effect: pd.DataFrame


def markdown(case: Case, results: Results, *, orekit: str, kernel: str) -> str:
    """Return the report as Markdown.

    orekit: version of Orekit
    kernel: name of the ephemerides that both sides read
    """
    steps_error = {
        "opml": trajectories.moved(results.our_orbits, trajectories.PAPER),
        "Orekit": trajectories.moved(results.orekit_orbits, trajectories.PAPER),
    }
    altitudes = erfa.gc2gd(_WGS84, results.places)[2] / 1e3
    effect = results.effect
    errors, changes = effect["paper"].abs(), (effect["fine"] - effect["paper"]).abs()
    words = Path(__file__).with_name("report.md").read_text(encoding="utf-8")
    return words.format(
        orekit=orekit,
        kernel=kernel,
        epoch=case.epoch,
        days=case.values["duration_days"],
        ours_converged=_settings(OURS_CONVERGED),
        orekits_converged=_settings(OREKITS_CONVERGED),
        states=len(results.places),
        lowest=altitudes.min(),
        highest=altitudes.max(),
        terms=_terms(results.differences),
        shaded=", ".join(f"`{rso}`" for rso in results.edges["rso"].unique()),
        shadow=_shadow(results.edges, results.light),
        precise=PRECISE,
        orbits=_orbits(results.our_orbits, results.orekit_orbits, results.de440_orbits),
        integrators=_integrators(steps_error),
        converged=_converged(results.our_orbits, results.orekit_orbits),
        checked=trajectories.CHECKED,
        rso=estimation.RSO,
        pairs=len(effect),
        prediction_days=case.values["prediction"]["max_days"],
        fine=f"{steps.FINE.max_step_s:g}",
        error=errors.median(),
        change=changes.median(),
        change_most=np.percentile(changes, 95),
        share=steps.share(effect),
        fits_made=results.fits_made,
        fits_both=len(results.fits),
        fit_days=f"{estimation.DAYS:g}",
        fits=_fits(results.fits),
        sides=_sides(results.fits),
    )


def _settings(integrator):
    return f"{integrator.position_tolerance_m:g} m, at most {integrator.max_step_s:g} s"


def _table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    lines = [heads, ["---"] * len(heads), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def _met(value: float, bound: float) -> str:
    return "yes" if value <= bound else "**no**"


def _terms(differences):
    rows = [
        [
            d.term,
            _with_unit(d.largest, ".1e", d.unit),
            _with_unit(d.median, ".1e", d.unit),
            _with_unit(d.bound, ".0e", d.unit),
            _met(d.largest, d.bound),
        ]
        for d in differences
    ]
    return _table(["term", "largest", "median", "bound", "met"], rows)


def _with_unit(value: float, form: str, unit: str) -> str:
    return f"{value:{form}} {unit}".strip() if value else "0"


def _shadow(edges, light):
    apart = (edges["t_ours"] - edges["t_orekit"]).abs()
    rows = [
        [f"edge of {name}", str(len(part)), f"{apart[part.index].max() * 1e3:.1f} ms", f"{_EDGE_BOUND:g} s",
         _met(apart[part.index].max(), _EDGE_BOUND)]
        for name, part in edges.groupby("edge", sort=False)
    ]  # fmt: skip
    within = light[(light["lit_orekit"] > 0.0) & (light["lit_orekit"] < 1.0)]
    relative = ((within["lit_ours"] - within["lit_orekit"]) / within["lit_orekit"]).abs().max()
    rows.append(
        ["radiation pressure in the penumbra, relative", str(len(within)), f"{relative:.1e}",
         f"{_LIGHT_BOUND:.0e}", _met(relative, _LIGHT_BOUND)]
    )  # fmt: skip
    outside = light.drop(within.index)
    wrong = int((outside["lit_ours"] != outside["lit_orekit"]).sum())
    rows.append(["light a second outside it", str(len(outside)), f"{wrong} differ", "0", _met(wrong, 0)])
    return _table(["what", "cases", "largest difference", "bound", "met"], rows)


def _orbits(mine, theirs, with_de440):
    keys = trajectories.KEYS
    apart = trajectories.apart(mine, theirs, keys).xs(trajectories.CONVERGED, level="integrator")
    kernel = trajectories.apart(mine, with_de440, keys).xs(trajectories.CONVERGED, level="integrator")
    rows = []
    for rso in mine["rso"].unique():
        cells = [apart[rso, bound.model, bound.day] for bound in trajectories.BOUNDS]
        de440 = [kernel[rso, bound.model, bound.day] for bound in trajectories.BOUNDS]
        rows.append([rso, *(f"{value:.3f}" for value in cells), *(f"{value:.4f}" for value in de440)])
    heads = [f"{bound.model}, {bound.day} days" for bound in trajectories.BOUNDS]
    worst = [max(apart[:, bound.model, bound.day]) for bound in trajectories.BOUNDS]
    blank = [""] * len(trajectories.BOUNDS)
    rows.append(["bound", *(f"{bound.metres:g}" for bound in trajectories.BOUNDS), *blank])
    met = [_met(value, bound.metres) for value, bound in zip(worst, trajectories.BOUNDS, strict=True)]
    rows.append(["met", *met, *blank])
    return _table(["RSO", *heads, *(f"DE440: {head}" for head in heads)], rows)


def _converged(mine, theirs):
    ours = trajectories.moved(mine, trajectories.HALVED)
    orekits = trajectories.moved(theirs, trajectories.HALVED)
    spans = [(bound.model, bound.day) for bound in trajectories.BOUNDS]
    sides = [("opml", rso, ours) for rso in ours.index.unique(level="rso")]
    sides.append(("Orekit", trajectories.CHECKED, orekits))
    rows = [
        [side, rso, *(f"{moved[rso, model, day]:.4f}" for model, day in spans)] for side, rso, moved in sides
    ]
    return _table(["side", "RSO", *(f"{model}, {day} days" for model, day in spans)], rows)


def _integrators(steps_error):
    index = steps_error["opml"].index
    spans = [(bound.model, bound.day) for bound in trajectories.BOUNDS]
    rows = [
        [rso, *(f"{side[rso, model, day]:.3g}" for model, day in spans for side in steps_error.values())]
        for rso in index.unique(level="rso")
    ]
    return _table(
        ["RSO", *(f"{model}, {day} days, {side}" for model, day in spans for side in steps_error)], rows
    )


def _fits(fits):
    rows = []
    for what, unit, bound in (("position", "m", 0.5), ("velocity", "m/s", None), ("cd", "", 1e-3)):
        largest, median = fits[what].max(), fits[what].median()
        cells = [_with_unit(largest, ".1e", unit), _with_unit(median, ".1e", unit)]
        limits = ["", ""] if bound is None else [_with_unit(bound, "g", unit), _met(largest, bound)]
        rows.append([what, *cells, *limits])
    return _table(["what", "largest difference", "median", "bound", "met"], rows)


def _sides(fits):
    percents = [5, 50, 95]
    rows = [
        [
            side,
            *(f"{value:.2f}" for value in np.percentile(fits[f"error_{side.lower()}"], percents)),
            *(f"{value:.4f}" for value in np.percentile(fits[f"cd_{side.lower()}"], percents)),
        ]
        for side in ("opml", "Orekit")
    ]
    heads = [f"{what}, {percent} %" for what in ("error [m]", "Cd") for percent in percents]
    return _table(["side", *heads], rows)
