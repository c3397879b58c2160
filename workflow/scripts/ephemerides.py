"""Tabulate the third bodies on the environment's time grid."""

from opml.constants import DAY
from opml.environment import ephemerides, nodes
from opml.jobs import job
from opml.tables import write_table

with job(snakemake) as metadata:
    settings = snakemake.params.settings
    t = nodes(settings["epoch"], DAY * settings["duration_days"])
    table = ephemerides.tabulate(settings["kernel"], settings["epoch"], t)
    metadata |= ephemerides.metadata(settings["kernel"])
    write_table(snakemake.output[0], table, "ephemerides", metadata=metadata)
