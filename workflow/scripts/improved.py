"""Predict with SGP4 from the newest set of mean elements, improved."""

from opml.base.section import JobSettings
from opml.interop.element_sets import sgp4_baseline
from opml.tables import read_table, write_table
from opml.workflow.jobs import job


class Settings(JobSettings):
    epoch: str


with job(snakemake) as metadata:
    table = sgp4_baseline.build_improved(
        read_table(snakemake.input.predictions, "predictions"),
        read_table(snakemake.input.improved_history, "improved_history"),
        epoch=Settings(**snakemake.params.settings).epoch,
    )
    write_table(snakemake.output[0], table, "improved", metadata=metadata)
