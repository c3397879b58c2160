"""Propagate what tells how far drag and the weather ahead may take predictions."""

from opml.catalog.predict import weather_spread
from opml.catalog.propagator import Propagator, PropagatorSettings
from opml.ephemerides import replays
from opml.ephemerides.known_tables import KnownSettings, KnownTables
from opml.tables import read_table, write_table
from opml.workflow.jobs import job, progress


class Settings(PropagatorSettings, KnownSettings):
    every_hours: float


with job(snakemake) as metadata:
    settings, files = Settings(**snakemake.params.settings), snakemake.input
    known = KnownTables.read(files, settings)
    starts = replays.morning_departures(known, every_hours=settings.every_hours)
    predictions = read_table(files.predictions, "predictions")
    flattened = settings.model_copy(update={"force_model": weather_spread.FLATTENED})
    propagator = Propagator.read(files, flattened, threads=snakemake.threads, progress=progress)
    futures = read_table(files.futures, "futures") if files.futures else None
    table = weather_spread.build(
        propagator,
        known.own(),
        predictions[predictions["i"].isin(starts["track"])],
        weathers=weather_spread.Weathers.of(propagator.model, futures),
    )
    write_table(snakemake.output[0], table, "spread", metadata=metadata)
