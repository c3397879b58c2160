"""Simulate the tracks and measurements of an RSO by a station set."""

from opml.base.section import JobSettings
from opml.catalog.simulate import tracking
from opml.orbits.sheets import Station
from opml.tables import read_table, write_table
from opml.workflow.jobs import job


class Settings(JobSettings):
    stations: list[Station]
    rso: str
    seed: int
    epoch: str


with job(snakemake) as metadata:
    settings = Settings(**snakemake.params.settings)
    table = tracking.simulate(
        read_table(snakemake.input.truth, "truth"),
        read_table(snakemake.input.earth_orientation, "earth_orientation"),
        settings.stations,
        rso=settings.rso,
        seed=settings.seed,
        epoch=settings.epoch,
    )
    write_table(snakemake.output[0], table, "tracking", metadata=metadata)
