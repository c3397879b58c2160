"""Draw when learning from a catalogue helps, by height, drag and number of sets."""

from opml.base.section import JobSettings
from opml.element_sets import corrector_trial
from opml.figures import style
from opml.figures.catalogue import gains
from opml.workflow.jobs import job, read_by_key


class Settings(JobSettings):
    tests: list[str]
    labels: dict[str, str]


with job(snakemake):
    settings = Settings(**snakemake.params.settings)
    residuals = read_by_key(settings.tests, snakemake.input.residuals, "catalogue_residuals")
    rows = read_by_key(settings.tests, snakemake.input.rows, corrector_trial.ROWS)
    figure = gains.gains(residuals, rows, settings.labels)
    style.save_all([figure], snakemake.output.pdf, snakemake.output.png)
