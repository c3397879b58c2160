"""The report of a study of one's own: errors in metres, skill, models against splits, rows used."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import pandas as pd

from opml.base.constants import DAY
from opml.base.section import JobSettings
from opml.catalog.fit.estimation_settings import EstimationSettings
from opml.dynamics.settings import ForceModels
from opml.environment.settings import EnvironmentSettings
from opml.learning.models.contract import LearnerSettings
from opml.learning.models.learners import learns
from opml.naming import SPLIT, Experiment, parse_test, parse_train, strip_seed
from opml.report import absurd_fits, measurement_residuals, texts
from opml.report.absurd_fits import Dataset
from opml.report.document import Block
from opml.report.results import NO_VALUE, Results, length, percent
from opml.report.settings_tables import assumed_model, force_models, learner_table, weather

ModelKey = tuple[str, str, str]  # RSO, station set and model

REACH_DAYS = 0.25  # a prediction counts for a duration within this of its own [days]

NO_CORRECTION = "no correction"  # the row of a table whose predictions stay as they are


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
    datasets: Sequence[Dataset]
    learners: Mapping[str, LearnerSettings]  # by name
    component: str
    label: str  # what predictions are compared with to learn from: truth or later
    truths: Sequence[str]  # of each RSO: simulated, from files, or none where its tracks were measured
    marks: Sequence[float]  # prediction durations that errors are stated at [days]
    settings: RunFacts


@dataclass(frozen=True)
class OwnStudyTables:
    """The tables that the report's numbers come from."""

    metrics: pd.DataFrame  # one row per experiment
    evaluations: Mapping[ModelKey, pd.DataFrame]  # of the shown split, for models that correct something
    datasets: Mapping[Dataset, pd.DataFrame]
    estimates: Mapping[Dataset, pd.DataFrame]
    noise: Mapping[Dataset, pd.DataFrame]  # instruments' noise by residuals, of what was measured


def document(report: OwnStudyReport, tables: OwnStudyTables) -> list[Block]:
    """Return the whole report."""
    absurd = absurd_fits.symptoms(tables.estimates)
    rsos = ", ".join(dict.fromkeys(rso for rso, _ in report.datasets))
    return [
        f"# The study of {rsos}",
        *_errors(report, tables),
        *absurd_fits.section(absurd, report.settings.estimation.window_hours),
        *_splits(report, Results(tables.metrics)),
        *_rows(report, tables),
        *measurement_residuals.section(tables.noise, tables.estimates, epoch=report.settings.epoch),
        *learner_table(report.learners),
        *_forces(report),
    ]


@dataclass(frozen=True)
class _ModelErrors:
    """Errors that a model leaves on the shown split."""

    name: str
    learns: bool
    errors: pd.DataFrame  # the table `evaluation`

    @property
    def total(self) -> float:
        """Their summed size."""
        return float(self.errors["residual"].abs().sum())

    def near(self, day: float) -> str:
        """Return median and 95th percentile of those after a duration [days] as a cell."""
        rows = (self.errors["duration"] / DAY - day).abs() <= REACH_DAYS
        if not rows.any():
            return NO_VALUE
        return " / ".join(map(length, self.errors.loc[rows, "residual"].abs().quantile([0.5, 0.95])))


def _errors(report: OwnStudyReport, tables: OwnStudyTables) -> Iterator[Block]:
    """Yield the model that leaves least, then errors in metres and each model's skill."""
    unit = "m/s" if report.component.startswith("e_v") else "m"
    models = {dataset: _models(report, tables, dataset) for dataset in report.datasets}
    best = {dataset: _best(of_dataset, learns=False) for dataset, of_dataset in models.items()}
    for dataset, of_dataset in models.items():
        learned = [model for model in of_dataset if model.learns]
        yield _answer(dataset, best[dataset], learned, day=report.marks[-1], unit=unit)
    train, test = report.pairs[report.shown]
    yield from texts.blocks(
        "own_study.errors",
        title=f"Errors and skill: {report.shown}",
        epoch=report.settings.epoch,
        days=report.settings.duration_days,
        component=report.component,
        weather=weather(report.settings.environment),
        unit=unit,
        train=train,
        test=test,
        touched=texts.sentences(f"own_study.{'touched' if _touches(train, test) else 'untouched'}"),
    )
    if report.label != "truth":
        measured = set(report.truths) == {"measured"}
        yield from texts.blocks(f"own_study.{'measured' if measured else 'true'}", later=LATER[report.label])
    rows = [
        [*dataset, model.name, "yes" if model.learns else "no"]
        + [*map(model.near, report.marks), _skill(model, best[dataset])]
        for dataset, of_dataset in models.items()
        for model in of_dataset
    ]
    yield from texts.blocks("own_study.sizes", rows, days=texts.across(f"{day:g} d" for day in report.marks))


