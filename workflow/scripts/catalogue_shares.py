"""Draw what is left of SGP4's errors by band of height and lead, learned beside unlearned."""

from opml.base.section import JobSettings
from opml.figures import style
from opml.figures.catalogue import residual_shares
from opml.tables import read_table
from opml.workflow.jobs import job


class Settings(JobSettings):
    test: str
    population: str
    seasons: dict[str, list[str]]


with job(snakemake):
    settings = Settings(**snakemake.params.settings)
    scores = read_table(snakemake.input[0], "catalogue_scores")
    own = scores[scores["test"] == settings.test]
    figure = residual_shares.shares(own, settings.seasons, name=settings.population)
    style.save_all([figure], snakemake.output.pdf, snakemake.output.png)
