"""Fly what tells how far drag and the weather ahead may take predictions."""

from opml.catalog.flight import Flight
from opml.catalog.predict import spread
from opml.ephemerides import replays
from opml.ephemerides.known import Known
from opml.tables import read_table, write_table
from opml.workflow.job_settings import JobSettings
from opml.workflow.jobs import job, progress

with job(snakemake) as metadata:
    settings, files = JobSettings(snakemake.params.settings), snakemake.input
    flattened = settings.values | {"force_model": spread.FLATTENED}
    known = Known.read(files, settings.values)
    starts = replays.morning_departures(known, every_hours=settings.every_hours)
    predictions = read_table(files.predictions, "predictions")
    flight = Flight.read(files, flattened, threads=snakemake.threads, progress=progress)
    futures = read_table(files.futures, "futures") if files.futures else None
    table = spread.build(
        flight,
        known.own(),
        predictions[predictions["i"].isin(starts["track"])],
        weathers=spread.Weathers.of(flight.model, futures),
    )
    write_table(snakemake.output[0], table, "spread", metadata=metadata)
