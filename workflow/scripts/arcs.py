"""Gather what fits over another window, and the past of their Cd, say of each prediction."""

from opml.base.constants import HOUR
from opml.catalog.predict import other_windows
from opml.dynamics import force_model
from opml.orbits.sheets import Rso
from opml.tables import read_metadata, read_table, write_table
from opml.workflow.jobs import job, progress

with job(snakemake) as metadata:
    settings, files = snakemake.params.settings, snakemake.input
    table = other_windows.build(
        force_model.read(files, epoch=settings["epoch"], settings=settings["force_model"]),
        read_table(files.predictions, "predictions"),
        Rso(**settings["rso"]),
        arc_estimates=read_table(files.arc_estimates, "estimates"),
        arc_predictions=read_table(files.arc_predictions, "predictions"),
        memory_days=settings["memory_days"],
        manoeuvres=[one["t"] for one in read_metadata(files.manoeuvres).get("manoeuvres", [])],
        window=HOUR * settings["window_hours"],
        integrator=force_model.integrator(settings["integrator"]),
        threads=snakemake.threads,
        progress=progress,
    )
    write_table(snakemake.output[0], table, "arcs", metadata=metadata)
