"""The report's section on what was measured: residuals of each instrument, tracks held back, and burns."""

from collections.abc import Iterator, Mapping

import numpy as np
import pandas as pd

from opml.base.constants import DAY
from opml.interop import ccsds
from opml.report.document import Block, Heading, Paragraph, Table
from opml.report.mornings import Dataset
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
        yield Heading(TITLE)
    if known:
        yield from _residuals(known)
    if watched:
        yield from _suspects(watched, epoch)


def _residuals(noise: Mapping[Dataset, pd.DataFrame]) -> Iterator[Block]:
    """Yield what is left of each instrument's measurements."""
    rows = [
        [*dataset, row["instrument"], str(row["numbers"]), *_cells(row), f"{row['rms']:.2f}"]
        for dataset, table in noise.items()
        for row in table.to_dict("records")
    ]
    yield Paragraph(
        "Residuals, measured less predicted, of the newest fits that have no track in common. Where their "
        "rms is not about sigma, by which they were weighed, noise or forces are others than assumed. Where "
        "their mean is far from 0, the instrument may be off: `estimation: {bias_sigma: 3}` bears that."
    )
    yield Table(["RSO", "stations", "instrument", "numbers", "sigma", "rms", "mean", "rms / sigma"], rows)


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
    """Yield the tracks that were held back, and the burns that tracks showed."""
    for dataset, table in estimates.items():
        days = (table.loc[table["held_back"], "t"] / DAY).round(2).astype(str).tolist()
        named = ", ".join(days[:_MOST]) + (", ..." if len(days) > _MOST else "")
        where = f": on {'day' if len(days) == 1 else 'days'} {named}" if days else ""
        yield Paragraph(
            f"**{', '.join(dataset)}.** `estimation.suspect_sigma` held {len(days)} of {len(table)} tracks "
            f"back when they came{where}."
        )
    rows = [
        [*dataset, *_burn(row, epoch)]
        for dataset, table in estimates.items()
        for row in table[table[BURN[0]].notna()].to_dict("records")
    ]
    if rows:
        yield Paragraph("Burns that tracks showed, with the change of velocity [m/s]:")
        header = ["burn, UTC", "shown, UTC", "radial", "along the track", "across it"]
        yield Table(["RSO", "stations", *header], rows)


def _burn(row: Mapping[str, float], epoch: str) -> list[str]:
    """Return the cells of a burn in a row of estimates."""
    times = ccsds.utc_texts(epoch, np.array([row[BURN[0]], row["t"]]))
    sizes = [f"{row[name]:+.4f}" if np.isfinite(row[name]) else NO_VALUE for name in BURN[1:]]
    return [*(time[:16] for time in times), *sizes]
