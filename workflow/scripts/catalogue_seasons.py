"""Draw remaining share of SGP4's errors with improved sets, by test."""

from opml.base.section import JobSettings
from opml.figures import style
from opml.figures.catalogue import residual_shares
from opml.tables import read_table
from opml.workflow.jobs import job


class Settings(JobSettings):
    labels: dict[str, str]


with job(snakemake):
    settings = Settings(**snakemake.params.settings)
    scores = read_table(snakemake.input[0], "catalogue_scores")
    figure = residual_shares.every_season(scores, settings.labels)
    style.save_all([figure], snakemake.output.pdf, snakemake.output.png)
