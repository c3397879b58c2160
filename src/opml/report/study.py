"""A study's answer: models against splits, errors in metres before and after, rows used and dropped."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import pandas as pd

from opml.learning.cleaning import PAPER, PAPER_BOUNDS, PAPER_FENCE
from opml.learning.dataset import survives
from opml.learning.growth import at_days
from opml.learning.learners import learns
from opml.learning.metrics import p_ml
from opml.learning.rolling import by_day
from opml.naming import Experiment
from opml.report import uncertainty
from opml.report.document import Block, Heading, Paragraph, Table
from opml.report.generalisation import model_table
from opml.report.results import NONE, Results, length, percent
from opml.report.settings import assumed_model, force_models

Dataset = tuple[str, str]


@dataclass(frozen=True)
class Answer:
    """What the report tells."""

    experiments: Mapping[tuple[str, str, str, str], Experiment]  # by RSO, station set, model and split
    pairs: Mapping[str, tuple[str, str]]  # training and test rows, by split
    trials: Mapping[tuple[str, str, str, str], Experiment]  # the same within the days to train on
    past: Mapping[str, tuple[str, str]]  # their training and test rows, by split
    shown: str  # the split whose errors are stated in metres
    stated: Mapping[tuple[str, str, str], Experiment]  # its experiments by RSO, station set and model
    datasets: Sequence[Dataset]  # RSO and station set
    learners: Mapping[str, Mapping[str, Any]]  # settings by name
    component: str
    label: str  # truth, later or smoothed: what is learned from is held against it
    truth: bool  # whether any of the RSOs has a truth, or the tracks of all were really measured
    rolling: Sequence[tuple[str, str, str]]  # RSO, station set and learner, of learners that are trained anew
    trained_anew: Mapping[str, Any]  # on which days, how often, on how many days' labels [days]
    marks: Sequence[float]  # prediction durations that errors are stated at [days]
    without_past: str  # why no uncertainty was learned from the past, empty where it was
    settings: Mapping[str, Any]


def document(
    asked: Answer,
    metrics: pd.DataFrame,
    evaluations: Mapping[tuple[str, str, str], pd.DataFrame],
    datasets: Mapping[Dataset, pd.DataFrame],
    estimates: Mapping[Dataset, pd.DataFrame],
    rolling: Mapping[tuple[str, str, str], pd.DataFrame],
    calibration: Sequence[pd.DataFrame] = (),
) -> list[Block]:
    """The whole report.

    `metrics`: rows of that table for every experiment. `evaluations`: those tables of the stated experiments,
    by RSO, station set and model. `datasets`, `estimates`: those tables by RSO and station set. `rolling`:
    those of the learners that are trained anew, by RSO, station set and learner. `calibration`: those tables
    of every experiment whose uncertainty is tested.
    """
    train, test = asked.pairs[asked.shown]
    papers = {
        dataset: table.loc[survives(table, estimates[dataset], PAPER), ["i", "j"]]
        for dataset, table in datasets.items()
    }
    return [
        Heading("The study", 1),
        Paragraph(
            f"Predictions of {', '.join(dict.fromkeys(rso for rso, _ in asked.datasets))} from "
            f"{asked.settings['epoch']} UTC over {asked.settings['duration_days']:g} days, corrected in "
            f"`{asked.component}` by models that learned from earlier ones."
        ),
        *_splits(asked, Results(metrics)),
        *_chosen(asked, Results(metrics)),
        *_errors(asked, evaluations, papers),
        *_rolling(asked, rolling),
        *uncertainty.section(calibration, train=train, test=test, without_past=asked.without_past),
        *_rows(asked, datasets, estimates, papers),
        *model_table(asked.learners),
        *_forces(asked),
    ]


def _forces(asked: Answer) -> Iterator[Block]:
    yield Heading("Truth and assumed model" if asked.truth else "Assumed model")
    yield (force_models if asked.truth else assumed_model)(asked.settings)


def _splits(asked: Answer, results: Results) -> Iterator[Block]:
    rows = [
        [rso, stations, f"`{learner}`", *(results.with_interval(own[split]) for split in asked.pairs)]
        for rso, stations, learner, own in _by_model(asked)
    ]
    header = [f"{split}: {', '.join(pair)}" for split, pair in asked.pairs.items()]
    yield Heading("Models against splits")
    yield Paragraph(
        "P_ML [%] is what a correction leaves of the summed size of the errors: 0 is perfect, 100 no "
        "correction. In brackets its 5th and 95th percentile over resampled estimates, as the rows of one "
        "estimate are no independent evidence. `docs/generalisation.md` explains models and splits."
    )
    yield Table(["RSO", "stations", "model", *header], rows)
    if not asked.truth:
        yield Paragraph(
            f"No truth is known of these tracks. Errors, here and below, are each prediction less "
            f"{LATER[asked.label]}."
        )
    elif asked.label != "truth":
        yield from _held_against_labels(asked, results, header)


def _held_against_labels(asked: Answer, results: Results, header: Sequence[str]) -> Iterator[Block]:
    rows = [
        [rso, stations, f"`{learner}`", *(percent(results.of(one)["p_ml_later"]) for one in own.values())]
        for rso, stations, learner, own in _by_model(asked)
    ]
    yield Paragraph(
        f"The models learned from labels: each prediction less {LATER[asked.label]}, once that was known. "
        "P_ML above is against the truth, where there is one; here the same rows are held against such "
        "estimates, which is all that a catalogue has."
    )
    yield Table(["RSO", "stations", "model", *header], rows)


LATER = {
    "later": "the estimate that is made when the track predicted to is over",
    "smoothed": "an estimate from tracks on both sides of the time predicted to",
}
"""What a label is held against, in words."""


def _by_model(asked: Answer) -> Iterator[tuple[str, str, str, dict[str, Experiment]]]:
    for rso, stations, learner in dict.fromkeys(key[:3] for key in asked.experiments):
        yield (
            rso,
            stations,
            learner,
            {split: asked.experiments[rso, stations, learner, split] for split in asked.pairs},
        )


WORTH = 0.95
"""A model that learned is chosen where it leaves less than this part of what the best other one does."""


def _chosen(asked: Answer, results: Results) -> Iterator[Block]:
    """What the days to train on say of the models, and how that choice does on the days to test on."""
    if not asked.past:
        return
    rows = [
        [*dataset, split, *_choice(asked, results, dataset, split)]
        for dataset in asked.datasets
        for split in asked.past
    ]
    tried = "; ".join(f"{split}: {train}, {test}" for split, (train, test) in asked.past.items())
    yield Heading("The model that the past chooses")
    yield Paragraph(
        "Which model to use must be known before the days that it is tested on. So each is trained on the "
        f"first part of the days to train on and tested on the rest of them ({tried}). A model that learned "
        f"is chosen where it leaves less than {WORTH:g} of what the best one without learning leaves; else "
        "that one is. The last two columns know the outcome: the least P_ML of all models without learning, "
        "and of all models."
    )
    header = ["split", "chosen", "P_ML in the past", "P_ML", "best without learning", "best"]
    yield Table(["RSO", "stations", *header], rows)


def _choice(asked: Answer, results: Results, dataset: Dataset, split: str) -> list[str]:
    """Cells of the model that the past chooses for a dataset and a split."""
    past, later = (
        {name: results.p_ml(found[*dataset, name, split]) for name in asked.learners}
        for found in (asked.trials, asked.experiments)
    )
    fixed = [name for name in asked.learners if not learns(asked.learners[name])]
    chosen = choice(past, fixed)
    bests = [min(names, key=later.__getitem__) if names else None for names in (fixed, list(asked.learners))]
    named = [NONE if name is None else f"{later[name]:.1f} `{name}`" for name in bests]
    return [f"`{chosen}`", f"{past[chosen]:.1f}", f"{later[chosen]:.1f}", *named]


def choice(past: Mapping[str, float], fixed: Sequence[str]) -> str:
    """The model to use by P_ML on the past: one of the `fixed`, unless one that learned is worth it."""
    best = min(past, key=past.__getitem__)
    if not fixed:
        return best
    plain = min(fixed, key=past.__getitem__)
    return best if past[best] < WORTH * past[plain] else plain


def _errors(
    asked: Answer,
    evaluations: Mapping[tuple[str, str, str], pd.DataFrame],
    papers: Mapping[Dataset, pd.DataFrame],
) -> Iterator[Block]:
    """Errors in metres; `papers`: i and j of the rows that the paper's cleaning would keep."""
    unit = "m/s" if asked.component.startswith("e_v") else "m"
    growth = {key: at_days(table, asked.marks) for key, table in evaluations.items()}
    days = list(dict.fromkeys(day for table in growth.values() for day in table.get("day", [])))
    rows = []
    for dataset in asked.datasets:
        own = {learner: growth[*dataset, learner] for *of, learner in asked.stated if tuple(of) == dataset}
        for k, (learner, table) in enumerate(own.items()):
            evaluation = evaluations[*dataset, learner]
            kept = evaluation.merge(papers[dataset], on=["i", "j"])
            if k == 0:
                whole = ["100.0", NONE if kept.empty else "100.0"]
                rows.append([*dataset, "no correction", *_sizes(table, days, "before"), *whole])
            left = _left(evaluation), _left(kept)
            rows.append([*dataset, f"`{learner}`", *_sizes(table, days, "after"), *left])
    train, test = asked.pairs[asked.shown]
    yield Heading(f"Errors before and after, {asked.shown}")
    low, high = PAPER_BOUNDS
    yield Paragraph(
        f"Size of `{asked.component}` [{unit}] near some prediction durations: median / 95th percentile. "
        f"Trained on {train}, tested on {test}. P_ML [%] of all rows, and of those that the paper's cleaning "
        f"would keep: Cd from {low:g} to {high:g}, e_y inside Tukey's fences of {PAPER_FENCE:g} "
        "interquartile ranges."
    )
    header = [*(f"{day:g} d" for day in days), "P_ML", "P_ML, the paper's rows"]
    yield Table(["RSO", "stations", "model", *header], rows)


