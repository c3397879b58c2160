"""The report of a study of one's own: errors in metres, skill, models against splits, rows used."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeVar

import pandas as pd

from opml.base.files import FilePath
from opml.base.section import JobSettings
from opml.catalog.fit.estimation_settings import EstimationSettings
from opml.dynamics.settings import ForceModels
from opml.environment.settings import EnvironmentSettings
from opml.learning.data.cleaning import PAPER_BOUNDS, PAPER_CLEANING, PAPER_FENCE
from opml.learning.data.dataset import survives
from opml.learning.judge.errors_by_duration import at_days
from opml.learning.judge.metrics import p_ml
from opml.learning.judge.model_choice import Mornings
from opml.learning.models.contract import LearnerSettings
from opml.learning.models.learners import learns
from opml.naming import SPLIT, Experiment, parse_test, parse_train, strip_seed
from opml.report import absurd_fits, answer, measurement_residuals, mornings, texts, uncertainty
from opml.report.answer import Sources
from opml.report.document import Block
from opml.report.mornings import Dataset
from opml.report.results import NO_VALUE, Results, length, percent
from opml.report.settings_tables import assumed_model, force_models, learner_table, weather
from opml.report.skill import NO_CORRECTION, Reference, reference, skill_cell

ModelKey = tuple[str, str, str]  # RSO, station set and model

Value = TypeVar("Value")


class RunFacts(JobSettings):
    """Facts of the run that a report states."""

    epoch: str
    duration_days: float
    environment: EnvironmentSettings
    force_models: ForceModels
    estimation: EstimationSettings


@dataclass(frozen=True)
class OwnStudyReport:
    """Contents of the report."""

    experiments: Mapping[tuple[str, str, str, str], Experiment]  # by RSO, station set, model and split
    pairs: Mapping[str, tuple[str, str]]  # training and test rows, by split
    shown: str  # the split whose errors are stated in metres
    stated: Mapping[ModelKey, Experiment]  # experiments of that split
    datasets: Sequence[Dataset]
    learners: Mapping[str, LearnerSettings]  # by name
    component: str
    label: str  # what predictions are compared with to learn from: truth or later
    truths: Sequence[str]  # of each RSO: simulated, from files, or none where its tracks were measured
    laws: Sequence[str]  # the models that learn, among those whose mornings are replayed
    seed: int  # of the resampled days on which a law has to prove its worth
    marks: Sequence[float]  # prediction durations that errors are stated at [days]
    durations: Sequence[float]  # prediction durations that coverage is stated at [days]
    sources: Mapping[Dataset, Sources]  # what the answers point at
    settings: RunFacts


@dataclass(frozen=True)
class OwnStudyTables:
    """The tables that the report's numbers come from."""

    metrics: pd.DataFrame  # one row per experiment
    evaluations: Mapping[ModelKey, pd.DataFrame]  # of the stated experiments
    datasets: Mapping[Dataset, pd.DataFrame]
    estimates: Mapping[Dataset, pd.DataFrame]
    noise: Mapping[Dataset, pd.DataFrame]  # what residuals tell of instruments, of what was measured
    replays: Mapping[ModelKey, pd.DataFrame]
    truths: Mapping[Dataset, pd.DataFrame]  # datasets with true errors, where others hold labels
    pictures: Mapping[Dataset, FilePath]  # PNGs of the errors of all models


def document(report: OwnStudyReport, tables: OwnStudyTables) -> list[Block]:
    """Return the whole report."""
    replays = {
        dataset: Mornings.from_replays(replayed, report.laws, seed=report.seed)
        for dataset, replayed in _by_dataset(tables.replays).items()
    }
    replays |= {
        dataset: replays[dataset].against_truth(truth, tables.datasets[dataset])
        for dataset, truth in tables.truths.items()
        if dataset in replays
    }
    papers = {
        dataset: table.loc[survives(table, tables.estimates[dataset], PAPER_CLEANING), ["i", "j"]]
        for dataset, table in tables.datasets.items()
    }
    absurd = absurd_fits.symptoms(tables.estimates)
    rsos = ", ".join(dict.fromkeys(rso for rso, _ in report.datasets))
    return [
        f"# The study of {rsos}",
        *answer.section(
            replays,
            report.sources,
            tables.pictures,
            laws=report.laws,
            marks=report.marks,
            durations=report.durations,
            absurd=absurd,
            proof=[_errors_title(report), *((mornings.TITLE, uncertainty.TITLE) if replays else ())],
        ),
        *absurd_fits.section(absurd, report.settings.estimation.window_hours),
        *_errors(report, tables),
        *mornings.section(replays, report.marks, report.laws),
        *uncertainty.section(replays, report.durations),
        *_splits(report, Results(tables.metrics), tables.evaluations, papers),
        *_rows(report, tables, papers),
        *measurement_residuals.section(tables.noise, tables.estimates, epoch=report.settings.epoch),
        *learner_table(report.learners),
        *_forces(report),
    ]


