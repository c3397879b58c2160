"""Draw mean and spread of the absolute errors of several RSOs side by side."""

from opml.figures import errors, style
from opml.jobs import job
from opml.tables import read_table

with job(snakemake):
    settings = snakemake.params.settings
    tables = [read_table(path, "evaluation") for path in snakemake.input]
    figure = errors.rso_grid(
        dict(zip(settings["rsos"], tables, strict=True)), component=settings["component"]
    )
    style.save_all([figure], snakemake.output.pdf, snakemake.output.png)
