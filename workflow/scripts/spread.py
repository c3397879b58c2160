"""Fly what tells how far drag and the weather ahead may take predictions."""

from opml.catalog.predict import spread
from opml.ephemerides import corrected, replays
from opml.tables import read_table, write_table
from opml.workflow.jobs import job, progress

with job(snakemake) as metadata:
    settings, files = snakemake.params.settings, snakemake.input
    flight = corrected.Flight.read(
        files, settings | {"force_model": spread.FLATTENED}, threads=snakemake.threads
    )
    known = corrected.read(files, settings)
    starts = replays.departures(known, every_hours=settings["every_hours"])
    predictions = read_table(files.predictions, "predictions")
    table = spread.build(
        estimates=known.estimates,
        pairs=predictions[predictions["i"].isin(starts["track"])],
        futures=read_table(files.futures, "futures") if files.futures else None,
        progress=progress,
        **flight.options,
    )
    write_table(snakemake.output[0], table, "spread", metadata=metadata)
