"""Draw the estimated drag coefficients beside the solar activity of the same days."""

from opml.figures import study, style
from opml.jobs import job
from opml.tables import read_table

with job(snakemake):
    estimates = {
        name: read_table(path, "estimates")
        for name, path in zip(snakemake.params.settings["windows"], snakemake.input.estimates, strict=True)
    }
    figure = study.drag(estimates, read_table(snakemake.input.activity, "solar_activity"))
    style.save_all([figure], snakemake.output.pdf, snakemake.output.png)
