"""Estimate state and drag coefficient at each track's start by a sequential filter."""

from opml.catalog.fit import fixes, sequential
from opml.catalog.propagator import Propagator, PropagatorSettings
from opml.orbits.sheets import Station
from opml.tables import read_table, write_table
from opml.workflow.jobs import job, progress


class Settings(PropagatorSettings):
    stations: list[Station]
    light_time: bool


with job(snakemake) as metadata:
    settings, files = Settings(**snakemake.params.settings), snakemake.input
    table = sequential.filter_all(
        Propagator.read(files, settings, threads=snakemake.threads, progress=progress),
        read_table(files.estimates, "estimates"),
        fixes.read(files, settings.stations),
        light_time=settings.light_time,
    )
    write_table(snakemake.output[0], table, "estimates", metadata=metadata)
