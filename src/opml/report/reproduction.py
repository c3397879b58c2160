"""The report on the reproduction: the paper's numbers and ours, their spread, and why they differ.

Nothing is tuned towards the paper but one column, which says so: its kernel scale was chosen to meet one
number, and every other number of the column is a prediction.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib.resources import files
from typing import Any

import pandas as pd

from opml.base.constants import DAY
from opml.naming import Experiment
from opml.report import texts
from opml.report.document import Block
from opml.report.paper_claims import Claim, judge_claim
from opml.report.results import NO_VALUE, Results, extent_cell, percent

EXPLAINED = 0.5  # share of a difference that a run must remove to count as its likeliest cause


@dataclass(frozen=True)
class Headline:
    """A number that the paper states, the experiment that gives ours, and the experiments to compare with."""

    name: str
    experiment: Experiment
    published: float
    over_splits: Sequence[Experiment]  # the same under other seeds of the split
    over_noise: Sequence[Experiment]  # the same under other seeds of the noise; may be empty
    fixed: Experiment  # with the one fixed kernel scale
    alternatives: Sequence[tuple[str, Experiment]]  # each with what it changes


@dataclass(frozen=True)
class Reproduction:
    """Contents of the document."""

    headlines: Sequence[Headline]
    readings: Mapping[str, Mapping[str, Experiment]]  # by the reading's text and the headline's name
    evaluations: Mapping[str, Experiment]
    claims: Sequence[Claim]
    drawn: Mapping[str, Experiment]  # every number that is drawn, by figure and point
    rule: str  # by which the default learner sets its kernel scale
    fixed_scale: float
    calibrated: str  # the headline that the fixed scale was chosen to meet


@dataclass(frozen=True)
class Comparison:
    """A headline, our number and its ranges over the seeds, all [%]."""

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
        low, high = min(low for low, _ in ranges), max(high for _, high in ranges)
        return low <= self.headline.published <= high


def document(
    reproduction: Reproduction, metrics: pd.DataFrame, datasets: pd.DataFrame, scales: Mapping[str, float]
) -> list[Block]:
    """Return the whole document.

    metrics: rows of that table for every experiment of the reproduction
    datasets: one row per dataset, as `counts` returns it
    scales: the kernel scale by headline
    """
    results = Results(metrics)
    comparisons = [compare(headline, results) for headline in reproduction.headlines]
    summary = [
        [_code(pair), percent(pair.headline.published), percent(pair.ours), _cause(pair, results)]
        for pair in comparisons
    ]
    causes = [_cause_row(pair, results) for pair in comparisons if not pair.inside] or [[NO_VALUE] * 5]
    judged = (judge_claim(claim, results) for claim in reproduction.claims if claim.points)
    counted = [[str(cell) for cell in row] for row in datasets.itertuples(index=False)]
    return [
        *texts.blocks("reproduction.summary", summary),
        *texts.blocks(
            "reproduction.headlines",
            [_headline_row(comparison, scales, reproduction.calibrated) for comparison in comparisons],
            rule=reproduction.rule,
            splits=max((len(headline.over_splits) for headline in reproduction.headlines), default=0),
            noises=max((len(headline.over_noise) for headline in reproduction.headlines), default=0),
            scale=reproduction.fixed_scale,
            calibrated=reproduction.calibrated,
        ),
        *texts.blocks("reproduction.causes", causes, explained=EXPLAINED),
        *_readings(reproduction, results),
        *texts.blocks(
            "reproduction.claims",
            [[says, numbers, "yes" if holds else "no"] for says, numbers, holds in judged],
        ),
        *_drawn_numbers(reproduction.drawn, results),
        *texts.blocks("reproduction.counts", counted, columns=texts.across(datasets.columns)),
        *texts.blocks("reproduction.open_points", open_points()),
    ]


def _code(comparison: Comparison) -> str:
    return f"`{comparison.headline.name}`"


def open_points() -> list[list[str]]:
    """Return slips and open points of the paper, each with how it is read here."""
    lines = (files("opml") / "data" / "open_points.tsv").read_text(encoding="utf-8").splitlines()
    return [line.split("\t") for line in lines[2:]]


def compare(headline: Headline, results: Results) -> Comparison:
    """Return one headline's number with its ranges over the seeds."""
    return Comparison(
        headline,
        ours=results.p_ml(headline.experiment),
        over_splits=results.extent(headline.over_splits),
        over_noise=results.extent(headline.over_noise) if headline.over_noise else None,
        fixed=results.p_ml(headline.fixed),
    )


