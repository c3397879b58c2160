"""Draw P_ML of models against splits."""

from opml.base.section import JobSettings
from opml.figures import study_models, style
from opml.figures.axis_labels import describe_splits, lines
from opml.figures.display_names import display_rso
from opml.figures.model_names import describe_model
from opml.learning.models.learners import AnyLearner
from opml.tables import read_tables
from opml.workflow.jobs import job


class Settings(JobSettings):
    splits: dict[str, tuple[str, str]]
    station_sets: list[str]
    models: dict[str, AnyLearner]
    learners: list[str]
    component: str
    weather: str = ""


with job(snakemake):
    settings = Settings(**snakemake.params.settings)
    metrics = read_tables(snakemake.input, "metrics")
    names = {tuple(pair): split for split, pair in settings.splits.items()}
    metrics["split"] = [names[pair] for pair in zip(metrics["train"], metrics["test"], strict=True)]
    figure = study_models.splits(
        metrics,
        panels=settings.station_sets,
        models={learner: describe_model(settings.models[learner]) for learner in settings.learners},
        splits=list(settings.splits),
        component=settings.component,
        note=lines(
            f"{display_rso(metrics['rso'].iloc[0])}; {describe_splits(settings.splits)}", settings.weather
        ),
    )
    style.save_all([figure], snakemake.output.pdf, snakemake.output.png)
