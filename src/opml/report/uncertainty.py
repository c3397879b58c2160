"""Is the uncertainty true? Shares of later errors inside stated intervals and ellipsoids, as a section."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import pandas as pd

from opml.report.document import Block, Heading, Paragraph, Table
from opml.report.results import NONE, length
from opml.tables import ELLIPSOID, FIT

TITLE = "Is the uncertainty true?"

SHOWN = (0.5, 0.9, 0.99)
"""Levels whose shares are printed."""

MAIN = 0.9
"""The level whose widths are printed."""


def section(tables: Sequence[pd.DataFrame], *, train: str, test: str, without_past: str) -> Iterator[Block]:
    """The section on `calibration` tables, or the reason why there are none; empty if none was asked for."""
    if without_past:
        yield Heading(TITLE)
        yield Paragraph(f"Nothing was learned of it from the past. {without_past}.")
    if not tables:
        return
    yield Heading(TITLE)
    yield Paragraph(
        f"Shares [%] of the errors of {test} inside intervals and ellipsoids of 50, 90 and 99 %, as stated "
        f"after {train}. They come from what the same model, trained up to earlier days, left on the days "
        "behind them, and grow with the time since the training ended. Beside an interval stands half its "
        "width at 90 %, in brackets as a multiple of the size that 90 % of the errors stay below; beside the "
        "ellipsoid the squared Mahalanobis distance that 90 % stay below, 6.25 if the covariance is true. "
        "Positions are moved along their path by the correction of `e_y`. `fit` is the fits' own covariance, "
        "carried to the prediction as it is. `docs/uncertainty.md` explains."
    )
    calibration = pd.concat(tables, ignore_index=True)
    days = sorted(set(calibration["day"]))
    header = ["RSO", "stations", "model", "of", *(f"{day:g} d" for day in days)]
    yield Table(header, list(_rows(calibration, days)))


def _rows(calibration: pd.DataFrame, days: list[float]) -> Iterator[list[str]]:
    parts = ["target", "stations", "learner", "basis", "quantity"]
    for (rso, stations, learner, basis, quantity), rows in calibration.groupby(parts, sort=False):
        cells = {day: _cell(own.set_index("level").to_dict("index")) for day, own in rows.groupby("day")}
        model = "fit" if basis == FIT else f"`{learner}`"
        of = quantity if quantity == ELLIPSOID else f"`{quantity}`"
        yield [rso, stations, model, of, *(cells.get(day, NONE) for day in days)]


def _cell(by_level: Mapping[float, Mapping[str, Any]]) -> str:
    shares = " / ".join(f"{100.0 * by_level[level]['inside']:.0f}" for level in SHOWN)
    main = by_level[MAIN]
    if main["quantity"] == ELLIPSOID:
        return f"{shares}, {length(main['found'])}"
    return f"{shares}, {length(main['stated'])} m ({main['stated'] / main['found']:.2g})"
