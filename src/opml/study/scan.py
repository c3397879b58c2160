"""The combinations of readings that a study scans: the product of its axes."""

from itertools import product

from opml import naming
from opml.report.scan import Combination, Scan
from opml.study.experiments import fence_of
from opml.study.paper import Paper


def scan(paper: Paper) -> Scan:
    """Return what a study scans, the default reading first; without combinations where it asks for none."""
    default = Combination(paper.study.defaults["learner"])
    return Scan(
        list(dict.fromkeys([default, *_combinations(paper)])) if "scan" in paper.study else [],
        {headline.name: (headline.experiment, headline.published) for headline in paper.headlines},
        [claim for claim in paper.claims if claim.points],
    )


def _combinations(paper: Paper) -> list[Combination]:
    entry, own = paper.study.entry("scan"), paper.study.cleaning.previous
    axes = product(
        entry["learners"],
        entry.get("estimations", [{}]),
        entry.get("previous", [own]),
        entry.get("fences", ["dataset"]),
        entry.get("zscore", [False]),
    )
    return [
        Combination(
            learner,
            window=naming.fitted(**estimation),
            reading="" if previous == own else naming.READINGS[previous],
            fence=fence_of(fence),
            zscore=zscore,
        )
        for learner, estimation, previous, fence, zscore in axes
    ]