def _rolling(asked: Answer, tables: Mapping[tuple[str, str, str], pd.DataFrame]) -> Iterator[Block]:
    """Learners trained anew beside the same ones trained once."""
    if not tables:
        return
    rows = []
    for rso, stations, learner in asked.rolling:
        table = tables[rso, stations, learner]
        days, once = by_day(table), table.assign(predicted=table["predicted_once"])
        cells = [_left(table), _left(once), *(percent(days[name].max()) for name in ("anew", "once"))]
        rows.append([rso, stations, f"`{learner}`", *cells])
    (first, last), every, memory = (asked.trained_anew[key] for key in ("days", "every_days", "last_days"))
    yield Heading("Trained anew")
    yield Paragraph(
        f"As an operator would run it: trained every {every:g} days on what is known of the last {memory:g} "
        "days, and applied to the predictions that start until it is trained again, from day "
        f"{first:g} to {last:g}. Beside it the model of the first day, kept. P_ML [%] of all rows, and of "
        "the worst day."
    )
    header = ["anew", "once", "worst day, anew", "worst day, once"]
    yield Table(["RSO", "stations", "model", *header], rows)


def _left(evaluation: pd.DataFrame) -> str:
    """P_ML of an `evaluation` table, where it has rows."""
    if evaluation.empty:
        return NONE
    return f"{p_ml(evaluation['true'].to_numpy(), evaluation['predicted'].to_numpy()):.1f}"


