"""Carry a given state to every measured track, or determine one from them."""

from opml.catalog.fit import first_orbit
from opml.catalog.fit.estimation import Estimation
from opml.dynamics import force_model
from opml.interop import first_state
from opml.orbits.sheets import Rso, Station
from opml.tables import read_table, write_table
from opml.workflow.jobs import job

with job(snakemake) as metadata:
    settings, files = snakemake.params.settings, snakemake.input
    model = force_model.read(files, epoch=settings["epoch"], settings=settings["force_model"])
    rso, tracking = Rso(**settings["rso"]), read_table(files.tracking, "tracking")
    if files.start:
        given = first_state.read(files.start, epoch=settings["epoch"], t=tracking["t"].iloc[0])
    else:
        given = first_orbit.of_sheet(rso, model.gm)
    table = first_orbit.starts(
        model,
        tracking,
        read_table(files.earth_orientation, "earth_orientation"),
        [Station(**station) for station in settings["stations"]],
        rso,
        given=given,
        settings=Estimation(**settings["estimation"]),
        integrator=force_model.integrator(settings["integrator"]),
        threads=snakemake.threads,
    )
    write_table(snakemake.output[0], table, "starts", metadata=metadata)
