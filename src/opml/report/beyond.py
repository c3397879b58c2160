"""The report on models against splits: P_ML of every model, also where no row can leak into the training.

P_ML stands with its 5th and 95th percentile over resampled estimates.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import pandas as pd

from opml.learning.models.contract import LearnerSettings
from opml.naming import Experiment
from opml.report import texts
from opml.report.document import Block
from opml.report.results import Results, percent
from opml.report.settings_tables import learner_table

_Key = tuple[str, str, str]
Pair = tuple[str, str]


@dataclass(frozen=True)
class BeyondReport:
    """Contents of the document."""

    splits: Mapping[_Key, Experiment]  # by station set, learner and split
    pairs: Mapping[str, Pair]  # training and test rows, by split
    transfers: Mapping[_Key, Experiment]  # by curve, learner and target
    published: Mapping[_Key, float]  # the paper's P_ML [%] by a key of splits or transfers
    learners: Mapping[str, LearnerSettings]  # settings by name


def document(report: BeyondReport, metrics: pd.DataFrame) -> list[Block]:
    """Return the whole document; metrics: rows of that table for every experiment."""
    results = Results(metrics)
    return [
        *texts.blocks("beyond.head"),
        *_splits(report, results),
        *_transfers(report, results),
        *learner_table({learner: report.learners[learner] for _, learner, _ in report.splits}),
    ]


def _splits(report: BeyondReport, results: Results) -> Iterator[Block]:
    for stations, experiments in _by_first(report.splits).items():
        first = next(iter(experiments))[0]
        columns = list(dict.fromkeys(split for _, split in experiments))
        estimates = [results.row(experiments[first, split])["estimates"] for split in columns]
        headers = [
            f"{split}: {', '.join(report.pairs[split])} ({count} estimates)"
            for split, count in zip(columns, estimates, strict=True)
        ]
        paper = [percent(report.published.get((stations, first, split))) for split in columns]
        rows = [["Peng & Bai, SVR", *paper]] + [
            [f"`{learner}`", *(results.p_ml_cell(experiments[learner, split]) for split in columns)]
            for learner in dict.fromkeys(learner for learner, _ in experiments)
        ]
        yield from texts.blocks("beyond.splits", rows, stations=stations, splits=texts.across(headers))


def _transfers(report: BeyondReport, results: Results) -> Iterator[Block]:
    for curve, experiments in _by_first(report.transfers).items():
        names = list(dict.fromkeys(learner for learner, _ in experiments))
        first = next(iter(experiments.values()))
        rows = [
            [
                f"`{target}`",
                percent(report.published.get((curve, names[0], target))),
                *(results.p_ml_cell(experiments[learner, target]) for learner in names),
            ]
            for target in dict.fromkeys(target for _, target in experiments)
        ]
        words = {"train": first.train, "rso": first.rso, "test": first.test, "curve": curve.replace("_", " ")}
        yield from texts.blocks(
            "beyond.transfers", rows, **words, names=texts.across(f"`{name}`" for name in names)
        )


def _by_first(experiments: Mapping[_Key, Experiment]) -> dict[str, dict[Pair, Experiment]]:
    """Return the experiments by the first part of their key, then by the rest of it."""
    groups: dict[str, dict[Pair, Experiment]] = {}
    for (first, *rest), experiment in experiments.items():
        groups.setdefault(first, {})[rest[0], rest[1]] = experiment
    return groups
