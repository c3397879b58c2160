"""Propagate what tells how far drag and the weather ahead may take predictions."""

from opml.catalog.flight import Flight, FlightSettings
from opml.catalog.predict import spread
from opml.ephemerides import replays
from opml.ephemerides.known_tables import KnownSettings, KnownTables
from opml.tables import read_table, write_table
from opml.workflow.jobs import job, progress


class Settings(FlightSettings, KnownSettings):
    every_hours: float


with job(snakemake) as metadata:
    settings, files = Settings(**snakemake.params.settings), snakemake.input
    known = KnownTables.read(files, settings)
    starts = replays.morning_departures(known, every_hours=settings.every_hours)
    predictions = read_table(files.predictions, "predictions")
    flattened = settings.model_copy(update={"force_model": spread.FLATTENED})
    flight = Flight.read(files, flattened, threads=snakemake.threads, progress=progress)
    futures = read_table(files.futures, "futures") if files.futures else None
    table = spread.build(
        flight,
        known.own(),
        predictions[predictions["i"].isin(starts["track"])],
        weathers=spread.Weathers.of(flight.model, futures),
    )
    write_table(snakemake.output[0], table, "spread", metadata=metadata)
