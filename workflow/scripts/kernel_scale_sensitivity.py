"""Draw P_ML against the kernel scale, with the scales of the rules marked."""

from opml.base.section import JobSettings
from opml.figures import p_ml_curves, style
from opml.tables import read_metadata, read_tables
from opml.workflow.jobs import job


class Settings(JobSettings):
    rules: list[tuple[str, str]]
    component: str


with job(snakemake):
    settings = Settings(**snakemake.params.settings)
    metrics = read_tables(snakemake.input.metrics, "metrics")
    rules: dict[str, dict[str, float]] = {}
    for (stations, rule), path in zip(settings.rules, snakemake.input.models, strict=True):
        rules.setdefault(stations, {})[rule] = read_metadata(path)["kernel_scale"]
    figure = p_ml_curves.kernel_scale_sensitivity(metrics, rules, component=settings.component)
    style.save_all([figure], snakemake.output.pdf, snakemake.output.png)
