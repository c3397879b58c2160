"""Draw the share of the rows that a study uses, and why others are not used."""

from opml.base.section import JobSettings
from opml.figures import own_study, style
from opml.report.own_study import row_shares
from opml.workflow.jobs import job, read_by_key


class Settings(JobSettings):
    datasets: list[str]


with job(snakemake):
    tables = read_by_key(Settings(**snakemake.params.settings).datasets, snakemake.input, "dataset")
    shares = {name: row_shares(table) for name, table in tables.items()}
    style.save_all([own_study.rows_figure(shares)], snakemake.output.pdf, snakemake.output.png)