def _sizes(table: pd.DataFrame, days: Sequence[float], when: str) -> list[str]:
    """Cells of the errors at the days; a day without rows has none."""
    rows = {row["day"]: row for row in table.to_dict("records")}
    return [
        " / ".join(length(rows[day][f"{when}_{share}"]) for share in (50, 95)) if day in rows else NONE
        for day in days
    ]


def _rows(
    asked: Answer,
    datasets: Mapping[Dataset, pd.DataFrame],
    estimates: Mapping[Dataset, pd.DataFrame],
    papers: Mapping[Dataset, pd.DataFrame],
) -> Iterator[Block]:
    header = [
        "RSO",
        "stations",
        "tracks",
        "fits converged",
        "predictions",
        "used",
        "the paper would keep",
        "why others are not",
    ]
    rows = []
    for dataset in asked.datasets:
        table, fits = datasets[dataset], estimates[dataset]
        shares = row_shares(table)
        used = shares.pop(USED)
        why = "; ".join(f"{reason} {100.0 * share:.1f} %" for reason, share in shares.items())
        counts = [str(len(fits)), str(int(fits["converged"].sum())), str(len(table))]
        kept = [f"{100.0 * share:.1f} %" for share in (used, len(papers[dataset]) / len(table))]
        rows.append([*dataset, *counts, *kept, why or NONE])
    yield Heading("Rows used")
    yield Paragraph("A row is the prediction of one estimate to one later track.")
    yield Table(header, rows)


USED = "used"


def row_shares(dataset: pd.DataFrame) -> dict[str, float]:
    """Share of a dataset's rows that are used, then of those that are not, by reason, the largest first."""
    reasons = dataset.loc[~dataset["keep"], "reason"].str.split(":").str[0].value_counts()
    return {USED: float(dataset["keep"].mean())} | {
        reason: float(count) / len(dataset) for reason, count in reasons.items()
    }
