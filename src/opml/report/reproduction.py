"""The paper's numbers beside ours: spread, effect of what the paper leaves open, likeliest causes, counts.

Nothing here is tuned towards the paper, but for one column that says so: the fixed kernel scale was chosen so
that one number is met, and every other number of that column is then a prediction.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import pandas as pd

from opml.base.constants import DAY
from opml.naming import Experiment
from opml.report.claims import Claim, judged
from opml.report.document import Block, Heading, Paragraph, Table
from opml.report.doubts import DOUBTS
from opml.report.results import NONE, Results, extent_cell, percent

EXPLAINED = 0.5
"""Share of a difference that a run must remove to count as its likeliest cause."""


@dataclass(frozen=True)
class Headline:
    """A number that the paper states, the experiment that gives ours, and what it is held against."""

    name: str
    experiment: Experiment
    published: float
    over_splits: Sequence[Experiment]  # the same under other seeds of the split
    over_noise: Sequence[Experiment]  # and of the noise; empty where that was not run
    fixed: Experiment  # with the one fixed kernel scale
    alternatives: Sequence[tuple[str, Experiment]]  # each with what it changes


@dataclass(frozen=True)
class Reproduction:
    """What the document tells."""

    headlines: Sequence[Headline]
    readings: Mapping[str, Mapping[str, Experiment]]  # by the reading's text and the headline's name
    evaluations: Mapping[str, Experiment]
    scales: Mapping[Experiment, float]  # experiments with a fixed kernel scale each
    claims: Sequence[Claim]
    drawn: Mapping[str, Experiment]  # every number that is drawn, by figure and point
    rule: str  # of the kernel scale, by default
    fixed_scale: float
    calibrated: str  # the headline that the fixed scale was chosen to meet


@dataclass(frozen=True)
class Comparison:
    """A headline, our number, and the ranges of it over the seeds; all [%]."""

    headline: Headline
    ours: float
    over_splits: tuple[float, float]
    over_noise: tuple[float, float] | None
    fixed: float

    @property
    def difference(self) -> float:
        """Ours minus the paper's."""
        return self.ours - self.headline.published

    @property
    def inside(self) -> bool:
        """Whether the paper's number lies within what our seeds give."""
        ranges = [self.over_splits, *([self.over_noise] if self.over_noise else [])]
        low, high = min(one[0] for one in ranges), max(one[1] for one in ranges)
        return low <= self.headline.published <= high


def document(
    asked: Reproduction, metrics: pd.DataFrame, datasets: pd.DataFrame, scales: Mapping[str, float]
) -> list[Block]:
    """The whole document.

    `metrics`: rows of that table for every experiment that is asked for. `datasets`: as `counts` returns, one
    row per dataset. `scales`: the kernel scale by headline.
    """
    results = Results(metrics)
    comparisons = [compare(headline, results) for headline in asked.headlines]
    return [
        Heading("The paper's numbers and ours", 1),
        *_summary(comparisons, results),
        *_headlines(asked, comparisons, scales),
        *_causes(comparisons, results),
        *_readings(asked, results),
        *_kernel_scales(asked.scales, results),
        *_claims(asked.claims, results),
        *_drawn(asked.drawn, results),
        Heading("Tracks, pairs and kept rows"),
        Table(
            list(datasets.columns), [[str(cell) for cell in row] for row in datasets.itertuples(index=False)]
        ),
        Heading("Slips and doubts of the paper"),
        Table(["the paper", "here"], DOUBTS),
    ]


def compare(headline: Headline, results: Results) -> Comparison:
    """One headline's number with its ranges over the seeds."""
    return Comparison(
        headline,
        ours=results.p_ml(headline.experiment),
        over_splits=results.extent(headline.over_splits),
        over_noise=results.extent(headline.over_noise) if headline.over_noise else None,
        fixed=results.p_ml(headline.fixed),
    )


def likeliest_cause(comparison: Comparison, results: Results) -> tuple[str, Experiment, bool]:
    """The alternative that comes nearest to the paper: what it changes, its run, whether it explains much.

    It explains much where it removes at least the share EXPLAINED of the difference.
    """

    def left(found: tuple[str, Experiment]) -> float:
        return abs(results.p_ml(found[1]) - comparison.headline.published)

    nearest = min(comparison.headline.alternatives, key=left)
    return *nearest, left(nearest) <= (1.0 - EXPLAINED) * abs(comparison.difference)


def counts(
    dataset: pd.DataFrame, estimates: pd.DataFrame, *, name: str, days: Sequence[float]
) -> dict[str, Any]:
    """How many tracks, pairs and kept rows a dataset has, and why the others were dropped."""
    reasons = dataset["reason"].str.partition(":")[0].value_counts()
    return {
        "dataset": name,
        "tracks": len(estimates),
        "fits converged": int(estimates["converged"].sum()),
        "pairs": len(dataset),
        "kept": int(dataset["keep"].sum()),
        f"kept to day {days[1]:g}": int((dataset["keep"] & (dataset["t_j"] <= DAY * days[1])).sum()),
        "why dropped": "; ".join(f"{reason} {count}" for reason, count in reasons.items() if reason) or NONE,
    }


def _summary(comparisons: Sequence[Comparison], results: Results) -> list[Block]:
    rows = [
        [f"`{one.headline.name}`", percent(one.headline.published), percent(one.ours), _cause(one, results)]
        for one in comparisons
    ]
    return [
        Paragraph(
            "P_ML [%] is what the correction leaves of the summed absolute error: 0 is perfect, 100 no "
            "correction. The cause is the one reading of what the paper leaves open that comes nearest."
        ),
        Table(["number", "paper", "ours", "cause of the difference"], rows),
        Heading("Beside our seeds"),
    ]


