"""Models against splits: what the paper's measure says of each, and what it says where nothing can leak.

P_ML stands with its 5th and 95th percentile over resampled estimates.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import pandas as pd

from opml.learning.models import learners
from opml.naming import Experiment
from opml.report.document import Block, Heading, Paragraph, Table
from opml.report.results import NONE, Results, percent

Key = tuple[str, str, str]


@dataclass(frozen=True)
class BeyondReport:
    """What the document tells."""

    splits: Mapping[Key, Experiment]  # by station set, learner and split
    pairs: Mapping[str, tuple[str, str]]  # training and test rows, by split
    transfers: Mapping[Key, Experiment]  # by curve, learner and target
    left_out: Mapping[Key, Experiment]  # by pool, learner and the RSO left out
    budget: Mapping[tuple[str, str], Experiment]  # by station set and learner
    budget_split: tuple[str, str]
    published: Mapping[Key, float]  # the paper's P_ML [%] by a key of splits or transfers
    learners: Mapping[str, Mapping[str, Any]]  # settings by name
    level: float  # of the prediction intervals


def document(
    asked: BeyondReport, metrics: pd.DataFrame, coverage: pd.DataFrame, floors: Mapping[str, float]
) -> list[Block]:
    """The whole document.

    `metrics`, `coverage`: rows of those tables for every experiment and for every one with intervals.
    `floors`: by station set, the size of the assumed model's own error [%].
    """
    results = Results(metrics)
    names = {pair: split for split, pair in asked.pairs.items()}
    return [
        Heading("Does it generalise?", 1),
        Paragraph(
            "P_ML [%] is what a correction leaves of the summed absolute error: 0 is perfect, 100 no "
            "correction. In brackets its 5th and 95th percentile over resampled estimates, as the rows of "
            "one estimate are no independent evidence. `docs/beyond.md` explains models and splits."
        ),
        *_splits(asked, results),
        *_transfers(asked, results),
        *_left_out(asked.left_out, results),
        *_intervals(coverage, names, asked.level),
        *_budget(asked, results, floors),
        *model_table({name: asked.learners[name] for _, name, _ in asked.splits}),
    ]


def _splits(asked: BeyondReport, results: Results) -> Iterator[Block]:
    for stations in _firsts(asked.splits):
        own = {key[1:]: one for key, one in asked.splits.items() if key[0] == stations}
        first = next(iter(own))[0]
        columns = list(dict.fromkeys(split for _, split in own))
        estimates = [results.of(own[first, split])["estimates"] for split in columns]
        headers = [
            f"{split}: {', '.join(asked.pairs[split])} ({count} estimates)"
            for split, count in zip(columns, estimates, strict=True)
        ]
        paper = [percent(asked.published.get((stations, first, split))) for split in columns]
        yield Heading(f"Models against splits: {stations}")
        yield Table(["model", *headers], [["Peng & Bai, SVR", *paper], *model_rows(own, results)])


def model_rows(found: Mapping[tuple[str, str], Experiment], results: Results) -> list[list[str]]:
    """Rows of P_ML, one per model: experiments by learner and by what stands in the columns."""
    learners_ = dict.fromkeys(learner for learner, _ in found)
    columns = dict.fromkeys(column for _, column in found)
    return [
        [f"`{learner}`", *(results.with_interval(found[learner, column]) for column in columns)]
        for learner in learners_
    ]


def _transfers(asked: BeyondReport, results: Results) -> Iterator[Block]:
    for curve in _firsts(asked.transfers):
        own = {key[1:]: one for key, one in asked.transfers.items() if key[0] == curve}
        names = list(dict.fromkeys(learner for learner, _ in own))
        first = next(iter(own.values()))
        rows = [
            [
                f"`{target}`",
                percent(asked.published.get((curve, names[0], target))),
                *(results.with_interval(own[learner, target]) for learner in names),
            ]
            for target in dict.fromkeys(target for _, target in own)
        ]
        yield Heading(f"Trained on one RSO, applied to others: {curve.replace('_', ' ')}")
        yield Paragraph(f"Trained on {first.train} of {first.rso}, tested on {first.test} of each.")
        yield Table(["RSO", "Peng & Bai", *(f"`{learner}`" for learner in names)], rows)


def _left_out(found: Mapping[Key, Experiment], results: Results) -> Iterator[Block]:
    if not found:
        return
    names = list(dict.fromkeys(learner for _, learner, _ in found))
    first = next(iter(found.values()))
    rows = [
        [pool, f"`{rso}`", *(results.with_interval(found[pool, learner, rso]) for learner in names)]
        for pool, rso in dict.fromkeys((pool, rso) for pool, _, rso in found)
    ]
    yield Heading("One RSO left out")
    yield Paragraph(
        f"Trained on {first.train} of all other RSOs of a pool, tested on {first.test} of the one that "
        "was left out."
    )
    yield Table(["pool", "left out", *(f"`{learner}`" for learner in names)], rows)


def _intervals(coverage: pd.DataFrame, names: Mapping[tuple[str, str], str], level: float) -> Iterator[Block]:
    yield Heading("Prediction intervals")
    yield Paragraph(
        f"Split-conformal by estimate at {level:.0%}: what share of the rows lies "
        "inside, and its mean over estimates, which is what the level promises while estimates are alike. "
        "Lengths are medians in km (km/s for a velocity); the last day is that of the longest predictions."
    )
    header = ["stations", "model", "split", "rows inside [%]", "by estimate [%]", "half width"]
    rows = [_interval_row(one, names) for one in coverage.to_dict("records")]
    yield Table([*header, "half width, last day", "error, last day"], rows)


def _interval_row(one: Mapping[str, Any], names: Mapping[tuple[str, str], str]) -> list[str]:
    lengths = (one[length] for length in ("half_width", "half_width_last_day", "error_last_day"))
    return [
        one["stations"],
        f"`{one['learner']}`",
        names[one["train"], one["test"]],
        percent(100.0 * one["rows_inside"]),
        percent(100.0 * one["estimates_inside"]),
        *(f"{1e-3 * length:.2f}" for length in lengths),
    ]


def _budget(asked: BeyondReport, results: Results, floors: Mapping[str, float]) -> Iterator[Block]:
    names = list(dict.fromkeys(learner for _, learner in asked.budget))
    rows = [
        [
            stations,
            *(results.with_interval(asked.budget[stations, name]) for name in names),
            percent(floors[stations]),
        ]
        for stations in dict.fromkeys(stations for stations, _ in asked.budget)
    ]
    yield Heading("What the error is made of")
    yield Paragraph(
        "P_ML on " + ", ".join(asked.budget_split) + " of laws that know more and more. Those that know an "
        "estimate's true error of semi-major axis (`drift`) or the assumed model's own (`floor`) are no "
        "correctors, as they need the truth. The last column is the size of the assumed model's own error, "
        "from the true state and Cd, in % of the whole: what no estimate, however good, goes below."
    )
    header = [f"`{name}`: {' '.join(_terms(asked.learners[name]))}" for name in names]
    yield Table(["stations", *header, "assumed model's own error [%]"], rows)


def model_table(models: Mapping[str, Mapping[str, Any]]) -> Iterator[Block]:
    """What each model is, from its settings, by name."""
    rows = [
        [f"`{name}`", learners.description(settings["kind"]), " ".join(_terms(settings)) or NONE]
        for name, settings in models.items()
    ]
    yield Heading("The models")
    yield Table(["model", "is", "terms"], rows)


def _terms(settings: Mapping[str, Any]) -> Sequence[str]:
    return [f"`{term}`" for term in settings.get("terms", [])]


def _firsts(found: Mapping[Key, Experiment]) -> list[str]:
    return list(dict.fromkeys(key[0] for key in found))
