"""The combinations of readings that a study scans: the products of axes, one product after the other."""

from collections.abc import Iterator, Mapping
from itertools import product
from typing import Any

from opml import naming
from opml.readings.scan_report import Combination, Scan
from opml.study.experiments import fence_of
from opml.study.paper import Paper


def scan(paper: Paper) -> Scan:
    """Return what a study scans, the default reading first; no combinations where it asks for no scan."""
    default = Combination(paper.study.defaults["learner"])
    products = paper.study.entry("scan").values()
    previous = paper.study.cleaning.previous
    combinations = [combined for axes in products for combined in _combinations(axes, previous=previous)]
    return Scan(
        list(dict.fromkeys([default, *combinations])) if combinations else [],
        {headline.name: (headline.experiment, headline.published) for headline in paper.headlines},
        [claim for claim in paper.claims if claim.points],
    )


def _combinations(axes: Mapping[str, Any], *, previous: str) -> Iterator[Combination]:
    """Yield the product of axes; previous: the reading of t_b that is the default of the study."""
    for learner, estimation, reading, fence, standardisation in product(
        axes["learners"],
        axes.get("estimations", [{}]),
        axes.get("previous", [previous]),
        axes.get("fences", ["dataset"]),
        axes.get("standardisations", ["training"]),
    ):
        yield Combination(
            learner,
            window=naming.fit_suffix(**estimation),
            reading="" if reading == previous else naming.READINGS[reading],
            fence=fence_of(fence),
            standardisation=standardisation,
        )
