"""Estimate state and drag coefficient at each track's start."""

from opml.catalog.associate import quarantine
from opml.catalog.fit import biases, fixes, start_states
from opml.catalog.fit.estimation_settings import Estimation
from opml.catalog.propagator import Propagator, PropagatorSettings
from opml.orbits.sheets import Station
from opml.tables import read_kind, read_measured, read_table, write_table
from opml.workflow.jobs import job, progress


class Settings(PropagatorSettings):
    estimation: Estimation
    stations: list[Station]
    seed: int


with job(snakemake) as metadata:
    settings, files = Settings(**snakemake.params.settings), snakemake.input
    method = settings.estimation
    propagator = Propagator.read(files, settings, threads=snakemake.threads, progress=progress)
    tracking = read_measured(files.tracking)
    kind, rso = read_kind(files.start), propagator.rso.name
    starts = read_table(files.start, kind)
    if kind == "truth":
        starts = start_states.perturbed(starts, tracking, rso=rso, settings=method, seed=settings.seed)
    measured = fixes.read(files, settings.stations)
    table, noise = quarantine.with_noise(propagator, starts, measured, settings=method)
    if kind == "starts":  # noise that was simulated is known
        metadata |= biases.facts(noise)
    write_table(snakemake.output[0], table, "estimates", metadata=metadata)
