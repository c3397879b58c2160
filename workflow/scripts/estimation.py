"""Estimate state and drag coefficient at each track's start."""

from opml.catalog import estimation, force_model
from opml.jobs import job, progress
from opml.sheets import Rso, Station
from opml.tables import read_table, write_table

with job(snakemake) as metadata:
    settings = snakemake.params.settings
    table = estimation.estimate_all(
        force_model.read(snakemake.input, epoch=settings["epoch"], settings=settings["force_model"]),
        read_table(snakemake.input.truth, "truth"),
        read_table(snakemake.input.tracking, "tracking"),
        read_table(snakemake.input.earth_orientation, "earth_orientation"),
        [Station(**station) for station in settings["stations"]],
        Rso(**settings["rso"]),
        settings=estimation.Estimation(**settings["estimation"]),
        integrator=force_model.integrator(settings["integrator"]),
        seed=settings["seed"],
        threads=snakemake.threads,
        progress=progress,
    )
    write_table(snakemake.output[0], table, "estimates", metadata=metadata)
