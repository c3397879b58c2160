"""Tabulate the space weather as it may come, by so many futures about the forecast."""

from opml.base.constants import DAY
from opml.environment import knowledge, nodes
from opml.tables import write_table
from opml.workflow.jobs import job

with job(snakemake) as metadata:
    settings = snakemake.params.settings
    table = knowledge.futures(
        settings["source"],
        settings["epoch"],
        nodes(settings["epoch"], DAY * settings["duration_days"]),
        forecast=settings["forecast"],
        members=settings["members"],
        issue_hours=settings["issue_hours"],
        max_days=settings["max_days"],
    )
    metadata |= {name: settings[name] for name in ("source", "forecast", "members")}
    write_table(snakemake.output[0], table, "futures", metadata=metadata)
