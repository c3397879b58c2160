"""Apply a trained model to a test split and measure P_ML."""

from opml.jobs import job
from opml.learning import learners, metrics, splits
from opml.learning.evaluation import evaluate
from opml.tables import model_schema, read_metadata, read_table, write_table

with job(snakemake) as metadata:
    settings = snakemake.params.settings
    experiment, span_days = settings["experiment"], settings["span_days"]
    described = read_metadata(snakemake.input.model)
    model = learners.from_table(
        read_table(snakemake.input.model, model_schema(described["variables"])), described
    )
    dataset = read_table(snakemake.input.target, "dataset")
    trained = None
    if experiment["target"] == experiment["rso"]:
        trained = splits.training_rows(dataset, settings["train"], span_days=span_days, seed=settings["seed"])
    rows = splits.test_rows(dataset, experiment["test"], span_days=span_days, trained=trained)
    table = evaluate(model, dataset, rows, component=experiment["component"])
    write_table(snakemake.output.evaluation, table, "evaluation", metadata=metadata)
    write_table(snakemake.output.metrics, metrics.summary(table, **experiment), "metrics", metadata=metadata)
