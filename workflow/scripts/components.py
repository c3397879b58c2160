"""Tabulate P_ML of all six components."""

from opml.base.section import JobSettings
from opml.report import document, settings_tables
from opml.tables import COMPONENTS, read_tables
from opml.workflow.jobs import job


class Settings(JobSettings):
    evaluations: list[str]


with job(snakemake):
    names = Settings(**snakemake.params.settings).evaluations
    p_ml = read_tables(snakemake.input, "metrics")["p_ml"].to_numpy().reshape(len(names), len(COMPONENTS))
    output = snakemake.output
    document.write(
        settings_tables.components(dict(zip(names, p_ml, strict=True))),
        output.md[0],
        output.tsv[0],
        output.html[0],
    )
