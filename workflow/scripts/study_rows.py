"""Draw the share of the rows that a study uses, and why others are not."""

from opml.figures import study, style
from opml.jobs import job
from opml.report.study import row_shares
from opml.tables import read_table

with job(snakemake):
    names = snakemake.params.settings["datasets"]
    shares = {
        name: row_shares(read_table(path, "dataset"))
        for name, path in zip(names, snakemake.input, strict=True)
    }
    style.save_all([study.rows(shares)], snakemake.output.pdf, snakemake.output.png)
