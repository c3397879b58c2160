"""Draw the share of the rows that a study uses, and why others are not."""

from opml.figures import own_study, style
from opml.report.own_study import row_shares
from opml.tables import read_table
from opml.workflow.jobs import job

with job(snakemake):
    names = snakemake.params.settings["datasets"]
    shares = {
        name: row_shares(read_table(path, "dataset"))
        for name, path in zip(names, snakemake.input, strict=True)
    }
    style.save_all([own_study.rows(shares)], snakemake.output.pdf, snakemake.output.png)
