"""The report's warning of fits that are of no use: ratios to such fits make any model look good."""

from collections.abc import Iterator, Mapping

import numpy as np
import pandas as pd

from opml.report import texts
from opml.report.document import Block
from opml.report.results import length

Dataset = tuple[str, str]  # RSO and station set

TITLE = "Unrealistic fits"

CD_BOUNDS = (0.0, 10.0)  # drag coefficients that a body may have
MOST_OUTSIDE = 0.05  # share of the estimates that may have others

MOST_SIGMA = 1.0
"""Largest median formal standard deviation of Cd: above it the tracks tell next to nothing of Cd."""

LONGER_HOURS = 48.0  # least window that is advised [h]


def symptoms(estimates: Mapping[Dataset, pd.DataFrame]) -> dict[Dataset, str]:
    """Return in words what is absurd about `estimates` tables, of those alone that are not sound."""
    symptoms_by_dataset = {
        dataset: _symptoms(table[table["converged"]]) for dataset, table in estimates.items()
    }
    return {dataset: words for dataset, words in symptoms_by_dataset.items() if words}


def section(absurd: Mapping[Dataset, str], window_hours: float) -> Iterator[Block]:
    """Yield the warning, nothing where the fits of every dataset are sound.

    absurd: `symptoms` by dataset
    window_hours: measurements before a track that its fit used
    """
    if not absurd:
        return
    yield f"## {TITLE}"
    for (rso, stations), words in absurd.items():
        yield f"**{rso}, {stations}.** {words}"
    longer = max(LONGER_HOURS, 2.0 * window_hours)
    yield from texts.blocks("absurd_fits.section", hours=window_hours, longer=longer)


def _symptoms(estimates: pd.DataFrame) -> str:
    cd, sigma = estimates["cd"], float(np.sqrt(estimates["cov_cd_cd"]).median())
    outside = float((~cd.between(*CD_BOUNDS)).mean())
    if not (outside > MOST_OUTSIDE or sigma > MOST_SIGMA):
        return ""
    extent = {"low": CD_BOUNDS[0], "high": CD_BOUNDS[1], "least": cd.min(), "most": cd.max()}
    shares = {"fits": len(cd), "outside": 100.0 * outside, "sigma": length(sigma)}
    return texts.sentences("absurd_fits.symptoms", **shares, **extent)