def _by_dataset(values: Mapping[ModelKey, Value]) -> dict[Dataset, dict[str, Value]]:
    groups: dict[Dataset, dict[str, Value]] = {}
    for (rso, stations, model), value in values.items():
        groups.setdefault((rso, stations), {})[model] = value
    return groups


def _forces(report: OwnStudyReport) -> Iterator[Block]:
    if "simulated" in report.truths:
        yield "## Truth and assumed model"
        yield force_models(report.settings.environment, report.settings.force_models)
        return
    yield "## Assumed model"
    if "files" in report.truths:
        yield "The true orbit is that of the files, without a force model."
    yield assumed_model(report.settings.environment, report.settings.force_models)


def _splits(
    report: OwnStudyReport,
    results: Results,
    evaluations: Mapping[ModelKey, pd.DataFrame],
    papers: Mapping[Dataset, pd.DataFrame],
) -> Iterator[Block]:
    """Yield P_ML by model and split; papers: i and j of the rows that the paper's cleaning would keep."""
    splits = texts.across(f"{split}: {', '.join(pair)}" for split, pair in report.pairs.items())
    rows, later = [], []
    for rso, stations, learner, experiments in _by_model(report):
        evaluation = evaluations.get((rso, stations, learner))
        kept = "100.0" if evaluation is None else _p_ml_cell(evaluation.merge(papers[rso, stations]))
        names = [rso, stations, f"`{learner}`"]
        rows.append([*names, *map(results.p_ml_cell, experiments), kept])
        later.append([*names, *(percent(results.row(one).get("p_ml_later")) for one in experiments)])
    limits = {"low": PAPER_BOUNDS[0], "high": PAPER_BOUNDS[1], "fence": PAPER_FENCE}
    facts = {"hours": report.settings.estimation.window_hours, "shown": report.shown, "splits": splits}
    yield from texts.blocks("own_study.paper_measure", rows, **facts, **limits)
    if report.label != "truth" and set(report.truths) != {"measured"}:
        yield from texts.blocks("own_study.labels", later, later=LATER[report.label], splits=splits)


LATER = {
    "later": "the estimate that is made when the track predicted to is over",
}
"""The reference of a label, in words."""


def _by_model(report: OwnStudyReport) -> Iterator[tuple[str, str, str, list[Experiment]]]:
    for rso, stations, learner in dict.fromkeys(key[:3] for key in report.experiments):
        experiments = [report.experiments[rso, stations, learner, split] for split in report.pairs]
        yield rso, stations, learner, experiments


def _errors_title(report: OwnStudyReport) -> str:
    return f"Errors and skill: {report.shown}"


