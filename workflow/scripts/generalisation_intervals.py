"""Draw prediction intervals over what a correction leaves."""

from opml.figures import generalisation, style
from opml.figures.labels import experiment
from opml.jobs import job
from opml.tables import read_table

with job(snakemake):
    settings = snakemake.params.settings
    tables = {
        learner: read_table(path, "intervals")
        for learner, path in zip(settings["learners"], snakemake.input, strict=True)
    }
    figure = generalisation.intervals(
        tables, level=settings["level"], component=settings["component"], note=experiment(**settings)
    )
    style.save_all([figure], snakemake.output.pdf, snakemake.output.png)
