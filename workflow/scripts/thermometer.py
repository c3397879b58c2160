"""Correct the predictions of an RSO by what the drag coefficients of many say together."""

from opml.catalog.predict import thermometer
from opml.tables import read_table, write_table
from opml.workflow.job_settings import JobSettings
from opml.workflow.jobs import job

with job(snakemake) as metadata:
    files, settings = snakemake.input, JobSettings(snakemake.params.settings)
    method = thermometer.Thermometer(**settings.thermometer)
    fits = [read_table(path, "estimates") for path in files.catalogue]
    readings = thermometer.read(read_table(files.estimates, "estimates"), fits, settings.member, method)
    table = thermometer.corrections(
        read_table(files.predictions, "predictions"),
        readings,
        read_table(files.arcs, "arcs"),
        read_table(files.sensitivities, "sensitivities"),
        method,
    )
    write_table(snakemake.output[0], table, "thermometer", metadata=metadata)
