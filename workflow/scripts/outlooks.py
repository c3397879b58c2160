"""Tabulate the space weather as it was forecast at each time of issue."""

from opml.base.constants import DAY
from opml.environment import knowledge, nodes
from opml.tables import OUTLOOKS, write_table
from opml.workflow.jobs import job

with job(snakemake) as metadata:
    settings = snakemake.params.settings
    table = knowledge.outlooks(
        settings["source"],
        settings["epoch"],
        nodes(settings["epoch"], DAY * settings["duration_days"]),
        forecast=settings["forecast"],
        issue_hours=settings["issue_hours"],
        max_days=settings["max_days"],
    )
    metadata |= {"source": settings["source"], "forecast": settings["forecast"]}
    write_table(snakemake.output[0], table, OUTLOOKS, metadata=metadata)
