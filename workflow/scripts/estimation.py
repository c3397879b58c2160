"""Estimate state and drag coefficient at each track's start."""

from opml.catalog.fit import estimation, start_states
from opml.dynamics import force_model
from opml.orbits.sheets import Rso, Station
from opml.tables import read_kind, read_table, write_table
from opml.workflow.jobs import job, progress

with job(snakemake) as metadata:
    settings, files = snakemake.params.settings, snakemake.input
    asked = estimation.Estimation(**settings["estimation"])
    rso, tracking = Rso(**settings["rso"]), read_table(files.tracking, "tracking")
    start = read_table(files.start, read_kind(files.start))
    table = estimation.estimate_all(
        force_model.read(files, epoch=settings["epoch"], settings=settings["force_model"]),
        start_states.chosen(start, tracking, rso=rso.name, settings=asked, seed=settings["seed"]),
        tracking,
        read_table(files.earth_orientation, "earth_orientation"),
        [Station(**station) for station in settings["stations"]],
        rso,
        settings=asked,
        integrator=force_model.integrator(settings["integrator"]),
        threads=snakemake.threads,
        progress=progress,
    )
    write_table(snakemake.output[0], table, "estimates", metadata=metadata)
