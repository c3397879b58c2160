"""Propagate the true orbits of RSOs that fly together."""

import pandas as pd

from opml.base.constants import DAY
from opml.catalog.flight import Flight
from opml.catalog.simulate import truth
from opml.orbits.sheets import Rso
from opml.tables import TRUTH_GROUPS, write_table
from opml.workflow.job_settings import JobSettings
from opml.workflow.jobs import job, metadata_of_each, progress

with job(snakemake) as metadata:
    settings = JobSettings(snakemake.params.settings)
    first, *others = settings.rsos
    tables = truth.simulate_together(
        Flight.read(
            snakemake.input, settings.values | {"rso": first}, threads=snakemake.threads, progress=progress
        ),
        [Rso(**rso) for rso in others],
        duration=DAY * settings.duration_days,
        step=settings.step_s,
    )
    # First, as a truth that was there without it would count as one that flew alone.
    group = pd.DataFrame({"rso": [rso["name"] for rso in settings.rsos]})
    write_table(snakemake.output.group, group, TRUTH_GROUPS, metadata=metadata)
    for path, table, alone in zip(
        snakemake.output.truth, tables, metadata_of_each(settings.values), strict=True
    ):
        write_table(path, table, "truth", metadata=alone)
