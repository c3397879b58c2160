"""Draw P_ML against the size of the training data."""

from opml.base.section import JobSettings
from opml.figures import p_ml_curves, style
from opml.tables import read_tables
from opml.workflow.jobs import job


class Settings(JobSettings):
    published: dict[str, float]
    component: str


with job(snakemake):
    settings = Settings(**snakemake.params.settings)
    metrics = read_tables(snakemake.input, "metrics")
    published = {float(ratio): p_ml for ratio, p_ml in settings.published.items()}
    figure = p_ml_curves.partition_curve(metrics, component=settings.component, published=published)
    style.save_all([figure], snakemake.output.pdf, snakemake.output.png)
