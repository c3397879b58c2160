"""Draw P_ML of models against splits."""

from opml.figures import beyond, style
from opml.figures.axis_labels import add_weather, describe_splits
from opml.figures.display_names import display_rso
from opml.figures.model_names import describe_model
from opml.tables import read_tables
from opml.workflow.job_settings import FigureSettings
from opml.workflow.jobs import job

with job(snakemake):
    settings = FigureSettings(snakemake.params.settings)
    metrics = read_tables(snakemake.input, "metrics")
    names = {tuple(pair): split for split, pair in settings.splits.items()}
    metrics["split"] = [names[pair] for pair in zip(metrics["train"], metrics["test"], strict=True)]
    figure = beyond.splits(
        metrics,
        panels=settings.station_sets,
        models={learner: describe_model(settings.models[learner]) for learner in settings.learners},
        splits=list(settings.splits),
        published={(stations, split): p_ml for stations, _, split, p_ml in settings.published},
        component=settings.component,
        note=add_weather(
            f"{display_rso(metrics['rso'].iloc[0])}; {describe_splits(settings.splits)}", settings.values
        ),
    )
    style.save_all([figure], snakemake.output.pdf, snakemake.output.png)
