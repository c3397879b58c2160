"""Draw P_ML of models on nearby RSOs."""

from opml.base.section import JobSettings
from opml.figures import beyond, style
from opml.tables import read_tables
from opml.workflow.jobs import job


class Settings(JobSettings):
    curves: dict[str, dict[str, float]]
    published: list[tuple[str, str, str, float]]
    component: str


with job(snakemake):
    settings = Settings(**snakemake.params.settings)
    figure = beyond.transfers(
        read_tables(snakemake.input, "metrics"),
        settings.curves,
        published={target: p_ml for _, _, target, p_ml in settings.published},
        component=settings.component,
    )
    style.save_all([figure], snakemake.output.pdf, snakemake.output.png)
