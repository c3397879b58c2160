"""Carry a given state to every measured track, or determine one from them."""

from opml.catalog.fit import fixes
from opml.catalog.fit.estimation_settings import Estimation
from opml.catalog.fit.first import first_orbit
from opml.catalog.propagator import Propagator, PropagatorSettings
from opml.interop import first_state, object_ids
from opml.orbits.sheets import Station
from opml.tables import read_measured, write_table
from opml.workflow.jobs import job


class Settings(PropagatorSettings):
    stations: list[Station]
    estimation: Estimation


with job(snakemake) as metadata:
    settings, files = Settings(**snakemake.params.settings), snakemake.input
    propagator = Propagator.read(files, settings, threads=snakemake.threads)
    known = first_orbit.of_sheet(propagator.rso, propagator.model.gm)
    if files.start:
        first = read_measured(files.tracking)["t"].iloc[0]
        known = first_state.read(files.start, epoch=settings.epoch, t=first)
        metadata |= object_ids.facts(first_state.identity(files.start))
    measured = fixes.read(files, settings.stations)
    table = first_orbit.starts(propagator, measured, known=known, settings=settings.estimation)
    write_table(snakemake.output[0], table, "starts", metadata=metadata)
