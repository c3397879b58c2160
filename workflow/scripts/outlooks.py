"""Tabulate the space weather as it was forecast at each time of issue."""

from typing import Any

from opml.base.constants import DAY
from opml.base.section import JobSettings
from opml.environment import knowledge, nodes
from opml.tables import OUTLOOKS, write_table
from opml.workflow.jobs import job


class Settings(JobSettings):
    source: str
    epoch: str
    forecast: dict[str, Any]
    issue_hours: int
    max_days: float
    duration_days: float


with job(snakemake) as metadata:
    settings = Settings(**snakemake.params.settings)
    issues = knowledge.Issues(
        source=settings.source,
        epoch=settings.epoch,
        forecast=settings.forecast,
        hours=settings.issue_hours,
        max_days=settings.max_days,
    )
    table = knowledge.outlooks(issues, nodes(issues.epoch, DAY * settings.duration_days))
    metadata |= {"source": settings.source, "forecast": settings.forecast}
    write_table(snakemake.output[0], table, OUTLOOKS, metadata=metadata)
