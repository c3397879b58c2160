"""Draw sizes of errors by duration: uncorrected, corrected by what the past chose, by each model."""

from opml.figures import own_study, style
from opml.workflow.jobs import job
from opml.workflow.replayed_mornings import ReplayedSettings, read_mornings

with job(snakemake):
    settings, files = ReplayedSettings(**snakemake.params.settings), snakemake.input
    figure = own_study.residuals(read_mornings(files, settings), laws=settings.laws, note=settings.note)
    style.save_all([figure], snakemake.output.pdf, snakemake.output.png)