def _errors(report: OwnStudyReport, tables: OwnStudyTables) -> Iterator[Block]:
    """Yield the errors in metres, and each model's skill against the best without learning."""
    train, test = report.pairs[report.shown]
    unit = "m/s" if report.component.startswith("e_v") else "m"
    end, tested = _training_end(report), parse_test(test)
    touches = end is None or not tested.starts_inside or end > tested.days[0]
    yield from texts.blocks(
        "own_study.errors",
        title=_errors_title(report),
        epoch=report.settings.epoch,
        days=report.settings.duration_days,
        component=report.component,
        weather=weather(report.settings.environment),
        unit=unit,
        train=train,
        test=test,
        touched=texts.sentences(f"own_study.{'touched' if touches else 'untouched'}"),
    )
    if set(report.truths) == {"measured"}:
        yield from texts.blocks("own_study.measured", later=LATER[report.label])
    elif tables.truths:
        yield from texts.blocks("own_study.true", later=LATER[report.label])
    growth = {key: at_days(table, report.marks) for key, table in tables.evaluations.items()}
    days = list(dict.fromkeys(day for table in growth.values() for day in table.get("day", [])))
    replays, rows = _by_dataset(tables.replays), []
    for dataset, models in _by_dataset(tables.evaluations).items():
        best = _reference(report, models, replays.get(dataset, {}))
        yield f"**{', '.join(dataset)}.** Skill is relative to {best}."
        before, sizes = next(iter(models.values()))["true"], growth[*dataset, next(iter(models))]
        cells = [*_size_cells(sizes, days, "before"), skill_cell(_summed(before), best.left)]
        rows.append([*dataset, NO_CORRECTION, "no", *cells])
        for learner, table in models.items():
            learning = "yes" if learns(report.learners[learner]) else "no"
            cells = _size_cells(growth[*dataset, learner], days, "after")
            skill = skill_cell(_summed(table["residual"]), best.left)
            rows.append([*dataset, f"`{learner}`", learning, *cells, skill])
    yield from texts.blocks("own_study.sizes", rows, days=texts.across(f"{day:g} d" for day in days))


def _training_end(report: OwnStudyReport) -> float | None:
    """Return the last day of the shown split's training, None where it trains on a share of all rows."""
    train = parse_train(strip_seed(report.pairs[report.shown][0], SPLIT))
    return train.days[1] if train.kind == "days" else None


def _reference(
    report: OwnStudyReport, models: Mapping[str, pd.DataFrame], replays: Mapping[str, pd.DataFrame]
) -> Reference:
    """Return the best model without learning of a dataset; models: `evaluation` tables by name."""
    left = {NO_CORRECTION: _summed(next(iter(models.values()))["true"])} | {
        name: _summed(table["residual"])
        for name, table in models.items()
        if not learns(report.learners[name])
    }
    past = {
        name if name in left else NO_CORRECTION: table
        for name, table in replays.items()
        if name in (*left, "none")
    }
    return reference(left, past, _training_end(report), seed=report.seed)


def _summed(errors: pd.Series) -> float:
    return float(errors.abs().sum())


def _p_ml_cell(evaluation: pd.DataFrame) -> str:
    if evaluation.empty:
        return NO_VALUE
    return f"{p_ml(evaluation['true'].to_numpy(), evaluation['predicted'].to_numpy()):.1f}"


def _size_cells(sizes: pd.DataFrame, days: Sequence[float], when: str) -> list[str]:
    """Return the sizes of the errors at the days as cells, NONE where a day has no rows."""
    rows = {row["day"]: row for row in sizes.to_dict("records")}
    return [
        " / ".join(length(rows[day][f"{when}_{share}"]) for share in (50, 95)) if day in rows else NO_VALUE
        for day in days
    ]


def _rows(
    report: OwnStudyReport, tables: OwnStudyTables, papers: Mapping[Dataset, pd.DataFrame]
) -> Iterator[Block]:
    rows = []
    for dataset in report.datasets:
        table, fits = tables.datasets[dataset], tables.estimates[dataset]
        shares = row_shares(table)
        used = shares.pop(USED)
        why = "; ".join(f"{reason} {100.0 * share:.1f} %" for reason, share in shares.items())
        counts = [str(len(fits)), str(int(fits["converged"].sum())), str(len(table))]
        kept = [f"{100.0 * share:.1f} %" for share in (used, len(papers[dataset]) / len(table))]
        rows.append([*dataset, *counts, *kept, why or NO_VALUE])
    yield from texts.blocks("own_study.rows", rows)


USED = "used"


def row_shares(dataset: pd.DataFrame) -> dict[str, float]:
    """Return the share of a dataset's rows that are used, then of those that are not, by reason.

    The reasons stand in the order of their shares, the largest first.
    """
    reasons = dataset.loc[~dataset["keep"], "reason"].str.split(":").str[0].value_counts()
    return {USED: float(dataset["keep"].mean())} | {
        reason: float(count) / len(dataset) for reason, count in reasons.items()
    }
