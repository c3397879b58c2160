"""Propagate the true orbits of RSOs of one job."""

import pandas as pd

from opml.base.constants import DAY
from opml.catalog.propagator import Propagator, PropagatorSettings
from opml.catalog.simulate import truth
from opml.orbits.sheets import Rso
from opml.tables import TRUTH_GROUPS, write_table
from opml.workflow.jobs import job, metadata_of_each, progress


class Settings(PropagatorSettings):
    rsos: list[Rso]
    duration_days: float
    step_s: float


with job(snakemake) as metadata:
    given = snakemake.params.settings
    settings = Settings(**given, rso=given["rsos"][0])
    tables = truth.simulate_together(
        Propagator.read(snakemake.input, settings, threads=snakemake.threads, progress=progress),
        settings.rsos[1:],
        duration=DAY * settings.duration_days,
        step=settings.step_s,
    )
    # First, as a truth that was there without it would count as one that was propagated alone.
    group = pd.DataFrame({"rso": [rso.name for rso in settings.rsos]})
    write_table(snakemake.output.group, group, TRUTH_GROUPS, metadata=metadata)
    for path, table, alone in zip(snakemake.output.truth, tables, metadata_of_each(given), strict=True):
        write_table(path, table, "truth", metadata=alone)
