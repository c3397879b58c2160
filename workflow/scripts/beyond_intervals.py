"""Draw prediction intervals over what a correction leaves."""

from opml.figures import beyond, style
from opml.figures.axis_labels import experiment
from opml.tables import read_table
from opml.workflow.jobs import job

with job(snakemake):
    settings = snakemake.params.settings
    tables = {
        learner: read_table(path, "intervals")
        for learner, path in zip(settings["learners"], snakemake.input, strict=True)
    }
    figure = beyond.intervals(
        tables, level=settings["level"], component=settings["component"], note=experiment(**settings)
    )
    style.save_all([figure], snakemake.output.pdf, snakemake.output.png)
