"""Gather what a catalogue knows of why each prediction errs."""

from opml.catalog.predict import mechanism
from opml.tables import mechanism_schema, read_metadata, read_table, write_table
from opml.workflow.jobs import job

with job(snakemake) as metadata:
    settings, files = snakemake.params.settings, snakemake.input
    table = mechanism.build(
        read_table(files.estimates, "estimates"),
        read_table(files.predictions, "predictions"),
        read_table(files.sensitivities, "sensitivities"),
        long_estimates=read_table(files.long_estimates, "estimates"),
        long_predictions=read_table(files.long_predictions, "predictions"),
        long_sensitivities=read_table(files.long_sensitivities, "sensitivities"),
        bounds=settings["cd_bounds"],
        resonances=settings["resonances"],
        long_window_hours=settings["long_window_hours"],
        gm=read_metadata(files.gravity_field)["gm"],
    )
    metadata |= {"resonances": settings["resonances"]}
    write_table(snakemake.output[0], table, mechanism_schema(settings["resonances"]), metadata=metadata)