def _models(report: OwnStudyReport, tables: OwnStudyTables, dataset: Dataset) -> list[_ModelErrors]:
    """Return the models of a dataset, predictions as they are first."""
    evaluations = {model: table for (*of, model), table in tables.evaluations.items() if tuple(of) == dataset}
    first = next(iter(evaluations.values()))
    return [
        _ModelErrors(NO_CORRECTION, learns=False, errors=first.assign(residual=first["true"])),
        *(
            _ModelErrors(f"`{model}`", learns(report.learners[model]), table)
            for model, table in evaluations.items()
        ),
    ]


def _best(models: Sequence[_ModelErrors], *, learns: bool) -> _ModelErrors:
    """Return the model that leaves least, of those that learn or of the others."""
    return min((model for model in models if model.learns == learns), key=lambda model: model.total)


def _answer(
    dataset: Dataset, best: _ModelErrors, learned: Sequence[_ModelErrors], *, day: float, unit: str
) -> str:
    """Return whether a model that learns leaves less than the best of the others, in words."""
    facts = {"dataset": ", ".join(dataset), "day": day, "unit": unit}
    facts |= {"best": best.name, "size": best.near(day)}
    if not learned:
        return texts.sentences("own_study.without_learning", **facts)
    model = _best(learned, learns=True)
    facts |= {"model": model.name, "learned": model.near(day), "skill": _skill(model, best)}
    return texts.sentences("own_study.answer", **facts)


def _skill(model: _ModelErrors, best: _ModelErrors) -> str:
    """Return the part [%] that a model takes off the errors of the best without learning, as a cell."""
    return f"{100.0 * (1.0 - model.total / best.total):.0f}" if best.total > 0.0 else NO_VALUE


def _touches(train: str, test: str) -> bool:
    """Return whether days of the training touch the tested predictions."""
    trained, tested = parse_train(strip_seed(train, SPLIT)), parse_test(test)
    return trained.kind != "days" or not tested.starts_inside or trained.days[1] > tested.days[0]


LATER = {"later": "the estimate that is made when the track predicted to is over"}
"""The reference of a label, in words."""


def _splits(report: OwnStudyReport, results: Results) -> Iterator[Block]:
    """Yield P_ML by model and split."""
    splits = texts.across(f"{split}: {', '.join(pair)}" for split, pair in report.pairs.items())
    rows, later = [], []
    for rso, stations, model in dict.fromkeys(key[:3] for key in report.experiments):
        names = [rso, stations, f"`{model}`"]
        experiments = [report.experiments[rso, stations, model, split] for split in report.pairs]
        rows.append([*names, *map(results.p_ml_cell, experiments)])
        later.append([*names, *(percent(results.row(run).get("p_ml_later")) for run in experiments)])
    yield from texts.blocks(
        "own_study.paper_measure", rows, hours=report.settings.estimation.window_hours, splits=splits
    )
    if report.label != "truth" and set(report.truths) != {"measured"}:
        yield from texts.blocks("own_study.labels", later, later=LATER[report.label], splits=splits)


def _rows(report: OwnStudyReport, tables: OwnStudyTables) -> Iterator[Block]:
    rows = []
    for dataset in report.datasets:
        table, fits = tables.datasets[dataset], tables.estimates[dataset]
        reasons = table.loc[~table["keep"], "reason"].str.split(":").str[0].value_counts() / len(table)
        why = "; ".join(f"{reason} {100.0 * share:.1f} %" for reason, share in reasons.items())
        counts = [str(len(fits)), str(int(fits["converged"].sum())), str(len(table))]
        rows.append([*dataset, *counts, f"{100.0 * table['keep'].mean():.1f} %", why or NO_VALUE])
    yield from texts.blocks("own_study.rows", rows)


def _forces(report: OwnStudyReport) -> Iterator[Block]:
    if "simulated" in report.truths:
        yield "## Truth and assumed model"
        yield force_models(report.settings.environment, report.settings.force_models)
        return
    yield "## Assumed model"
    if "files" in report.truths:
        yield "The true orbit is that of the files, without a force model."
    yield assumed_model(report.settings.environment, report.settings.force_models)
