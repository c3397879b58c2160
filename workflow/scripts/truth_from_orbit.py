"""Take an orbit of one's own for the true orbit of an RSO."""

from opml.base.constants import DAY
from opml.base.section import JobSettings
from opml.interop import truth_from_orbit
from opml.interop.orbit_from_files import OrbitFiles
from opml.tables import write_table
from opml.workflow.jobs import job


class Settings(JobSettings):
    epoch: str
    duration_days: float
    step_s: float


with job(snakemake) as metadata:
    settings = Settings(**snakemake.params.settings)
    files = OrbitFiles(
        list(snakemake.input),
        settings.epoch,
        DAY * settings.duration_days,
    )
    table, facts = truth_from_orbit.truth(files, step=settings.step_s)
    write_table(snakemake.output[0], table, "truth", metadata=metadata | facts)
