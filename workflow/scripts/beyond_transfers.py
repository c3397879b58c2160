"""Draw P_ML of models on nearby RSOs."""

from opml.figures import beyond, style
from opml.tables import read_tables
from opml.workflow.job_settings import FigureSettings
from opml.workflow.jobs import job

with job(snakemake):
    settings = FigureSettings(snakemake.params.settings)
    figure = beyond.transfers(
        read_tables(snakemake.input, "metrics"),
        settings.curves,
        published={target: p_ml for _, _, target, p_ml in settings.published},
        component=settings.component,
    )
    style.save_all([figure], snakemake.output.pdf, snakemake.output.png)
