"""Propagate the true orbit of an RSO."""

from opml.base.constants import DAY
from opml.catalog.propagator import Propagator, PropagatorSettings
from opml.catalog.simulate import truth
from opml.tables import write_table
from opml.workflow.jobs import job, progress


class Settings(PropagatorSettings):
    duration_days: float
    step_s: float


with job(snakemake) as metadata:
    settings = Settings(**snakemake.params.settings)
    propagator = Propagator.read(snakemake.input, settings, progress=progress)
    table = truth.simulate(propagator, duration=DAY * settings.duration_days, step=settings.step_s)
    write_table(snakemake.output[0], table, "truth", metadata=metadata)
