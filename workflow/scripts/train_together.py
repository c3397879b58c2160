"""Train a learner on one error component, with variables standardised over a test's rows, too."""

from opml.jobs import job
from opml.learning import learners, tested, together
from opml.tables import write_table

with job(snakemake) as metadata:
    settings, component = snakemake.params.settings, snakemake.params.settings["experiment"]["component"]
    rows, test = tested.read_with_training(snakemake.input, settings)
    model = together.train(
        rows, test, component=component, settings=settings["learner"], seed=settings["seed"]
    )
    weights, described = model.to_table()
    metadata |= described | {"component": component}
    write_table(snakemake.output[0], weights, learners.schema(described), metadata=metadata)
