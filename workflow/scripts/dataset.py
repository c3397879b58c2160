"""Build the dataset of learning variables and errors, with the reason of each dropped row."""

from opml.base.constants import HOUR
from opml.base.section import JobSettings
from opml.learning.data import dataset
from opml.learning.data.cleaning import Cleaning
from opml.orbits.manoeuvres import read_manoeuvres
from opml.tables import read_measured, read_metadata, read_table, write_table
from opml.workflow.jobs import job


class Settings(JobSettings):
    cleaning: Cleaning
    window_hours: float


with job(snakemake) as metadata:
    settings, labels = Settings(**snakemake.params.settings), snakemake.input.get("labels")
    table = dataset.build(
        read_table(snakemake.input.estimates, "estimates"),
        read_table(snakemake.input.predictions, "predictions"),
        read_measured(snakemake.input.tracking),
        gm=read_metadata(snakemake.input.gravity_field)["gm"],
        cleaning=settings.cleaning,
        manoeuvres=read_manoeuvres(snakemake.input.manoeuvres),
        window=HOUR * settings.window_hours,
        labels=labels and read_table(labels, "labels"),
    )
    write_table(snakemake.output[0], table, "labelled" if labels else "dataset", metadata=metadata)
