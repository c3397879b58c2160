"""The report's section on what was measured: residuals of each instrument, tracks held back, and burns."""

from collections.abc import Iterator, Mapping

import numpy as np
import pandas as pd

from opml.base.constants import DAY
from opml.interop import ccsds
from opml.report import texts
from opml.report.absurd_fits import Dataset
from opml.report.document import Block
from opml.report.results import NO_VALUE
from opml.tables import BURN

TITLE = "Measurement residuals"

_MOST = 12  # tracks that are named at most


def section(
    noise: Mapping[Dataset, pd.DataFrame], estimates: Mapping[Dataset, pd.DataFrame], *, epoch: str
) -> Iterator[Block]:
    """Yield the section, nothing where all was simulated and no track was watched.

    noise: of `biases.instrument_residuals`, empty of what was simulated
    epoch: UTC text from which times of `estimates` count
    """
    known = {dataset: table for dataset, table in noise.items() if not table.empty}
    watched = {dataset: table for dataset, table in estimates.items() if "held_back" in table}
    if known or watched:
        yield f"## {TITLE}"
    if known:
        yield from _residuals(known)
    if watched:
        yield from _suspects(watched, epoch)


def _residuals(noise: Mapping[Dataset, pd.DataFrame]) -> Iterator[Block]:
    rows = [
        [*dataset, row["instrument"], str(row["numbers"]), *_cells(row), f"{row['rms']:.2f}"]
        for dataset, table in noise.items()
        for row in table.to_dict("records")
    ]
    yield from texts.blocks("measurement_residuals.residuals", rows)


def _cells(row: Mapping[str, float]) -> list[str]:
    """Return sigma, rms and mean of an instrument in its unit."""
    unit, scale = _unit(str(row["instrument"]), row["sigma"])
    values = (row["sigma"], row["rms"] * row["sigma"], row["mean"] * row["sigma"])
    return [f"{scale * value:.3g} {unit}" for value in values]


def _unit(instrument: str, sigma: float) -> tuple[str, float]:
    """Return a unit that suits an instrument, and its part of rad, m or m/s."""
    from opml.catalog.simulate.observing import ANGLES  # loads the kernels, too long for a plan

    observable = instrument.split()[-1]
    if observable in ANGLES:
        return "deg", float(np.degrees(1.0))
    if observable.endswith("rate"):
        return "m/s", 1.0
    return ("m", 1.0) if sigma >= 1.0 else ("cm", 100.0)


def _suspects(estimates: Mapping[Dataset, pd.DataFrame], epoch: str) -> Iterator[Block]:
    for dataset, table in estimates.items():
        days = (table.loc[table["held_back"], "t"] / DAY).round(2).astype(str).tolist()
        named = ", ".join(days[:_MOST]) + (", ..." if len(days) > _MOST else "")
        where = f": on {'day' if len(days) == 1 else 'days'} {named}" if days else ""
        counts = {"held": len(days), "tracks": len(table)}
        yield from texts.blocks(
            "measurement_residuals.suspects", dataset=", ".join(dataset), where=where, **counts
        )
    rows = [
        [*dataset, *_burn(row, epoch)]
        for dataset, table in estimates.items()
        for row in table[table[BURN[0]].notna()].to_dict("records")
    ]
    if rows:
        yield from texts.blocks("measurement_residuals.burns", rows)


def _burn(row: Mapping[str, float], epoch: str) -> list[str]:
    times = ccsds.utc_texts(epoch, np.array([row[BURN[0]], row["t"]]))
    sizes = [f"{row[name]:+.4f}" if np.isfinite(row[name]) else NO_VALUE for name in BURN[1:]]
    return [*(time[:16] for time in times), *sizes]
