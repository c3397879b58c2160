"""A study's answer: models against splits, errors in metres before and after, rows used and dropped."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import pandas as pd

from opml.learning.data.cleaning import PAPER, PAPER_BOUNDS, PAPER_FENCE
from opml.learning.data.dataset import survives
from opml.learning.judge.errors_by_duration import at_days
from opml.learning.judge.metrics import p_ml
from opml.learning.judge.model_choice import Mornings
from opml.learning.judge.rolling_origins import by_day
from opml.naming import Experiment
from opml.report import mornings, uncertainty
from opml.report.beyond import model_table
from opml.report.document import Block, Heading, Paragraph, Table
from opml.report.results import NONE, Results, length, percent
from opml.report.settings_tables import assumed_model, force_models, weather

Dataset = tuple[str, str]


@dataclass(frozen=True)
class Answer:
    """What the report tells."""

    experiments: Mapping[tuple[str, str, str, str], Experiment]  # by RSO, station set, model and split
    pairs: Mapping[str, tuple[str, str]]  # training and test rows, by split
    shown: str  # the split whose errors are stated in metres
    stated: Mapping[tuple[str, str, str], Experiment]  # its experiments by RSO, station set and model
    datasets: Sequence[Dataset]  # RSO and station set
    learners: Mapping[str, Mapping[str, Any]]  # settings by name
    component: str
    label: str  # truth, later or smoothed: what is learned from is held against it
    truths: Sequence[str]  # of each RSO: simulated, from files, or none where its tracks were measured
    laws: Sequence[str]  # the models that learn among those whose mornings are run again
    seed: int  # of the resampled days by which a law has to be worth it
    rolling: Sequence[tuple[str, str, str]]  # RSO, station set and learner, of learners that are trained anew
    trained_anew: Mapping[str, Any]  # on which days, how often, on how many days' labels [days]
    marks: Sequence[float]  # prediction durations that errors are stated at [days]
    durations: Sequence[float]  # those that coverage is stated at [days]
    settings: Mapping[str, Any]


def document(
    asked: Answer,
    metrics: pd.DataFrame,
    evaluations: Mapping[tuple[str, str, str], pd.DataFrame],
    datasets: Mapping[Dataset, pd.DataFrame],
    estimates: Mapping[Dataset, pd.DataFrame],
    rolling: Mapping[tuple[str, str, str], pd.DataFrame],
    replays: Mapping[tuple[str, str, str], pd.DataFrame],
    calibration: Mapping[Dataset, pd.DataFrame],
) -> list[Block]:
    """The whole report.

    `metrics`: rows of that table for every experiment. `evaluations`: those tables of the stated experiments,
    by RSO, station set and model. `datasets`, `estimates`: those tables by RSO and station set. `rolling`:
    those of the learners that are trained anew, by RSO, station set and learner. `replays`: those tables, by
    RSO, station set and model. `calibration`: those tables of the fits' own covariances.
    """
    told = {
        dataset: Mornings.from_replays(own, asked.laws, seed=asked.seed)
        for dataset in asked.datasets
        if (own := {learner: table for (*of, learner), table in replays.items() if tuple(of) == dataset})
    }
    papers = {
        dataset: table.loc[survives(table, estimates[dataset], PAPER), ["i", "j"]]
        for dataset, table in datasets.items()
    }
    return [
        Heading("The study", 1),
        Paragraph(
            f"Predictions of {', '.join(dict.fromkeys(rso for rso, _ in asked.datasets))} from "
            f"{asked.settings['epoch']} UTC over {asked.settings['duration_days']:g} days, corrected in "
            f"`{asked.component}` by models that learned from earlier ones. {weather(asked.settings)}"
        ),
        *mornings.section(told, asked.marks, asked.laws),
        *uncertainty.section(told, calibration, asked.durations),
        *_splits(asked, Results(metrics)),
        *_errors(asked, evaluations, papers),
        *_rolling(asked, rolling),
        *_rows(asked, datasets, estimates, papers),
        *model_table(asked.learners),
        *_forces(asked),
    ]


def _forces(asked: Answer) -> Iterator[Block]:
    if "simulated" in asked.truths:
        yield Heading("Truth and assumed model")
        yield force_models(asked.settings)
        return
    yield Heading("Assumed model")
    if "files" in asked.truths:
        yield Paragraph("The true orbit is the one of the files; no force model flew it.")
    yield assumed_model(asked.settings)


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
        "estimate are no independent evidence. `docs/beyond.md` explains models and splits."
    )
    yield Table(["RSO", "stations", "model", *header], rows)
    if set(asked.truths) == {"measured"}:
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
    yield Heading(f"Trained once: errors before and after, {asked.shown}")
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
