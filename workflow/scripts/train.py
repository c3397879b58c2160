"""Train a learner on one error component."""

from opml.jobs import job
from opml.learning import learners, splits
from opml.tables import model_schema, read_table, write_table

with job(snakemake) as metadata:
    settings = snakemake.params.settings
    dataset = read_table(snakemake.input.dataset, "dataset")
    rows = splits.training_rows(
        dataset, settings["train"], span_days=settings["span_days"], seed=settings["seed"]
    )
    training, variables = dataset[rows], settings["variables"]
    model = learners.fit(
        training[variables].to_numpy(),
        training[settings["component"]].to_numpy(),
        variables=variables,
        settings=settings["learner"],
        seed=settings["seed"],
        groups=training["i"].to_numpy(),
    )
    table, described = model.to_table()
    metadata |= described | {"component": settings["component"]}
    write_table(snakemake.output[0], table, model_schema(variables), metadata=metadata)