def _cause(one: Comparison, results: Results) -> str:
    if one.inside:
        return "the seeds"
    text, run, explains = likeliest_cause(one, results)
    return f"{'' if explains else 'none found; the nearest: '}{text} ({percent(results.p_ml(run))})"


def _headlines(
    asked: Reproduction, comparisons: Sequence[Comparison], scales: Mapping[str, float]
) -> list[Block]:
    splits, noises = (
        max((len(getattr(one, kind)) for one in asked.headlines), default=0)
        for kind in ("over_splits", "over_noise")
    )
    header = ["number", "paper", "ours", "over split seeds", "over noise seeds", "ours - paper"]
    header += ["paper within our seeds", "our kernel scale s", f"s = {asked.fixed_scale:g}"]
    return [
        Paragraph(
            "'Ours' is the run with the paper's single seed and the default reading of what "
            f"it leaves open (kernel scale rule: {asked.rule}). The ranges are smallest and largest over "
            f"{splits} seeds of the splits and subsamples and over {noises} seeds of the measurement noise; "
            "a transfer to another RSO was not measured anew under other noise."
        ),
        Paragraph(
            "The last column is no reproduction but a test: its kernel scale, "
            f"{asked.fixed_scale:g} for every model, was chosen so that `{asked.calibrated}` alone is met. "
            "Every other number in it is then a prediction."
        ),
        Table(header, [_headline_row(one, scales, asked.calibrated) for one in comparisons]),
    ]


def _headline_row(one: Comparison, scales: Mapping[str, float], calibrated: str) -> list[str]:
    name = one.headline.name
    return [
        f"`{name}`",
        percent(one.headline.published),
        percent(one.ours),
        extent_cell(one.over_splits),
        extent_cell(one.over_noise),
        f"{one.difference:+.1f}",
        "yes" if one.inside else "no",
        f"{scales[name]:.2f}",
        percent(one.fixed) + (" (s chosen for it)" if name == calibrated else ""),
    ]


def _causes(comparisons: Sequence[Comparison], results: Results) -> list[Block]:
    rows = []
    for one in comparisons:
        if not one.inside:
            text, run, explains = likeliest_cause(one, results)
            verdict = "" if explains else "not explained by any reading run here; the nearest: "
            cells = [verdict + text, percent(results.p_ml(run)), f"`{run.path('metrics')}`"]
            rows.append([f"`{one.headline.name}`", f"{one.difference:+.1f}", *cells])
    return [
        Heading("Where we differ by more than the seeds do"),
        Paragraph(
            "For each number the run that comes nearest to the paper's, of all that change one reading of "
            "what the paper leaves open. It is named as the likeliest cause where it removes at least "
            f"{EXPLAINED:.0%} of the difference. What comes nearest need not be what the paper did."
        ),
        Table(["number", "ours - paper", "likeliest cause", "P_ML then", "run"], rows or [[NONE] * 5]),
    ]


def _readings(asked: Reproduction, results: Results) -> list[Block]:
    names = [name for name in asked.evaluations if any(name in of for of in asked.readings.values())]
    own = ["as the settings are", *(percent(results.p_ml(asked.evaluations[name])) for name in names)]
    rows = [
        [text, *(percent(results.p_ml(of[name])) if name in of else NONE for name in names)]
        for text, of in asked.readings.items()
    ]
    return [
        Heading("What the paper leaves open"),
        Paragraph("P_ML [%] with one reading changed at a time."),
        Table(["reading", *(f"`{name}`" for name in names)], [own, *rows]),
    ]


def _kernel_scales(scales: Mapping[Experiment, float], results: Results) -> list[Block]:
    found: dict[str, dict[float, float]] = {}
    for one, scale in scales.items():
        found.setdefault(f"{one.stations}, {one.train}, {one.test}", {})[scale] = results.p_ml(one)
    rows = [
        [f"{scale:g}", *(percent(of[scale]) for of in found.values())]
        for scale in dict.fromkeys(scales.values())
    ]
    return [
        Heading("The kernel scale"),
        Paragraph(
            "fitrsvm's own rule for the scale is not public, and it is the setting that matters most. P_ML "
            "[%] by scale; `figs/kernel_scale_sensitivity` draws it with the rules' scales marked."
        ),
        Table(["s", *found], rows),
    ]


def _claims(claims: Sequence[Claim], results: Results) -> list[Block]:
    told = [judged(claim, results) for claim in claims if claim.points]
    return [
        Heading("What the paper says in words"),
        Table(
            ["the paper", "ours, P_ML [%]", "holds"],
            [[said, ours, "yes" if holds else "no"] for said, ours, holds in told],
        ),
    ]


def _drawn(drawn: Mapping[str, Experiment], results: Results) -> list[Block]:
    rows = []
    for name, one in drawn.items():
        row = results.of(one)
        shares = [percent(row["p_ml"]), percent(100.0 * row["fraction_reduced"])]
        rows.append([name, *shares, str(row["rows"]), str(row["estimates"]), f"`{one.path('metrics')}`"])
    return [
        Heading("Every number that is drawn"),
        Table(["figure", "P_ML [%]", "points made better [%]", "rows", "estimates", "run"], rows),
    ]
