"""Take tracks that were really measured for those of an RSO."""

from opml import epochs
from opml.catalog import measured
from opml.interop import tdm
from opml.jobs import job
from opml.sheets import Station
from opml.tables import write_table

with job(snakemake) as metadata:
    settings = snakemake.params.settings
    table = measured.tracks(
        tdm.measurements(list(snakemake.input), epoch=settings["epoch"]),
        [Station(**station) for station in settings["stations"]],
    )
    times = sorted(epochs.elapsed(settings["epoch"], time) for time in settings["manoeuvres"])
    told = {"manoeuvres": [{"t": t} for t in times]}
    write_table(snakemake.output[0], table, "tracking", metadata=metadata | told)
