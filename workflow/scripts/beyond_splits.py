"""Draw P_ML of models against splits."""

from opml.figures import axis_labels, beyond, model_names, style
from opml.tables import read_tables
from opml.workflow.jobs import job

with job(snakemake):
    settings = snakemake.params.settings
    metrics = read_tables(snakemake.input, "metrics")
    name = {tuple(pair): split for split, pair in settings["splits"].items()}
    metrics["split"] = [name[pair] for pair in zip(metrics["train"], metrics["test"], strict=True)]
    figure = beyond.splits(
        metrics,
        panels=settings["station_sets"],
        learners=settings["learners"],
        splits=list(settings["splits"]),
        published={(stations, split): p_ml for stations, _, split, p_ml in settings["published"]},
        component=settings["component"],
        models={name: model_names.told(one) for name, one in settings["models"].items()},
        note=axis_labels.with_weather(axis_labels.splits(settings["splits"]), settings),
    )
    style.save_all([figure], snakemake.output.pdf, snakemake.output.png)