def likeliest_cause(comparison: Comparison, results: Results) -> tuple[str, Experiment, bool]:
    """Return the alternative that comes nearest to the paper: what it changes, its run, whether it explains.

    It explains the difference where it removes at least the share EXPLAINED of it.
    """

    def distance(alternative: tuple[str, Experiment]) -> float:
        return abs(results.p_ml(alternative[1]) - comparison.headline.published)

    nearest = min(comparison.headline.alternatives, key=distance)
    return *nearest, distance(nearest) <= (1.0 - EXPLAINED) * abs(comparison.difference)


def counts(
    dataset: pd.DataFrame, estimates: pd.DataFrame, *, name: str, days: Sequence[float]
) -> dict[str, Any]:
    """Return how many tracks, pairs and kept rows a dataset has, and why rows were dropped.

    dataset, estimates: those tables
    name: of the dataset, as it is printed
    days: first and last day of the training; rows up to the last one are counted, too
    """
    reasons = dataset["reason"].str.partition(":")[0].value_counts()
    return {
        "dataset": name,
        "tracks": len(estimates),
        "fits converged": int(estimates["converged"].sum()),
        "pairs": len(dataset),
        "kept": int(dataset["keep"].sum()),
        f"kept to day {days[1]:g}": int((dataset["keep"] & (dataset["t_j"] <= DAY * days[1])).sum()),
        "why dropped": "; ".join(f"{reason} {count}" for reason, count in reasons.items() if reason)
        or NO_VALUE,
    }


def _cause(comparison: Comparison, results: Results) -> str:
    if comparison.inside:
        return "the seeds"
    text, run, explains = likeliest_cause(comparison, results)
    return f"{'' if explains else 'none found; the nearest: '}{text} ({percent(results.p_ml(run))})"


def _headline_row(comparison: Comparison, scales: Mapping[str, float], calibrated: str) -> list[str]:
    name = comparison.headline.name
    return [
        _code(comparison),
        percent(comparison.headline.published),
        percent(comparison.ours),
        extent_cell(comparison.over_splits),
        extent_cell(comparison.over_noise),
        f"{comparison.difference:+.1f}",
        "yes" if comparison.inside else "no",
        f"{scales[name]:.2f}",
        percent(comparison.fixed) + (" (s chosen for it)" if name == calibrated else ""),
    ]


def _cause_row(comparison: Comparison, results: Results) -> list[str]:
    text, run, explains = likeliest_cause(comparison, results)
    verdict = "" if explains else "not explained by any interpretation run here; the nearest: "
    cells = [verdict + text, percent(results.p_ml(run)), f"`{run.path('metrics')}`"]
    return [_code(comparison), f"{comparison.difference:+.1f}", *cells]


def _readings(reproduction: Reproduction, results: Results) -> Iterator[Block]:
    shown = {name for experiments in reproduction.readings.values() for name in experiments}
    names = [name for name in reproduction.evaluations if name in shown]

    def row(text: str, experiments: Mapping[str, Experiment]) -> list[str]:
        cells = (
            percent(results.p_ml(experiments[name])) if name in experiments else NO_VALUE for name in names
        )
        return [text, *cells]

    rows = [row("as the settings are", reproduction.evaluations)]
    rows += [row(text, experiments) for text, experiments in reproduction.readings.items()]
    return texts.blocks("reproduction.readings", rows, names=texts.across(f"`{name}`" for name in names))


def _drawn_numbers(drawn: Mapping[str, Experiment], results: Results) -> Iterator[Block]:
    rows = []
    for name, experiment in drawn.items():
        row = results.row(experiment)
        shares = [percent(row["p_ml"]), percent(100.0 * row["fraction_reduced"])]
        counts = [str(row["rows"]), str(row["estimates"])]
        rows.append([name, *shares, *counts, f"`{experiment.path('metrics')}`"])
    return texts.blocks("reproduction.drawn", rows)
