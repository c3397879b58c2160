"""Simulate the tracks and measurements of a catalogue by a station set."""

from opml.catalog.simulate import tracking
from opml.orbits.sheets import Station
from opml.tables import read_table, write_table
from opml.workflow.job_settings import SheetJobSettings
from opml.workflow.jobs import job, metadata_of_each, progress

with job(snakemake):
    settings, files = SheetJobSettings(snakemake.params.settings), snakemake.input
    stations = [Station(**station) for station in settings.stations]
    earth_orientation = read_table(files.earth_orientation, "earth_orientation")
    metadata = metadata_of_each(settings.values)
    for count, (rso, truth, path, alone) in enumerate(
        zip(settings.rsos, files.truth, snakemake.output, metadata, strict=True), start=1
    ):
        table = tracking.simulate(
            read_table(truth, "truth"),
            earth_orientation,
            stations,
            rso=rso,
            seed=settings.seed,
            epoch=settings.epoch,
        )
        write_table(path, table, "tracking", metadata=alone)
        progress(count / len(files.truth))
