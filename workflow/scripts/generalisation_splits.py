"""Draw P_ML of models against splits."""

from opml.figures import generalisation, labels, models, style
from opml.jobs import job
from opml.tables import read_tables

with job(snakemake):
    settings = snakemake.params.settings
    metrics = read_tables(snakemake.input, "metrics")
    name = {tuple(pair): split for split, pair in settings["splits"].items()}
    metrics["split"] = [name[pair] for pair in zip(metrics["train"], metrics["test"], strict=True)]
    figure = generalisation.splits(
        metrics,
        panels=settings["station_sets"],
        learners=settings["learners"],
        splits=list(settings["splits"]),
        published={(stations, split): p_ml for stations, _, split, p_ml in settings["published"]},
        component=settings["component"],
        models={name: models.told(one) for name, one in settings["models"].items()},
        note=labels.with_weather(labels.splits(settings["splits"]), settings),
    )
    style.save_all([figure], snakemake.output.pdf, snakemake.output.png)
